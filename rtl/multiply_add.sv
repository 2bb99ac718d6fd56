// SPDX-License-Identifier: Apache-2.0
// Q[format](a b 2^-e + c + offset), exact up to the one quantisation. Combinational.
//
//   a_i, b_i, c_i  signed raw values on AFrac, BFrac, CFrac fraction bits
//   e_i            signed, EMin..EMax; ignored where EMin = EMax = 0
//   offset         the constant OffsetRaw 2^-OffsetFrac
module multiply_add #(
    parameter int AW          = 8,
    parameter int AFrac       = 0,
    parameter int BW          = 8,
    parameter int BFrac       = 0,
    parameter int CW          = 1,
    parameter int CFrac       = 0,
    parameter int EW          = 1,
    parameter int EMin        = 0,
    parameter int EMax        = 0,
    parameter int OffsetW     = 1,
    parameter logic signed [OffsetW-1:0] OffsetRaw = '0,
    parameter int OffsetFrac  = 0,
    parameter int OutW        = 8,
    parameter int OutFrac     = 0,
    parameter int OutSigned   = 1,
    parameter int OutRnd      = 0,
    parameter int OutOvf      = 0
) (
    input  logic signed [  AW-1:0] a_i,
    input  logic signed [  BW-1:0] b_i,
    input  logic signed [  CW-1:0] c_i,
    input  logic signed [  EW-1:0] e_i,
    output logic        [OutW-1:0] q_o
);
  localparam int ProductW = AW + BW;
  localparam int ProductFrac = AFrac + BFrac;
  // The product with the binary point where the largest exponent needs it: a left shift by EMax - e is exact.
  localparam int ScaledW = ProductW + EMax - EMin;
  localparam int ScaledFrac = ProductFrac + EMax;

  localparam int Frac1 = (ScaledFrac > CFrac) ? ScaledFrac : CFrac;
  localparam int SumFrac = (Frac1 > OffsetFrac || OffsetRaw == 0) ? Frac1 : OffsetFrac;
  // Integer bits of each addend; two more hold the carries.
  localparam int Int1 = (ScaledW - ScaledFrac > CW - CFrac) ? ScaledW - ScaledFrac : CW - CFrac;
  localparam int OffsetInt = (OffsetRaw == 0) ? Int1 : OffsetW - OffsetFrac;
  localparam int SumInt = ((Int1 > OffsetInt) ? Int1 : OffsetInt) + 2;
  localparam int SumW = SumInt + SumFrac;
  localparam int OffsetShift = (OffsetRaw == 0) ? 0 : SumFrac - OffsetFrac;
  localparam logic signed [SumW-1:0] Offset = SumW'(OffsetRaw) <<< OffsetShift;

  logic signed [ProductW-1:0] product;
  logic signed [ScaledW-1:0] scaled;
  logic signed [SumW-1:0] sum;

  assign product = ProductW'(a_i) * ProductW'(b_i);

  if (EMax > EMin) begin : gen_scale
    logic signed [EW:0] shift;
    assign shift = (EW + 1)'(EMax) - (EW + 1)'(e_i);
    assign scaled = ScaledW'(product) <<< shift[EW-1:0];
    logic unused;
    assign unused = shift[EW];
  end else begin : gen_no_scale
    assign scaled = product;
    logic unused;
    assign unused = ^e_i;
  end

  assign sum = (SumW'(scaled) <<< (SumFrac - ScaledFrac)) + (SumW'(c_i) <<< (SumFrac - CFrac)) + Offset;

  quantize #(
      .InW(SumW),
      .InFrac(SumFrac),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .Rounding(OutRnd),
      .Overflow(OutOvf)
  ) u_quantize (
      .x_i(sum),
      .sticky_i(1'b0),
      .q_o
  );
endmodule
