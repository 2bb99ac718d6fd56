// SPDX-License-Identifier: Apache-2.0
// Q[format](a b 2^-e + c), exact up to the one quantisation, ProductClocks + 4 enabled clocks later.
//
//   a_i, b_i, c_i  raw values on AFrac, BFrac, CFrac fraction bits, c_i signed
//   e_i            signed, EMin..EMax
//
//   product: ProductClocks | shift (2) | sum | Q |
module multiply_round #(
    parameter int AW            = 8,
    parameter int AFrac         = 0,
    parameter int ASigned       = 1,
    parameter int BW            = 8,
    parameter int BFrac         = 0,
    parameter int BSigned       = 1,
    parameter int BTopAlone     = 0,
    parameter int CW            = 1,
    parameter int CFrac         = 0,
    parameter int EW            = 1,
    parameter int EMin          = 0,
    parameter int EMax          = 0,
    parameter int OutW          = 8,
    parameter int OutFrac       = 0,
    parameter int OutSigned     = 1,
    parameter int OutRnd        = 0,
    parameter int OutOvf        = 0,
    parameter int ProductClocks = 3
) (
    input  logic                   clk_i,
    input  logic                   en_i,
    input  logic        [  AW-1:0] a_i,
    input  logic        [  BW-1:0] b_i,
    input  logic signed [  CW-1:0] c_i,
    input  logic signed [  EW-1:0] e_i,
    output logic        [OutW-1:0] q_o
);
  // The sum lies on the grid of c, and at least one place below the output's.
  localparam int SumFrac = (CFrac > OutFrac + 1) ? CFrac : OutFrac + 1;
  localparam int Below = SumFrac - OutFrac;
  // Rounding half up is half an ulp added in front of a floor.
  localparam int HalfUp = (OutRnd == 0) ? 1 : 0;
  localparam int PlacedCW = CW + SumFrac - CFrac + HalfUp;
  localparam logic signed [PlacedCW-1:0] Half = (HalfUp != 0) ? PlacedCW'(1) <<< (Below - 1) : '0;
  localparam int RoomW = (OutW + Below + 1 > PlacedCW) ? OutW + Below + 1 : PlacedCW;
  localparam int SumW = RoomW + 4;
  localparam int ShiftMax = EMax - EMin;
  localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;

  // A product of unsigned factors gets a sign.
  localparam int SignW = (ASigned == 0 && BSigned == 0) ? 1 : 0;
  logic [AW+BW-1:0] product;
  logic signed [AW+BW+SignW-1:0] signed_product;
  mul_pipe #(
      .AW(AW),
      .BW(BW),
      .ASigned(ASigned),
      .BSigned(BSigned),
      .BTopAlone(BTopAlone),
      .Clocks(ProductClocks)
  ) u_product (
      .clk_i,
      .en_i,
      .a_i,
      .b_i,
      .p_o(product)
  );
  if (SignW != 0) begin : gen_unsigned
    assign signed_product = {1'b0, product};
  end else begin : gen_signed
    assign signed_product = product;
  end

  logic [ShiftW-1:0] shift, shift_p;
  assign shift = ShiftW'(e_i - EW'(EMin));
  delay_line #(
      .Width(ShiftW),
      .Depth(ProductClocks)
  ) u_shift (
      .clk_i,
      .en_i,
      .d_i(shift),
      .q_o(shift_p)
  );
  logic [PlacedCW-1:0] c_sum;
  logic signed [PlacedCW-1:0] c;
  assign c = (PlacedCW'(c_i) <<< (SumFrac - CFrac)) + Half;
  delay_line #(
      .Width(PlacedCW),
      .Depth(ProductClocks + 2)
  ) u_c (
      .clk_i,
      .en_i,
      .d_i(c),
      .q_o(c_sum)
  );
  logic signed [PlacedCW-1:0] signed_c;
  assign signed_c = c_sum;
  logic signed [SumW-1:0] sum;
  logic sticky, far, sign;
  shift_add #(
      .InW(AW + BW + SignW),
      .Base(AFrac + BFrac + EMin - SumFrac),
      .ShiftMax(ShiftMax),
      .CW(PlacedCW),
      .KeptW(SumW)
  ) u_sum (
      .clk_i,
      .en_i,
      .x_i(signed_product),
      .shift_i(shift_p),
      .c_i(signed_c),
      .sum_o(sum),
      .sticky_o(sticky),
      .far_o(far),
      .sign_o(sign)
  );
  logic [OutW-1:0] q;
  quantize_far #(
      .InW(SumW),
      .InFrac(SumFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(HalfUp != 0 ? 5 : OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i(sticky),
      .far_i(far),
      .sign_i(sign),
      .q_o(q)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) q_o <= q;
  end
endmodule
