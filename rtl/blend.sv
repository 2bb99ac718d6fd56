// SPDX-License-Identifier: Apache-2.0
// q_o = Q[Out](a (1 - e) + b e), formed as a + (b - a) e, which is exact up to the Q; Clocks enabled clocks later.
//
//   clocks  | b - a | (b - a) e: ProductClocks | a + | Q |
module blend #(
    parameter int AW        = 8,
    parameter int AFrac     = 0,
    parameter int ASigned   = 0,
    parameter int BW        = 8,
    parameter int BFrac     = 0,
    parameter int BSigned   = 0,
    parameter int EW        = 8,
    parameter int EFrac     = 8,
    parameter int ESigned   = 0,
    parameter int OutW      = 8,
    parameter int OutFrac   = 0,
    parameter int OutSigned = 0,
    parameter int OutRnd    = 0,
    parameter int OutOvf    = 1,
    parameter int ProductClocks = 1,
    parameter int Clocks        = 4
) (
    input  logic            clk_i,
    input  logic            en_i,
    input  logic [  AW-1:0] a_i,
    input  logic [  BW-1:0] b_i,
    input  logic [  EW-1:0] e_i,
    output logic [OutW-1:0] q_o
);
  // a and b on one grid, as signed numbers.
  localparam int Frac = (AFrac > BFrac) ? AFrac : BFrac;
  localparam int ASpanW = AW + Frac - AFrac + ((ASigned != 0) ? 0 : 1);
  localparam int BSpanW = BW + Frac - BFrac + ((BSigned != 0) ? 0 : 1);
  localparam int WiderW = (ASpanW > BSpanW) ? ASpanW : BSpanW;
  // Two numbers that are never negative differ by no more than the larger.
  localparam int DiffW = (ASigned != 0 || BSigned != 0) ? WiderW + 1 : WiderW;
  localparam int FactorW = EW + ((ESigned != 0) ? 0 : 1);
  localparam int ProductW = DiffW + FactorW;
  localparam int StartW = ASpanW + EFrac;
  localparam int SumW = ((StartW > ProductW) ? StartW : ProductW) + 1;

  logic signed [ASpanW-1:0] a, a_q, a_product;
  logic signed [BSpanW-1:0] b;
  logic signed [DiffW-1:0] diff_q;
  logic signed [FactorW-1:0] e_q;
  logic signed [ProductW-1:0] product;
  logic signed [SumW-1:0] sum_q;
  logic [OutW-1:0] q;
  assign a = ASpanW'($signed({(ASigned != 0) & a_i[AW-1], a_i})) <<< (Frac - AFrac);
  assign b = BSpanW'($signed({(BSigned != 0) & b_i[BW-1], b_i})) <<< (Frac - BFrac);
  mul_pipe #(
      .AW(DiffW),
      .BW(FactorW),
      .Clocks(ProductClocks)
  ) u_product (
      .clk_i,
      .en_i,
      .a_i(diff_q),
      .b_i(e_q),
      .p_o(product)
  );
  delay_line #(
      .Width(ASpanW),
      .Depth(ProductClocks)
  ) u_a_line (
      .clk_i,
      .en_i,
      .d_i(a_q),
      .q_o(a_product)
  );
  quantize #(
      .InW(SumW),
      .InFrac(Frac + EFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(sum_q),
      .sticky_i(1'b0),
      .q_o(q)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      diff_q <= DiffW'(b) - DiffW'(a);
      a_q <= a;
      e_q <= FactorW'($signed({(ESigned != 0) & e_i[EW-1], e_i}));
      sum_q <= (SumW'(a_product) <<< EFrac) + SumW'(product);
      q_o <= q;
    end
  end

`ifndef SYNTHESIS
  initial begin
    assert (EFrac >= 0)
    else $fatal(1, "blend: e has no places left of its last one");
    assert (Clocks == ProductClocks + 3)
    else $fatal(1, "blend: has %0d clocks, told %0d", ProductClocks + 3, Clocks);
  end
`endif
endmodule
