// SPDX-License-Identifier: Apache-2.0
// Q[format](x) of docs/numeric-spec.md: rounds x_i to OutFrac fraction bits, then brings it into OutW bits.
// Combinational; quantize_far has it for values that are wider than x_i, too.
//
//   x_i        signed, InW bits, InFrac of them right of the point (may be negative or above InW)
//   sticky_i   1: the exact value lies strictly between x_i and x_i + 1 ulp; needs InFrac > OutFrac
//   q_o        raw bits of the format, two's complement when OutSigned
module quantize #(
    parameter int InW       = 8,
    parameter int InFrac    = 4,
    parameter int OutW      = 4,
    parameter int OutFrac   = 2,
    parameter int OutSigned = 1,
    parameter int Rounding  = 0,
    parameter int Overflow  = 0
) (
    input  logic signed [ InW-1:0] x_i,
    input  logic                   sticky_i,
    output logic        [OutW-1:0] q_o
);
  quantize_far #(
      .InW(InW),
      .InFrac(InFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(Rounding),
      .Overflow(Overflow)
  ) u_quantize_far (
      .x_i,
      .sticky_i,
      .far_i (1'b0),
      .sign_i(1'b0),
      .q_o
  );
endmodule
