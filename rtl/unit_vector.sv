// SPDX-License-Identifier: Apache-2.0
// Unit(X) of docs/numeric-spec.md: the vector x_i 2^-XFrac divided by its length, each part rounded once; 0 where X is.
// Clocks enabled clocks later, one per clock.
//
//   x --> squares, their sum d --> root --> m 2^-e --+
//   x ----------------------------------------------+--> x m 2^-e --> Q
module unit_vector #(
    parameter int XW = 8,
    parameter int XFrac = 0,
    parameter int OutW = 8,
    parameter int OutFrac = 6,
    parameter int OutSigned = 1,
    parameter int OutRnd = 0,
    parameter int OutOvf = 1,
    parameter int RootClocks = 1,
    parameter int ProductClocks = 1,
    parameter int Clocks = 1
) (
    input  logic                      clk_i,
    input  logic                      rst_ni,
    input  logic                      en_i,
    // Part 0 in the low bits.
    input  logic        [   3*XW-1:0] x_i,
    output logic        [ 3*OutW-1:0] unit_o
);
  localparam int DW = 2 * XW;
  localparam int DFrac = 2 * XFrac;
  localparam int MW = bitspan_light_pkg::LightRootW;
  localparam int EW = bitspan_light_pkg::ExponentW;
  // The exponents of a d of 1 and of the largest one, halved and rounded down.
  localparam int EMin = (DFrac > 0) ? -((DFrac + 1) / 2) : (-DFrac) / 2;
  localparam int TopMax = DW - 1 - DFrac;
  localparam int EMax = (TopMax >= 0) ? TopMax / 2 : -((1 - TopMax) / 2);

  logic [2*XW-1:0] square[3];
  for (genvar i = 0; i < 3; i++) begin : gen_square
    logic [XW-1:0] part;
    assign part = x_i[i*XW+:XW];
    mul_pipe #(
        .AW(XW),
        .BW(XW),
        .Same(1),
        .Clocks(ProductClocks)
    ) u_square (
        .clk_i,
        .en_i,
        .a_i(part),
        .b_i(part),
        .p_o(square[i])
    );
  end
  // A vector without a length has the square of a length of 1 ulp.
  logic none_q, none;
  always_ff @(posedge clk_i) begin
    if (en_i) none_q <= x_i == '0;
  end
  delay_line #(
      .Width(1),
      .Depth(ProductClocks - 1)
  ) u_none (
      .clk_i,
      .en_i,
      .d_i(none_q),
      .q_o(none)
  );
  logic [DW-1:0] two_q, third_q, d_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      two_q   <= square[0] + square[1];
      third_q <= square[2] | DW'(none);
      d_q     <= two_q + third_q;
    end
  end
  logic [MW-1:0] m;
  logic signed [EW-1:0] e;
  root #(
      .DW(DW),
      .DFrac(DFrac),
      .OperandBits(bitspan_light_pkg::RootOperandBits),
      .IndexBits(bitspan_light_pkg::RootIndexBits),
      .TableBits(bitspan_light_pkg::RootTableBits),
      .InternalBits(bitspan_light_pkg::RootInternalBits),
      .Steps(bitspan_light_pkg::RootSteps),
      .OutW(MW),
      .OutFrac(bitspan_light_pkg::LightRootFrac),
      .OutSigned(bitspan_light_pkg::LightRootSigned),
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
      .d_i(d_q),
      .m_o(m),
      .e_o(e)
  );
  logic [3*XW-1:0] x;
  ring_line #(
      .Width(3 * XW),
      .Depth(ProductClocks + 2 + RootClocks)
  ) u_x_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(x_i),
      .q_o(x)
  );
  for (genvar i = 0; i < 3; i++) begin : gen_part
    multiply_round #(
        .AW(XW),
        .AFrac(XFrac),
        .BW(MW),
        .BFrac(bitspan_light_pkg::LightRootFrac),
        .BSigned(bitspan_light_pkg::LightRootSigned),
        .EW(EW),
        .EMin(EMin),
        .EMax(EMax),
        .OutW(OutW),
        .OutFrac(OutFrac),
        .OutSigned(OutSigned),
        .OutRnd(OutRnd),
        .OutOvf(OutOvf),
        .ProductClocks(ProductClocks)
    ) u_part (
        .clk_i,
        .en_i,
        .a_i(x[i*XW+:XW]),
        .b_i(m),
        .c_i(1'sd0),
        .e_i(e),
        .q_o(unit_o[i*OutW+:OutW])
    );
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == 2 * ProductClocks + RootClocks + 6)
    else $fatal(1, "unit_vector: has %0d clocks, told %0d", 2 * ProductClocks + RootClocks + 6, Clocks);
  end
`endif
endmodule
