// SPDX-License-Identifier: Apache-2.0
// As multiply_round, for values that take turns in one multiplier: Q[format](a b 2^-e + c) of the one that select_i
// chose ProductClocks + 4 enabled clocks before. Value k stands at place k of the inputs. q_o is combinational.
//
//   operands | product: ProductClocks | shift (2) | sum |
module multiply_round_turns #(
    parameter int Turns         = 2,
    parameter int AW            = 8,
    parameter int AFrac         = 0,
    parameter int ASigned       = 1,
    parameter int BW            = 8,
    parameter int BFrac         = 0,
    parameter int BSigned       = 1,
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
    parameter int ProductClocks = 3,
    parameter int Digits        = 1
) (
    input  logic                clk_i,
    input  logic                rst_ni,
    input  logic                en_i,
    input  logic [   Turns-1:0] select_i,
    input  logic [Turns*AW-1:0] a_i,
    input  logic [Turns*BW-1:0] b_i,
    // Signed.
    input  logic [Turns*CW-1:0] c_i,
    input  logic [Turns*EW-1:0] e_i,
    output logic [    OutW-1:0] q_o
);
  // The sum's grid and room as in multiply_round. Factors get a sign.
  localparam int SumFrac = (CFrac > OutFrac + 1) ? CFrac : OutFrac + 1;
  localparam int Below = SumFrac - OutFrac;
  localparam int HalfUp = (OutRnd == 0) ? 1 : 0;
  localparam int PlacedCW = CW + SumFrac - CFrac + HalfUp;
  localparam logic signed [PlacedCW-1:0] Half = (HalfUp != 0) ? PlacedCW'(1) <<< (Below - 1) : '0;
  localparam int RoomW = (OutW + Below + 1 > PlacedCW) ? OutW + Below + 1 : PlacedCW;
  localparam int SumW = RoomW + 4;
  localparam int ShiftMax = EMax - EMin;
  localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;
  localparam int FactorAW = AW + ((ASigned != 0) ? 0 : 1);
  localparam int FactorBW = BW + ((BSigned != 0) ? 0 : 1);

  logic [Turns*FactorAW-1:0] a;
  logic [Turns*FactorBW-1:0] b;
  logic [Turns*PlacedCW-1:0] c;
  logic [Turns*ShiftW-1:0] shift;
  for (genvar k = 0; k < Turns; k++) begin : gen_turn
    logic signed [CW-1:0] addend;
    logic signed [EW-1:0] exponent;
    assign addend = c_i[k*CW+:CW];
    assign exponent = e_i[k*EW+:EW];
    assign a[k*FactorAW+:FactorAW] = FactorAW'(a_i[k*AW+:AW]);
    assign b[k*FactorBW+:FactorBW] = FactorBW'(b_i[k*BW+:BW]);
    assign c[k*PlacedCW+:PlacedCW] = (PlacedCW'(addend) <<< (SumFrac - CFrac)) + Half;
    assign shift[k*ShiftW+:ShiftW] = ShiftW'(exponent - EW'(EMin));
  end
  logic [FactorAW+FactorBW-1:0] unused_product;
  logic signed [SumW-1:0] sum;
  logic sticky, far, sign;
  setup_mac #(
      .Products(Turns),
      .AW(FactorAW),
      .BW(FactorBW),
      .CW(PlacedCW),
      .SumW(SumW),
      .ShiftBase(AFrac + BFrac + EMin - SumFrac),
      .ShiftMax(ShiftMax),
      .ProductClocks(ProductClocks),
      .Digits(Digits)
  ) u_mac (
      .clk_i,
      .rst_ni,
      .en_i,
      .select_i,
      .a_i(a),
      .b_i(b),
      .c_i(c),
      .shift_i(shift),
      .product_o(unused_product),
      .sum_o({sum, sticky, far, sign})
  );
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
      .q_o
  );
endmodule
