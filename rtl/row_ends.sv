// SPDX-License-Identifier: Apache-2.0
// What row_line takes of a line that is given at both ends of a row: the numerator right - left at the slope's tick, and
// left + its offset, on the sum's grid, at the start's tick.
module row_ends #(
    // The line's place in the package.
    parameter int Line = 0,
    parameter int EndW = bitspan_cfg_pkg::LineEndW[32*Line+:32]
) (
    input  logic                                         clk_i,
    input  logic                                         en_i,
    input  logic        [bitspan_cfg_pkg::RowPhaseW-1:0] phase_i,
    // At tick 0.
    input  logic        [                      EndW-1:0] left_i,
    input  logic        [                      EndW-1:0] right_i,
    output logic signed [                        EndW:0] n_o,
    output logic signed [    bitspan_cfg_pkg::RowCW-1:0] c_o
);
  localparam int CW = bitspan_cfg_pkg::RowCW;
  localparam int EndSigned = bitspan_cfg_pkg::LineEndSigned[32*Line+:32];
  localparam int AccFrac = bitspan_cfg_pkg::LineAccFrac[32*Line+:32];
  localparam int EndFrac = bitspan_cfg_pkg::LineEndFrac[32*Line+:32];
  localparam logic signed [CW-1:0] Offset = bitspan_cfg_pkg::LineOffset[Line*CW+:CW];
  localparam int Slope = bitspan_cfg_pkg::LineSlope[32*Line+:32];
  localparam int Start = bitspan_cfg_pkg::LineStart[32*Line+:32];
  localparam int Interval = bitspan_cfg_pkg::RowInterval;
  localparam int SlopeTick = (bitspan_cfg_pkg::RowSlopeDivide != 0) ? bitspan_cfg_pkg::RowDivideTick :
      32'(bitspan_cfg_pkg::RowTicks[16*Slope+:16]);
  localparam int StartTick = 32'(bitspan_cfg_pkg::RowTicks[16*Start+:16]);
  logic [((SlopeTick-1)/Interval+1)*(EndW+1)-1:0] n_q;
  logic [((StartTick-1)/Interval+1)*EndW-1:0] left_q;
  logic [EndW-1:0] left;
  row_hold #(
      .Width(EndW + 1),
      .Written(1),
      .Last(SlopeTick)
  ) u_n (
      .clk_i,
      .en_i,
      .phase_i,
      .d_i({(EndSigned != 0) & right_i[EndW-1], right_i} - {(EndSigned != 0) & left_i[EndW-1], left_i}),
      .q_o(n_q)
  );
  row_hold #(
      .Width(EndW),
      .Written(1),
      .Last(StartTick)
  ) u_left (
      .clk_i,
      .en_i,
      .phase_i,
      .d_i(left_i),
      .q_o(left_q)
  );
  assign n_o = n_q[(SlopeTick-1)/Interval*(EndW+1)+:EndW+1];
  assign left = left_q[(StartTick-1)/Interval*EndW+:EndW];
  assign c_o = (CW'($signed({(EndSigned != 0) & left[EndW-1], left})) <<<
                (AccFrac + bitspan_cfg_pkg::RowSumBelow - EndFrac)) + Offset;
  logic unused;
  assign unused = ^{n_q, left_q};
endmodule
