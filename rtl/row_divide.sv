// SPDX-License-Identifier: Apache-2.0
// A slope of span_setup by division: Q[Out](n / d), held from the quotients' tick to tick Last (row_hold). All dividers
// start together, at RowDivideTick.
module row_divide #(
    parameter int NW           = 8,
    parameter int DW           = 8,
    parameter int QuotientFrac = 0,
    parameter int OutW         = 8,
    parameter int OutFrac      = 0,
    parameter int OutSigned    = 1,
    parameter int OutRnd       = 0,
    parameter int OutOvf       = 0,
    parameter int Written      = bitspan_cfg_pkg::RowDivideTick + bitspan_cfg_pkg::RowUnitClocks + 1,
    parameter int Last         = Written,
    parameter int Depth        = (Last - Written) / bitspan_cfg_pkg::RowInterval + 1
) (
    input  logic                                         clk_i,
    input  logic                                         rst_ni,
    input  logic                                         en_i,
    input  logic        [bitspan_cfg_pkg::RowPhaseW-1:0] phase_i,
    // At RowDivideTick, of a row that is valid.
    input  logic                                         start_i,
    input  logic signed [                        NW-1:0] n_i,
    input  logic        [                        DW-1:0] d_i,
    // A tick before the register's; 0: the row has no length, and no slope.
    input  logic                                         has_length_i,
    output logic        [                Depth*OutW-1:0] q_o
);
  localparam int QuotientW = bitspan_cfg_pkg::RowDivIterations * bitspan_cfg_pkg::RowRecipBitsPerCycle + 1;
  logic signed [QuotientW-1:0] quotient;
  logic sticky;
  logic [OutW-1:0] q;
  divide #(
      .NW(NW),
      .DW(DW),
      .Iterations(bitspan_cfg_pkg::RowDivIterations),
      .BitsPerCycle(bitspan_cfg_pkg::RowRecipBitsPerCycle),
      .Pipelined(bitspan_cfg_pkg::RowRecipPipelined)
  ) u_divide (
      .clk_i,
      .rst_ni,
      .en_i,
      .start_i,
      .n_i,
      .d_i,
      .q_o(quotient),
      .sticky_o(sticky)
  );
  quantize #(
      .InW(QuotientW),
      .InFrac(QuotientFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(quotient),
      .sticky_i(sticky),
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
      .d_i(q & {OutW{has_length_i}}),
      .q_o
  );
endmodule
