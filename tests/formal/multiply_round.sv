// SPDX-License-Identifier: Apache-2.0
// rtl/multiply_round.sv, and so shift_add.sv and quantize_far.sv, against quantize.sv on the exact sum, of which no
// bit is cut: every rounding and overflow mode. The registers begin with any values, and en_i may fall at any time.
//
// A factor of few bits is enough: what is proven stands behind the product.
module multiply_round_proof #(
    parameter int AW        = 8,
    parameter int AFrac     = 4,
    parameter int ASigned   = 1,
    parameter int BW        = 2,
    parameter int CW        = 5,
    parameter int CFrac     = 2,
    parameter int EW        = 5,
    parameter int EMin      = 0,
    parameter int EMax      = 9,
    parameter int OutW      = 4,
    parameter int OutFrac   = 1,
    parameter int OutSigned = 1
) (
    input logic                 clk_i,
    input logic                 en_i,
    input logic        [AW-1:0] a_i,
    input logic        [BW-1:0] b_i,
    input logic signed [CW-1:0] c_i,
    input logic signed [EW-1:0] e_i
);
  localparam int Clocks = 5;
  logic [AW-1:0] a;
  logic [BW-1:0] b;
  logic [CW-1:0] c;
  logic [EW-1:0] e;
  delay_line #(
      .Width(AW + BW + CW + EW),
      .Depth(Clocks)
  ) u_inputs (
      .clk_i,
      .en_i,
      .d_i({a_i, b_i, c_i, e_i}),
      .q_o({a, b, c, e})
  );
  logic [2:0] filled_q;
  initial filled_q = '0;
  always_ff @(posedge clk_i) begin
    if (en_i && filled_q != 3'(Clocks)) filled_q <= filled_q + 3'd1;
  end
  always_comb assume ($signed(e_i) >= EW'(EMin) && $signed(e_i) <= EW'(EMax));

  // The finest of all grids, and room for either summand on it.
  localparam int ProductFrac = AFrac + EMax;
  localparam int Finer = (ProductFrac > CFrac) ? ProductFrac : CFrac;
  localparam int WideFrac = (Finer > OutFrac) ? Finer : OutFrac + 1;
  localparam int ProductW = AW + BW + 1 + WideFrac - AFrac - EMin;
  localparam int AddendW = CW + WideFrac - CFrac;
  localparam int WideW = ((ProductW > AddendW) ? ProductW : AddendW) + 1;
  logic signed [AW:0] a_sign;
  logic signed [EW-1:0] e_sign;
  logic signed [CW-1:0] c_sign;
  logic signed [WideW-1:0] product, wide;
  logic [WideW-1:0] places;
  assign a_sign = {(ASigned != 0) & a[AW-1], a};
  assign e_sign = e;
  assign c_sign = c;
  assign product = WideW'(a_sign) * WideW'($signed({1'b0, b}));
  assign places = WideW'(WideFrac - AFrac) - WideW'(e_sign);
  assign wide = (product <<< places) + (WideW'(c_sign) <<< (WideFrac - CFrac));

  for (genvar rounding = 0; rounding < 7; rounding++) begin : gen_rounding
    for (genvar overflow = 0; overflow < 4 + OutSigned; overflow++) begin : gen_overflow
      logic [OutW-1:0] q, expected;
      multiply_round #(
          .AW(AW),
          .AFrac(AFrac),
          .ASigned(ASigned),
          .BW(BW),
          .BSigned(0),
          .CW(CW),
          .CFrac(CFrac),
          .EW(EW),
          .EMin(EMin),
          .EMax(EMax),
          .OutW(OutW),
          .OutFrac(OutFrac),
          .OutSigned(OutSigned),
          .OutRnd(rounding),
          .OutOvf(overflow),
          .ProductClocks(1)
      ) u_narrow (
          .clk_i,
          .en_i,
          .a_i,
          .b_i,
          .c_i,
          .e_i,
          .q_o(q)
      );
      quantize #(
          .InW(WideW),
          .InFrac(WideFrac),
          .OutW(OutW),
          .OutFrac(OutFrac),
          .OutSigned(OutSigned),
          .Rounding(rounding),
          .Overflow(overflow)
      ) u_wide (
          .x_i(wide),
          .sticky_i(1'b0),
          .q_o(expected)
      );
      always_comb begin
        if (filled_q == 3'(Clocks)) assert (q == expected);
      end
    end
  end
endmodule
