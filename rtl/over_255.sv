// SPDX-License-Identifier: Apache-2.0
// Q[format](v / 255) of an unsigned v, rounded once, 4 enabled clocks later.
//
// v / 255 = v (2^-8 + 2^-16 + ...). With K places of the sum, rounded up, and K not below the bits of v plus 8, the floor is
// exact, and the quotient has nothing behind it where the next 8 places are 0.
module over_255 #(
    parameter int InW = 8,
    parameter int InFrac = 0,
    parameter int OutW = 8,
    parameter int OutFrac = 7,
    parameter int OutSigned = 0,
    parameter int OutRnd = 0,
    parameter int OutOvf = 1
) (
    input  logic            clk_i,
    input  logic            en_i,
    input  logic [ InW-1:0] v_i,
    output logic [OutW-1:0] q_o
);
  // The quotient has at least one place below the output's.
  localparam int QuotientFrac = (OutFrac + 1 > InFrac) ? OutFrac + 1 : InFrac;
  localparam int Up = QuotientFrac - InFrac;
  localparam int QuotientW = InW + Up;
  localparam int K = (QuotientW + 8 <= 32) ? 32 : 64;
  localparam int ProductW = K + QuotientW;

  logic [ProductW-1:0] two_q, four_q, all_q, product;
  logic [InW-1:0] v_1, v_2;
  logic [QuotientW-1:0] quotient;
  logic [OutW-1:0] q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      v_1 <= v_i;
      v_2 <= v_1;
      two_q <= ProductW'(v_i) + (ProductW'(v_i) << 8);
      four_q <= two_q + (two_q << 16);
      all_q <= ((K == 64) ? four_q + (four_q << 32) : four_q) + ProductW'(v_2);
      q_o <= q;
    end
  end
  assign product = all_q << Up;
  assign quotient = product[K+:QuotientW];
  quantize #(
      .InW(QuotientW + 1),
      .InFrac(QuotientFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i({1'b0, quotient}),
      .sticky_i(|product[K-8+:8]),
      .q_o(q)
  );
  logic unused;
  assign unused = ^product[K-9:0];

`ifndef SYNTHESIS
  initial begin
    assert (QuotientW + 8 <= 64)
    else $fatal(1, "over_255: %0d bits of a quotient, at most 56", QuotientW);
  end
`endif
endmodule
