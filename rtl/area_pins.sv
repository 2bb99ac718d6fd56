// SPDX-License-Identifier: Apache-2.0
// Puts area_top between registers that seven pins reach. Inputs come out of a shift register, and outputs are folded by
// XOR, four bits per clock and level. Both ends of every path of area_top are therefore registers. The netlist of
// area_top goes in as it was counted. This costs one more flip-flop per input bit, and 4/3 flip-flops and 1/3 LUT per
// output bit.
module area_pins (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic in_valid_i,
    input  logic serial_i,
    input  logic out_ready_i,
    output logic in_ready_o,
    output logic folded_o
);
  localparam int IndexW = bitspan_cfg_pkg::PixelIndexW;
  localparam int EndsW = 2 * bitspan_cfg_pkg::EdgeXW + 2 * bitspan_cfg_pkg::EdgeHW + 4 * bitspan_cfg_pkg::EdgeUvW;
  localparam int PlaneW = bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW + bitspan_cfg_pkg::SpanHW +
      2 * bitspan_cfg_pkg::SpanFW + 4 * bitspan_cfg_pkg::SpanFStepW;
  localparam int LineW = (bitspan_cfg_pkg::DigitalLine != bitspan_cfg_pkg::ConstDepthRows) ?
      bitspan_cfg_pkg::PhaseW + bitspan_cfg_pkg::PlaneKW : 0;
  localparam int RowW = (bitspan_cfg_pkg::ConstDepthRows != 0) ?
      PlaneW + ((bitspan_cfg_pkg::Lines > 3) ? bitspan_cfg_pkg::SidesAccW + 2 * bitspan_cfg_pkg::SidesStepW : 0) :
      LineW + EndsW + ((bitspan_cfg_pkg::Lines > 3) ? 2 * bitspan_cfg_pkg::SidesEndW : 0);
  localparam int InW = bitspan_cfg_pkg::SetupBW + 2 * IndexW + RowW;
  localparam int PixelW = IndexW + 2 + bitspan_cfg_pkg::SpanHW + 2 * bitspan_cfg_pkg::SpanUvW +
      ((bitspan_cfg_pkg::Lines > 3) ? bitspan_cfg_pkg::SidesW : 0);
  localparam int OutW = 1 + PixelW;

  logic [InW-1:0] in_q;
  logic valid_q, ready_q, in_ready;
  logic [OutW-1:0] out, out_q;
  always_ff @(posedge clk_i) begin
    in_q <= {in_q[InW-2:0], serial_i};
    valid_q <= in_valid_i;
    ready_q <= out_ready_i;
    in_ready_o <= in_ready;
    out_q <= out;
  end

  logic out_valid;
  logic [PixelW-1:0] pixel;
  assign out = {out_valid, pixel};
  area_top u_area_top (
      .clk_i,
      .rst_ni,
      .b_i(in_q[InW-1-:bitspan_cfg_pkg::SetupBW]),
      .in_valid_i(valid_q),
      .in_ready_o(in_ready),
      .x_first_i(in_q[RowW+IndexW+:IndexW]),
      .count_i(in_q[RowW+:IndexW]),
      .row_i(in_q[RowW-1:0]),
      .out_valid_o(out_valid),
      .out_ready_i(ready_q),
      .pixel_o(pixel)
  );

  // Levels of the fold: OutW stays under 4^5.
  localparam int W1 = (OutW + 3) / 4;
  localparam int W2 = (W1 + 3) / 4;
  localparam int W3 = (W2 + 3) / 4;
  localparam int W4 = (W3 + 3) / 4;
  logic [W1-1:0] fold1_q;
  logic [W2-1:0] fold2_q;
  logic [W3-1:0] fold3_q;
  logic [W4-1:0] fold4_q;
  logic [4*W1-1:0] level0;
  logic [4*W2-1:0] level1;
  logic [4*W3-1:0] level2;
  logic [4*W4-1:0] level3;
  assign level0 = (4 * W1)'(out_q);
  assign level1 = (4 * W2)'(fold1_q);
  assign level2 = (4 * W3)'(fold2_q);
  assign level3 = (4 * W4)'(fold3_q);
  always_ff @(posedge clk_i) begin
    for (int i = 0; i < W1; i++) fold1_q[i] <= ^level0[4*i+:4];
    for (int i = 0; i < W2; i++) fold2_q[i] <= ^level1[4*i+:4];
    for (int i = 0; i < W3; i++) fold3_q[i] <= ^level2[4*i+:4];
    for (int i = 0; i < W4; i++) fold4_q[i] <= ^level3[4*i+:4];
    folded_o <= ^fold4_q;
  end
endmodule
