// SPDX-License-Identifier: Apache-2.0
// A line, which span_setup makes linear along a row: its slope n / L, and its start Q[Acc](slope p + c) at the first
// pixel's centre. Both are held to the tick of the span record.
//
// The slope is a product with the row's reciprocal, or comes from a divider; the start is a product. The package has
// their ticks, at which the inputs named after them are read.
module row_line #(
    // The line's place in the package, which has its products and formats.
    parameter int Line   = 0,
    parameter int NW     = 8,
    parameter int ShiftW = 1,
    parameter int StepW  = bitspan_cfg_pkg::LineStepW[32*Line+:32],
    parameter int AccW   = bitspan_cfg_pkg::LineAccW[32*Line+:32]
) (
    input  logic                                          clk_i,
    input  logic                                          rst_ni,
    input  logic                                          en_i,
    input  logic        [ bitspan_cfg_pkg::RowPhaseW-1:0] phase_i,
    // At the slope's tick: the numerator, and the row's reciprocal.
    input  logic signed [                         NW-1:0] n_i,
    input  logic        [bitspan_cfg_pkg::RowRecipOutW-1:0] m_i,
    input  logic        [ bitspan_cfg_pkg::ExponentW-1:0] e_i,
    // For a divider: start_i and the length d_i at the slope's tick, has_length_i a tick before the quotient's register
    // is written.
    input  logic                                          start_i,
    input  logic        [    bitspan_cfg_pkg::EdgeXW-1:0] d_i,
    input  logic                                          has_length_i,
    // At the start's tick; c is on the sum's grid.
    input  logic        [  bitspan_cfg_pkg::PreStepW-1:0] p_i,
    input  logic        [     bitspan_cfg_pkg::RowCW-1:0] c_i,
    // To the multipliers and from them: the slope's in the lower half, the start's above it.
    output logic        [   2*bitspan_cfg_pkg::RowAW-1:0] a_o,
    output logic        [   2*bitspan_cfg_pkg::RowBW-1:0] b_o,
    output logic        [   2*bitspan_cfg_pkg::RowCW-1:0] c_o,
    output logic        [                   2*ShiftW-1:0] shift_o,
    input  logic        [2*(bitspan_cfg_pkg::RowSumW+3)-1:0] sum_i,
    output logic        [                      StepW-1:0] step_o,
    output logic        [                       AccW-1:0] q_o
);
  localparam int Interval = bitspan_cfg_pkg::RowInterval;
  localparam int Latency = bitspan_cfg_pkg::SpanSetupClocks;
  localparam int ProductTicks = bitspan_cfg_pkg::RowProductTicks;
  localparam int AW = bitspan_cfg_pkg::RowAW;
  localparam int BW = bitspan_cfg_pkg::RowBW;
  localparam int CW = bitspan_cfg_pkg::RowCW;
  localparam int SumW = bitspan_cfg_pkg::RowSumW + 3;
  localparam int Slope = bitspan_cfg_pkg::LineSlope[32*Line+:32];
  localparam int Start = bitspan_cfg_pkg::LineStart[32*Line+:32];
  localparam int StepFrac = bitspan_cfg_pkg::LineStepFrac[32*Line+:32];
  localparam int StepSigned = bitspan_cfg_pkg::LineStepSigned[32*Line+:32];
  localparam int StepRnd = bitspan_cfg_pkg::LineStepRnd[32*Line+:32];
  localparam int StepOvf = bitspan_cfg_pkg::LineStepOvf[32*Line+:32];
  localparam bit Divides = bitspan_cfg_pkg::RowSlopeDivide != 0;
  localparam int SlopeDone = Divides ? bitspan_cfg_pkg::RowDivideTick + bitspan_cfg_pkg::RowUnitClocks + 1 :
      32'(bitspan_cfg_pkg::RowTicks[16*Slope+:16]) + ProductTicks;
  localparam int StartTick = 32'(bitspan_cfg_pkg::RowTicks[16*Start+:16]);
  // Where the slope stands when the start is formed. Yosys also reads the module with its defaults, which have no
  // order.
  localparam int SlopeAt = (StartTick > SlopeDone) ? (StartTick - SlopeDone) / Interval : 0;
  localparam int Depth = (Latency - SlopeDone) / Interval + 1;
  localparam int StartDepth = (Latency - StartTick - ProductTicks) / Interval + 1;
  logic [Depth*StepW-1:0] step_q;
  logic [StartDepth*AccW-1:0] q_q;

  if (Divides) begin : gen_divide
    row_divide #(
        .NW(NW),
        .DW(bitspan_cfg_pkg::EdgeXW),
        .QuotientFrac(bitspan_cfg_pkg::LineDivFrac[32*Line+:32]),
        .OutW(StepW),
        .OutFrac(StepFrac),
        .OutSigned(StepSigned),
        .OutRnd(StepRnd),
        .OutOvf(StepOvf),
        .Last(Latency)
    ) u_slope (
        .clk_i,
        .rst_ni,
        .en_i,
        .phase_i,
        .start_i,
        .n_i,
        .d_i,
        .has_length_i,
        .q_o(step_q)
    );
    assign a_o[0+:AW] = '0;
    assign b_o[0+:BW] = '0;
    assign c_o[0+:CW] = '0;
    assign shift_o[0+:ShiftW] = '0;
    logic unused;
    assign unused = ^{m_i, e_i, sum_i[0+:SumW]};
  end else begin : gen_product
    row_product #(
        .Product(Slope),
        .Last(Latency),
        .AW(NW),
        .ASigned(1),
        .BW(bitspan_cfg_pkg::RowRecipOutW),
        .BSigned(bitspan_cfg_pkg::RowRecipOutSigned),
        .OutW(StepW),
        .OutFrac(StepFrac),
        .OutSigned(StepSigned),
        .OutRnd(StepRnd),
        .OutOvf(StepOvf),
        .ShiftW(ShiftW)
    ) u_slope (
        .clk_i,
        .en_i,
        .phase_i,
        .a_i(n_i),
        .b_i(m_i),
        .e_i,
        .c_i('0),
        .a_o(a_o[0+:AW]),
        .b_o(b_o[0+:BW]),
        .c_o(c_o[0+:CW]),
        .shift_o(shift_o[0+:ShiftW]),
        .sum_i(sum_i[0+:SumW]),
        .q_o(step_q)
    );
    logic unused;
    assign unused = (^d_i) ^ start_i ^ has_length_i ^ rst_ni;
  end

  row_product #(
      .Product(Start),
      .Last(Latency),
      .AW(StepW),
      .ASigned(StepSigned),
      .BW(bitspan_cfg_pkg::PreStepW),
      .BSigned(1),
      .OutW(AccW),
      .OutFrac(bitspan_cfg_pkg::LineAccFrac[32*Line+:32]),
      .OutSigned(bitspan_cfg_pkg::LineAccSigned[32*Line+:32]),
      .OutRnd(bitspan_cfg_pkg::LineAccRnd[32*Line+:32]),
      .OutOvf(bitspan_cfg_pkg::LineAccOvf[32*Line+:32]),
      .ShiftW(ShiftW)
  ) u_start (
      .clk_i,
      .en_i,
      .phase_i,
      .a_i(step_q[SlopeAt*StepW+:StepW]),
      .b_i(p_i),
      .e_i('0),
      .c_i,
      .a_o(a_o[AW+:AW]),
      .b_o(b_o[BW+:BW]),
      .c_o(c_o[CW+:CW]),
      .shift_o(shift_o[ShiftW+:ShiftW]),
      .sum_i(sum_i[SumW+:SumW]),
      .q_o(q_q)
  );
  assign step_o = step_q[(Depth-1)*StepW+:StepW];
  assign q_o = q_q[(StartDepth-1)*AccW+:AccW];
  logic unused_held;
  assign unused_held = ^{step_q, q_q};
endmodule
