// SPDX-License-Identifier: Apache-2.0
// What the length of D leaves of a light's brightness, f = 1 / (R^a + K) of light in docs/numeric-spec.md [B9]. Clocks enabled
// clocks later, one per clock.
//
//   D, Unit(D) --> d = D.Unit(D) --> R = d w --> T = R^a + K --> 1 / T --> f
module light_fall #(
    parameter int PartW = 8,
    parameter int Clocks = 1
) (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic en_i,
    // On the grid of light.position; part 0 in the low bits.
    input  logic [3*PartW-1:0] away_i,
    input  logic [3*bitspan_light_pkg::LightDirectionW-1:0] unit_i,
    // Of the view: the reciprocal of the reach, which is divided by 2^reach_e_i, and the offset.
    input  logic [bitspan_light_pkg::LightScaleW-1:0] reach_i,
    input  logic signed [bitspan_light_pkg::ScaleExponentW-1:0] reach_e_i,
    input  logic [bitspan_light_pkg::LightDistanceW-1:0] offset_i,
    output logic [bitspan_light_pkg::LightFallW-1:0] fall_o
);
  localparam int PositionW = bitspan_light_pkg::LightPositionW;
  localparam int PositionFrac = bitspan_light_pkg::LightPositionFrac;
  localparam int DirectionW = bitspan_light_pkg::LightDirectionW;
  localparam int DistanceW = bitspan_light_pkg::LightDistanceW;
  localparam int DistanceFrac = bitspan_light_pkg::LightDistanceFrac;
  localparam int DistanceSigned = bitspan_light_pkg::LightDistanceSigned;
  localparam bit BySquare = bitspan_light_pkg::LightFallsBySquare != 0;
  localparam int ProductClocks = bitspan_light_pkg::LightProductClocks;
  localparam int RootClocks = bitspan_light_pkg::LightRootClocks;
  localparam int RoundedClocks = ProductClocks + 4;
  localparam int LastClocks = 1 + RootClocks + RoundedClocks + 1 + 4;

  localparam int AlongW = PartW + DirectionW;
  logic [AlongW-1:0] along[3];
  logic signed [AlongW+1:0] length_q;
  for (genvar axis = 0; axis < 3; axis++) begin : gen_along
    mul_pipe #(
        .AW(PartW),
        .BW(DirectionW),
        .BSigned(bitspan_light_pkg::LightDirectionSigned),
        .Clocks(ProductClocks)
    ) u_along (
        .clk_i,
        .en_i,
        .a_i(away_i[axis*PartW+:PartW]),
        .b_i(unit_i[axis*DirectionW+:DirectionW]),
        .p_o(along[axis])
    );
  end
  logic [PositionW-1:0] length, far_q;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      length_q <= (AlongW + 2)'($signed(along[0])) + (AlongW + 2)'($signed(along[1])) + (AlongW + 2)'($signed(along[2]));
      far_q <= length;
    end
  end
  quantize #(
      .InW(AlongW + 2),
      .InFrac(PositionFrac + bitspan_light_pkg::LightDirectionFrac),
      .OutW(PositionW),
      .OutFrac(PositionFrac),
      .OutSigned(bitspan_light_pkg::LightPositionSigned),
      .Rounding(bitspan_light_pkg::LightPositionRnd),
      .Overflow(bitspan_light_pkg::LightPositionOvf)
  ) u_length (
      .x_i(length_q),
      .sticky_i(1'b0),
      .q_o(length)
  );
  logic [DistanceW-1:0] reached, divisor;
  logic signed [DistanceW:0] offset;
  assign offset = $signed({(DistanceSigned != 0) & offset_i[DistanceW-1], offset_i});
  multiply_round #(
      .AW(PositionW),
      .AFrac(PositionFrac),
      .ASigned(bitspan_light_pkg::LightPositionSigned),
      .BW(bitspan_light_pkg::LightScaleW),
      .BFrac(bitspan_light_pkg::LightScaleFrac),
      .BSigned(bitspan_light_pkg::LightScaleSigned),
      .EW(bitspan_light_pkg::ScaleExponentW),
      .EMin(bitspan_light_pkg::ReachExponentMin),
      .EMax(bitspan_light_pkg::ReachExponentMax),
      .OutW(DistanceW),
      .OutFrac(DistanceFrac),
      .OutSigned(DistanceSigned),
      .OutRnd(bitspan_light_pkg::LightDistanceRnd),
      .OutOvf(bitspan_light_pkg::LightDistanceOvf),
      .ProductClocks(ProductClocks)
  ) u_reached (
      .clk_i,
      .en_i,
      .a_i(far_q),
      .b_i(reach_i),
      .c_i(1'sd0),
      .e_i(reach_e_i),
      .q_o(reached)
  );
  if (BySquare) begin : gen_square
    multiply_round #(
        .AW(DistanceW),
        .AFrac(DistanceFrac),
        .ASigned(DistanceSigned),
        .BW(DistanceW),
        .BFrac(DistanceFrac),
        .BSigned(DistanceSigned),
        .CW(DistanceW + 1),
        .CFrac(DistanceFrac),
        .OutW(DistanceW),
        .OutFrac(DistanceFrac),
        .OutSigned(DistanceSigned),
        .OutRnd(bitspan_light_pkg::LightDistanceRnd),
        .OutOvf(bitspan_light_pkg::LightDistanceOvf),
        .ProductClocks(ProductClocks)
    ) u_divisor (
        .clk_i,
        .en_i,
        .a_i(reached),
        .b_i(reached),
        .c_i(offset),
        .e_i(1'sd0),
        .q_o(divisor)
    );
  end else begin : gen_first
    logic signed [DistanceW:0] first;
    logic [DistanceW-1:0] moved;
    assign first = $signed({(DistanceSigned != 0) & reached[DistanceW-1], reached});
    quantize #(
        .InW(DistanceW + 2),
        .InFrac(DistanceFrac),
        .OutW(DistanceW),
        .OutFrac(DistanceFrac),
        .OutSigned(DistanceSigned),
        .Rounding(bitspan_light_pkg::LightDistanceRnd),
        .Overflow(bitspan_light_pkg::LightDistanceOvf)
    ) u_moved (
        .x_i((DistanceW + 2)'(first) + (DistanceW + 2)'(offset)),
        .sticky_i(1'b0),
        .q_o(moved)
    );
    always_ff @(posedge clk_i) begin
      if (en_i) divisor <= moved;
    end
  end
  light_divide #(
      .TW(DistanceW),
      .TFrac(DistanceFrac),
      .TSigned(DistanceSigned),
      .AW(1),
      .ASigned(0),
      .AClocks(1),
      .OutW(bitspan_light_pkg::LightFallW),
      .OutFrac(bitspan_light_pkg::LightFallFrac),
      .OutSigned(bitspan_light_pkg::LightFallSigned),
      .OutRnd(bitspan_light_pkg::LightFallRnd),
      .OutOvf(bitspan_light_pkg::LightFallOvf),
      .RootClocks(RootClocks),
      .ProductClocks(ProductClocks),
      .Clocks(LastClocks)
  ) u_quotient (
      .clk_i,
      .rst_ni,
      .en_i,
      .t_i(divisor),
      .a_i(1'b1),
      .q_o(fall_o)
  );

`ifndef SYNTHESIS
  localparam int Has = ProductClocks + 2 + RoundedClocks + (BySquare ? RoundedClocks : 1) + LastClocks;
  initial begin
    assert (Clocks == Has)
    else $fatal(1, "light_fall: has %0d clocks, told %0d", Has, Clocks);
  end
`endif
endmodule
