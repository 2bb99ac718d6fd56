// SPDX-License-Identifier: Apache-2.0
// The register of one product of span_setup: Q of the multiplier's sum, held from tick Written to tick Last (row_hold).
module row_result #(
    parameter int SumW      = 16,
    parameter int Below     = 1,
    parameter int OutW      = 8,
    parameter int OutFrac   = 0,
    parameter int OutSigned = 1,
    parameter int OutRnd    = 0,
    parameter int OutOvf    = 0,
    parameter int Interval  = 1,
    parameter int Written   = 1,
    parameter int Last      = 1,
    parameter int PhaseW    = 1,
    parameter int Depth     = (Last - Written) / Interval + 1
) (
    input  logic                         clk_i,
    input  logic                         en_i,
    input  logic        [    PhaseW-1:0] phase_i,
    // At tick Written - 1, the sum, signed, with Below bits below the output's. Where the format rounds half up, half
    // an ulp is in it already.
    input  logic        [      SumW-1:0] sum_i,
    input  logic                         sticky_i,
    input  logic                         far_i,
    input  logic                         sign_i,
    output logic        [Depth*OutW-1:0] q_o
);
  logic signed [SumW-1:0] sum;
  logic [OutW-1:0] q;
  assign sum = sum_i;
  quantize_far #(
      .InW(SumW),
      .InFrac(OutFrac + Below),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd == 0 ? 5 : OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i,
      .far_i,
      .sign_i,
      .q_o(q)
  );
  row_hold #(
      .Width(OutW),
      .Interval(Interval),
      .Written(Written),
      .Last(Last),
      .PhaseW(PhaseW)
  ) u_hold (
      .clk_i,
      .en_i,
      .phase_i,
      .d_i(q),
      .q_o
  );
endmodule
