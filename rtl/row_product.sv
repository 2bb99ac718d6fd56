// SPDX-License-Identifier: Apache-2.0
// One product of span_setup: Q[Out](a b 2^-e + c). It hands its operands to the multiplier that the package gives it,
// and holds the result from its register's tick to tick Last (row_hold).
module row_product #(
    // The product's place in the package, and the tick of its register.
    parameter int Product   = 0,
    parameter int Written   = 32'(bitspan_cfg_pkg::RowTicks[16*Product+:16]) + bitspan_cfg_pkg::RowProductTicks,
    parameter int Last      = Written,
    parameter int AW        = 8,
    parameter int ASigned   = 1,
    parameter int BW        = 8,
    parameter int BSigned   = 1,
    parameter int OutW      = 8,
    parameter int OutFrac   = 0,
    parameter int OutSigned = 1,
    parameter int OutRnd    = 0,
    parameter int OutOvf    = 0,
    parameter int ShiftW    = 1,
    parameter int Depth     = (Last - Written) / bitspan_cfg_pkg::RowInterval + 1
) (
    input  logic                                         clk_i,
    input  logic                                         en_i,
    input  logic        [bitspan_cfg_pkg::RowPhaseW-1:0] phase_i,
    // At the product's tick; c is signed, on the sum's grid, which has RowSumBelow bits below the output's.
    input  logic        [                        AW-1:0] a_i,
    input  logic        [                        BW-1:0] b_i,
    input  logic signed [bitspan_cfg_pkg::ExponentW-1:0] e_i,
    input  logic        [    bitspan_cfg_pkg::RowCW-1:0] c_i,
    // To the multiplier, and from it a tick before the register's.
    output logic        [    bitspan_cfg_pkg::RowAW-1:0] a_o,
    output logic        [    bitspan_cfg_pkg::RowBW-1:0] b_o,
    output logic        [    bitspan_cfg_pkg::RowCW-1:0] c_o,
    output logic        [                    ShiftW-1:0] shift_o,
    input  logic        [bitspan_cfg_pkg::RowSumW+3-1:0] sum_i,
    output logic        [                Depth*OutW-1:0] q_o
);
  localparam int CW = bitspan_cfg_pkg::RowCW;
  localparam int Below = bitspan_cfg_pkg::RowSumBelow;
  // Rounding half up is half an ulp added in front of a floor.
  localparam bit HalfUp = OutRnd == 0;
  localparam logic [CW-1:0] Half = HalfUp ? CW'(1) << (Below - 1) : '0;
  assign a_o = bitspan_cfg_pkg::RowAW'($signed({(ASigned != 0) & a_i[AW-1], a_i}));
  assign b_o = bitspan_cfg_pkg::RowBW'($signed({(BSigned != 0) & b_i[BW-1], b_i}));
  assign c_o = c_i + Half;
  assign shift_o = ShiftW'(16'(e_i) + bitspan_cfg_pkg::RowShifts[16*Product+:16]);

  logic signed [bitspan_cfg_pkg::RowSumW-1:0] sum;
  logic sticky, far, sign;
  logic [OutW-1:0] q;
  assign {sum, sticky, far, sign} = sum_i;
  quantize_far #(
      .InW(bitspan_cfg_pkg::RowSumW),
      .InFrac(OutFrac + Below),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(HalfUp ? 5 : OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i(sticky),
      .far_i(far),
      .sign_i(sign),
      .q_o(q)
  );
  row_hold #(
      .Width(OutW),
      .Written(Written),
      .Last(Last)
  ) u_hold (
      .clk_i,
      .en_i,
      .phase_i,
      .d_i(q),
      .q_o
  );
endmodule
