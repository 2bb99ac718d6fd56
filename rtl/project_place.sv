// SPDX-License-Identifier: Apache-2.0
// One coordinate of a fragment in the picture of a projector: Q[span.uv](value m 2^-e), and whether its floor lies in
// 0..side - 1. m and e come 1 + ProjectUnitClocks enabled clocks after value and side, and the results
// ProjectPlaceProductClocks + 4 clocks after m and e.
module project_place (
    input  logic                                                    clk_i,
    input  logic                                                    rst_ni,
    input  logic                                                    en_i,
    input  logic        [  bitspan_project_pkg::ProjectValueW-1:0] value_i,
    input  logic        [   bitspan_project_pkg::TextureSideW-1:0] side_i,
    input  logic        [bitspan_project_pkg::ProjectRecipOutW-1:0] m_i,
    input  logic signed [      bitspan_project_pkg::ExponentW-1:0] e_i,
    output logic        [        bitspan_project_pkg::SpanUvW-1:0] at_o,
    output logic                                                    contains_o
);
  localparam int ValueW = bitspan_project_pkg::ProjectValueW;
  localparam int SideW = bitspan_project_pkg::TextureSideW;
  localparam int UvW = bitspan_project_pkg::SpanUvW;
  localparam int UvFrac = bitspan_project_pkg::SpanUvFrac;
  localparam int UvSigned = bitspan_project_pkg::SpanUvSigned;
  localparam int RecipAt = 1 + bitspan_project_pkg::ProjectUnitClocks;
  localparam int PlaceAt = RecipAt + bitspan_project_pkg::ProjectPlaceProductClocks + 4;

  logic [ValueW-1:0] value;
  ring_line #(
      .Width(ValueW),
      .Depth(RecipAt)
  ) u_value_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(value_i),
      .q_o(value)
  );
  multiply_round #(
      .AW(ValueW),
      .AFrac(bitspan_project_pkg::ProjectValueFrac),
      .ASigned(bitspan_project_pkg::ProjectValueSigned),
      .BW(bitspan_project_pkg::ProjectRecipOutW),
      .BFrac(bitspan_project_pkg::ProjectRecipOutFrac),
      .BSigned(bitspan_project_pkg::ProjectRecipOutSigned),
      .EW(bitspan_project_pkg::ExponentW),
      .EMin(bitspan_project_pkg::ProjectRecipEMin),
      .EMax(bitspan_project_pkg::ProjectRecipEMax),
      .OutW(UvW),
      .OutFrac(UvFrac),
      .OutSigned(UvSigned),
      .OutRnd(bitspan_project_pkg::SpanUvRnd),
      .OutOvf(bitspan_project_pkg::SpanUvOvf),
      .ProductClocks(bitspan_project_pkg::ProjectPlaceProductClocks)
  ) u_place (
      .clk_i,
      .en_i,
      .a_i(value),
      .b_i(m_i),
      .c_i(1'sd0),
      .e_i,
      .q_o(at_o)
  );
  logic [SideW-1:0] side;
  ring_line #(
      .Width(SideW),
      .Depth(PlaceAt)
  ) u_side_line (
      .clk_i,
      .rst_ni,
      .en_i,
      .d_i(side_i),
      .q_o(side)
  );

  // Both on one grid, as signed numbers. A whole number is above the floor where it is above the place.
  localparam int SideShift = (UvFrac > 0) ? UvFrac : 0;
  localparam int UvShift = (UvFrac < 0) ? -UvFrac : 0;
  localparam int CompareW = ((UvW + UvShift > SideW + SideShift) ? UvW + UvShift : SideW + SideShift) + 1;
  logic signed [CompareW-1:0] placed, limit;
  assign placed = CompareW'($signed({(UvSigned != 0) & at_o[UvW-1], at_o})) <<< UvShift;
  assign limit = CompareW'({1'b0, side}) <<< SideShift;
  assign contains_o = !placed[CompareW-1] && placed < limit;
endmodule
