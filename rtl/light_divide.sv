// SPDX-License-Identifier: Apache-2.0
// Q[format](a / T) of light in docs/numeric-spec.md, by the reciprocal square root of T: Clocks enabled clocks later, one per
// clock. Of a T that is not above 0 the last place stands for it.
//
//   t --> root --> m 2^-e --> Inv = Q[light.inverse](m m) --+
//   a ------------------------------------------------------+--> a Inv 2^-2e --> Q
module light_divide #(
    parameter int TW = 8,
    parameter int TFrac = 0,
    parameter int TSigned = 0,
    parameter int AW = 8,
    parameter int AFrac = 0,
    parameter int ASigned = 1,
    // Of a Inv; 1 where a is a constant.
    parameter int AClocks = 1,
    parameter int OutW = 8,
    parameter int OutFrac = 6,
    parameter int OutSigned = 1,
    parameter int OutRnd = 0,
    parameter int OutOvf = 1,
    parameter int RootClocks = 1,
    parameter int ProductClocks = 1,
    parameter int Clocks = 1
) (
    input  logic            clk_i,
    input  logic            rst_ni,
    input  logic            en_i,
    input  logic [  TW-1:0] t_i,
    input  logic [  AW-1:0] a_i,
    output logic [OutW-1:0] q_o
);
  localparam int MW = bitspan_light_pkg::LightRootW;
  localparam int MFrac = bitspan_light_pkg::LightRootFrac;
  localparam int MSigned = bitspan_light_pkg::LightRootSigned;
  localparam int InverseW = bitspan_light_pkg::LightInverseW;
  localparam int EW = bitspan_light_pkg::ExponentW;
  // The exponents of a T of one place and of the largest one, halved and rounded down.
  localparam int TopMin = -TFrac;
  localparam int TopMax = TW - 1 - TFrac;
  localparam int EMin = (TopMin >= 0) ? TopMin / 2 : -((1 - TopMin) / 2);
  localparam int EMax = (TopMax >= 0) ? TopMax / 2 : -((1 - TopMax) / 2);
  localparam int InverseAt = 1 + RootClocks + ProductClocks + 4;

  logic none;
  logic [TW-1:0] t_q;
  assign none = t_i == '0 || ((TSigned != 0) && t_i[TW-1]);
  always_ff @(posedge clk_i) begin
    if (en_i) t_q <= none ? TW'(1) : t_i;
  end
  logic [MW-1:0] m;
  logic signed [EW-1:0] e;
  root #(
      .DW(TW),
      .DFrac(TFrac),
      .OperandBits(bitspan_light_pkg::RootOperandBits),
      .IndexBits(bitspan_light_pkg::RootIndexBits),
      .TableBits(bitspan_light_pkg::RootTableBits),
      .InternalBits(bitspan_light_pkg::RootInternalBits),
      .Steps(bitspan_light_pkg::RootSteps),
      .OutW(MW),
      .OutFrac(MFrac),
      .OutSigned(MSigned),
      .OutRnd(bitspan_light_pkg::LightRootRnd),
      .OutOvf(bitspan_light_pkg::LightRootOvf),
      .EW(EW),
      .Table(bitspan_light_pkg::RootTable),
      .NormaliseClocks(bitspan_light_pkg::NormaliseClocks),
      .ProductClocks(ProductClocks),
      .Clocks(RootClocks)
  ) u_root (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(t_q),
      .m_o(m),
      .e_o(e)
  );
  logic [InverseW-1:0] inverse;
  multiply_round #(
      .AW(MW),
      .AFrac(MFrac),
      .ASigned(MSigned),
      .BW(MW),
      .BFrac(MFrac),
      .BSigned(MSigned),
      .OutW(InverseW),
      .OutFrac(bitspan_light_pkg::LightInverseFrac),
      .OutSigned(bitspan_light_pkg::LightInverseSigned),
      .OutRnd(bitspan_light_pkg::LightInverseRnd),
      .OutOvf(bitspan_light_pkg::LightInverseOvf),
      .ProductClocks(ProductClocks)
  ) u_inverse (
      .clk_i,
      .en_i,
      .a_i(m),
      .b_i(m),
      .c_i(1'sd0),
      .e_i(1'sd0),
      .q_o(inverse)
  );
  logic [EW-1:0] e_line;
  logic [AW-1:0] a;
  ring_line #(
      .Width(EW),
      .Depth(ProductClocks + 4)
  ) u_e_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(e),
      .q_o(e_line)
  );
  ring_line #(
      .Width(AW),
      .Depth(InverseAt)
  ) u_a_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(a_i),
      .q_o(a)
  );
  multiply_round #(
      .AW(AW),
      .AFrac(AFrac),
      .ASigned(ASigned),
      .BW(InverseW),
      .BFrac(bitspan_light_pkg::LightInverseFrac),
      .BSigned(bitspan_light_pkg::LightInverseSigned),
      .EW(EW + 1),
      .EMin(2 * EMin),
      .EMax(2 * EMax),
      .OutW(OutW),
      .OutFrac(OutFrac),
      .OutSigned(OutSigned),
      .OutRnd(OutRnd),
      .OutOvf(OutOvf),
      .ProductClocks(AClocks)
  ) u_quotient (
      .clk_i,
      .en_i,
      .a_i(a),
      .b_i(inverse),
      .c_i(1'sd0),
      .e_i({e_line, 1'b0}),
      .q_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == InverseAt + AClocks + 4)
    else $fatal(1, "light_divide: has %0d clocks, told %0d", InverseAt + AClocks + 4, Clocks);
  end
`endif
endmodule
