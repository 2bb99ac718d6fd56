// SPDX-License-Identifier: Apache-2.0
// project of docs/numeric-spec.md: a fragment's place in the picture of a projector and its depth code there; one per
// clock.
//
//   W --> R_project --+--> X m 2^-e, Y m 2^-e --> s, t --> inside -----------+
//                     +--> (h + B) m 2^-e --> ratio --> A_p ratio - B_p --> h_p --> z --> skid --> out
//
// The stage shifts as one on the ready of the skid at its end, which is a register. Behind the projector, and in a view
// without one, every output is 0.
module project #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // B of the view, A_p and B_p of its projector, and whether it has one; stable while fragments are in flight.
    input  logic [bitspan_project_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_project_pkg::DistanceAW-1:0] a_i,
    input  logic [bitspan_project_pkg::SetupBW-1:0] far_b_i,
    input  logic projector_i,
    // The fragment, with the sides of its texture; what else it brings comes out beside it.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_project_pkg::SpanHW-1:0] in_h_i,
    input  logic [bitspan_project_pkg::ProjectValueW-1:0] in_x_i,
    input  logic [bitspan_project_pkg::ProjectValueW-1:0] in_y_i,
    input  logic [bitspan_project_pkg::ProjectValueW-1:0] in_w_i,
    input  logic [bitspan_project_pkg::TextureSideW-1:0] in_width_i,
    input  logic [bitspan_project_pkg::TextureSideW-1:0] in_height_i,
    input  logic [RestW-1:0] in_rest_i,
    // The record of docs/numeric-spec.md.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_project_pkg::ProjectRecipOutW-1:0] out_recip_m_o,
    output logic [bitspan_project_pkg::ExponentW-1:0] out_recip_e_o,
    output logic [bitspan_project_pkg::SpanUvW-1:0] out_s_o,
    output logic [bitspan_project_pkg::SpanUvW-1:0] out_t_o,
    output logic [bitspan_project_pkg::ProjectRatioW-1:0] out_ratio_o,
    output logic [bitspan_project_pkg::ProjectHW-1:0] out_h_o,
    output logic [bitspan_project_pkg::DepthZW-1:0] out_z_o,
    output logic out_inside_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int ValueW = bitspan_project_pkg::ProjectValueW;
  localparam int ValueSigned = bitspan_project_pkg::ProjectValueSigned;
  localparam int UvW = bitspan_project_pkg::SpanUvW;
  localparam int RatioW = bitspan_project_pkg::ProjectRatioW;
  localparam int HW = bitspan_project_pkg::ProjectHW;
  localparam int HFrac = bitspan_project_pkg::ProjectHFrac;
  localparam int ZW = bitspan_project_pkg::DepthZW;
  localparam int MW = bitspan_project_pkg::ProjectRecipOutW;
  localparam int EW = bitspan_project_pkg::ExponentW;

  // Clocks after acceptance at which a value is in its register.
  localparam int RecipAt = 1 + bitspan_project_pkg::ProjectUnitClocks;
  localparam int PlaceAt = RecipAt + bitspan_project_pkg::ProjectPlaceProductClocks + 4;
  localparam int RatioAt = RecipAt + bitspan_project_pkg::ProjectRatioProductClocks + 4;
  localparam int HAt = RatioAt + bitspan_project_pkg::ProjectCodeProductClocks + 4;
  localparam int ZAt = HAt + ((bitspan_project_pkg::DepthIsComplement != 0) ? 2 : 1);
  localparam int Clocks = (PlaceAt + 1 > ZAt) ? PlaceAt + 1 : ZAt;

  logic en;
  assign en = in_ready_o;

  // ---------------------------------------------------------------- R_project(W), where W is positive

  localparam int OpW = bitspan_project_pkg::ProjectRecipOpW;
  logic in_front, out_front;
  logic [OpW-1:0] operand_q;
  logic [MW-1:0] m;
  logic signed [EW-1:0] e;
  assign in_front = projector_i && !((ValueSigned != 0) && in_w_i[ValueW-1]) && in_w_i != '0;
  always_ff @(posedge clk_i) begin
    if (en) operand_q <= in_w_i[OpW-1:0];
  end
  ring_line #(
      .Width(1),
      .Depth(Clocks)
  ) u_front_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(in_front),
      .q_o(out_front)
  );
  logic unused_a, unused_b;
  reciprocal #(
      .Kind(bitspan_project_pkg::ProjectRecipKind),
      .Normalize(bitspan_project_pkg::ProjectRecipNormalize),
      .OpW(OpW),
      .OpFrac(bitspan_project_pkg::ProjectRecipOpFrac),
      .OperandBits(bitspan_project_pkg::ProjectRecipOperandBits),
      .IndexBits(bitspan_project_pkg::ProjectRecipIndexBits),
      .TableBits(bitspan_project_pkg::ProjectRecipTableBits),
      .InternalBits(bitspan_project_pkg::ProjectRecipInternalBits),
      .Steps(bitspan_project_pkg::ProjectRecipSteps),
      .BitsPerCycle(bitspan_project_pkg::ProjectRecipBitsPerCycle),
      .Pipelined(bitspan_project_pkg::ProjectRecipPipelined),
      .Iterations(bitspan_project_pkg::ProjectRecipIterations),
      .QuotientFrac(bitspan_project_pkg::ProjectRecipQuotientFrac),
      .OutW(MW),
      .OutFrac(bitspan_project_pkg::ProjectRecipOutFrac),
      .OutSigned(bitspan_project_pkg::ProjectRecipOutSigned),
      .OutRnd(bitspan_project_pkg::ProjectRecipOutRnd),
      .OutOvf(bitspan_project_pkg::ProjectRecipOutOvf),
      .EW(EW),
      .TableEntries(bitspan_project_pkg::ProjectRecipTableEntries),
      .NormaliseClocks(bitspan_project_pkg::NormaliseClocks),
      .ProductClocks(bitspan_project_pkg::ProductClocks),
      .Clocks(bitspan_project_pkg::ProjectUnitClocks),
      .Table(bitspan_project_pkg::ProjectRecipTable)
  ) u_reciprocal (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .start_i(1'b1),
      .d_i(operand_q),
      .a_o(unused_a),
      .b_o(unused_b),
      .product_i(2'b0),
      .m_o(m),
      .e_o(e)
  );
  logic [MW+EW-1:0] recip_out;
  ring_line #(
      .Width(MW + EW),
      .Depth(Clocks - RecipAt)
  ) u_recip_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({m, e}),
      .q_o(recip_out)
  );

  // ---------------------------------------------------------------- s, t, and whether they lie in the texture

  logic [UvW-1:0] s, t;
  logic [2*UvW-1:0] place_out;
  logic contains_s, contains_t, contains_q, inside_out;
  project_place u_s (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .value_i(in_x_i),
      .side_i(in_width_i),
      .m_i(m),
      .e_i(e),
      .at_o(s),
      .contains_o(contains_s)
  );
  project_place u_t (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .value_i(in_y_i),
      .side_i(in_height_i),
      .m_i(m),
      .e_i(e),
      .at_o(t),
      .contains_o(contains_t)
  );
  always_ff @(posedge clk_i) begin
    if (en) contains_q <= contains_s && contains_t;
  end
  ring_line #(
      .Width(2 * UvW),
      .Depth(Clocks - PlaceAt)
  ) u_place_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i({s, t}),
      .q_o(place_out)
  );
  ring_line #(
      .Width(1),
      .Depth(Clocks - PlaceAt - 1)
  ) u_inside_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(contains_q),
      .q_o(inside_out)
  );

  // ---------------------------------------------------------------- ratio, h_p and its code

  localparam int BW = bitspan_project_pkg::SetupBW;
  localparam int BSigned = bitspan_project_pkg::SetupBSigned;
  localparam int SpanHW = bitspan_project_pkg::SpanHW;
  localparam int SumW = bitspan_project_pkg::DepthSumW;
  localparam int SumFrac = bitspan_project_pkg::DepthSumFrac;
  logic signed [SpanHW:0] span_h;
  logic signed [BW:0] b;
  logic signed [BW+1:0] far_b, minus_far_b;
  logic signed [SumW-1:0] sum_q;
  logic [SumW-1:0] sum;
  assign span_h = $signed({(bitspan_project_pkg::SpanHSigned != 0) & in_h_i[SpanHW-1], in_h_i});
  assign b = $signed({(BSigned != 0) & b_i[BW-1], b_i});
  assign far_b = (BW + 2)'($signed({(BSigned != 0) & far_b_i[BW-1], far_b_i}));
  assign minus_far_b = -far_b;
  always_ff @(posedge clk_i) begin
    if (en) begin
      sum_q <= (SumW'(span_h) <<< (SumFrac - bitspan_project_pkg::SpanHFrac)) +
               (SumW'(b) <<< (SumFrac - bitspan_project_pkg::SetupBFrac));
    end
  end
  ring_line #(
      .Width(SumW),
      .Depth(RecipAt - 1)
  ) u_sum_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(sum_q),
      .q_o(sum)
  );
  logic [RatioW-1:0] ratio, ratio_out;
  multiply_round #(
      .AW(SumW),
      .AFrac(SumFrac),
      .BW(MW),
      .BFrac(bitspan_project_pkg::ProjectRecipOutFrac),
      .BSigned(bitspan_project_pkg::ProjectRecipOutSigned),
      .EW(EW),
      .EMin(bitspan_project_pkg::ProjectRecipEMin),
      .EMax(bitspan_project_pkg::ProjectRecipEMax),
      .OutW(RatioW),
      .OutFrac(bitspan_project_pkg::ProjectRatioFrac),
      .OutSigned(bitspan_project_pkg::ProjectRatioSigned),
      .OutRnd(bitspan_project_pkg::ProjectRatioRnd),
      .OutOvf(bitspan_project_pkg::ProjectRatioOvf),
      .ProductClocks(bitspan_project_pkg::ProjectRatioProductClocks)
  ) u_ratio (
      .clk_i,
      .en_i(en),
      .a_i(sum),
      .b_i(m),
      .c_i(1'sd0),
      .e_i(e),
      .q_o(ratio)
  );
  ring_line #(
      .Width(RatioW),
      .Depth(Clocks - RatioAt)
  ) u_ratio_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(ratio),
      .q_o(ratio_out)
  );
  logic [HW-1:0] far_h, h_out;
  multiply_round #(
      .AW(bitspan_project_pkg::DistanceAW),
      .AFrac(bitspan_project_pkg::DistanceAFrac),
      .ASigned(bitspan_project_pkg::DistanceASigned),
      .BW(RatioW),
      .BFrac(bitspan_project_pkg::ProjectRatioFrac),
      .BSigned(bitspan_project_pkg::ProjectRatioSigned),
      .CW(BW + 2),
      .CFrac(bitspan_project_pkg::SetupBFrac),
      .OutW(HW),
      .OutFrac(HFrac),
      .OutSigned(bitspan_project_pkg::ProjectHSigned),
      .OutRnd(bitspan_project_pkg::ProjectHRnd),
      .OutOvf(bitspan_project_pkg::ProjectHOvf),
      .ProductClocks(bitspan_project_pkg::ProjectCodeProductClocks)
  ) u_far_h (
      .clk_i,
      .en_i(en),
      .a_i(a_i),
      .b_i(ratio),
      .c_i(minus_far_b),
      .e_i(1'sd0),
      .q_o(far_h)
  );
  ring_line #(
      .Width(HW),
      .Depth(Clocks - HAt)
  ) u_h_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(far_h),
      .q_o(h_out)
  );
  // What stands in front of Q: h_p, or zmax - h_p.
  localparam bit Flips = bitspan_project_pkg::DepthIsComplement != 0;
  localparam int HGrid = (HFrac > 0) ? HFrac : 0;
  localparam int DifferenceW = ((ZW + HGrid > HW + HGrid - HFrac) ? ZW + HGrid : HW + HGrid - HFrac) + 3;
  localparam int ExactW = Flips ? DifferenceW : HW + 1;
  logic signed [HW:0] h_signed;
  logic signed [ExactW-1:0] exact;
  logic [ZW-1:0] z, z_q, z_out;
  assign h_signed = $signed({(bitspan_project_pkg::ProjectHSigned != 0) & far_h[HW-1], far_h});
  if (Flips) begin : gen_complement
    localparam logic signed [DifferenceW-1:0] Zmax = ((DifferenceW'(1) <<< ZW) - DifferenceW'(1)) <<< HGrid;
    always_ff @(posedge clk_i) begin
      if (en) exact <= Zmax - (DifferenceW'(h_signed) <<< (HGrid - HFrac));
    end
  end else begin : gen_h
    assign exact = h_signed;
  end
  quantize #(
      .InW(ExactW),
      .InFrac(Flips ? HGrid : HFrac),
      .OutW(ZW),
      .OutFrac(bitspan_project_pkg::DepthZFrac),
      .OutSigned(bitspan_project_pkg::DepthZSigned),
      .Rounding(bitspan_project_pkg::DepthZRnd),
      .Overflow(bitspan_project_pkg::DepthZOvf)
  ) u_z (
      .x_i(exact),
      .sticky_i(1'b0),
      .q_o(z)
  );
  always_ff @(posedge clk_i) begin
    if (en) z_q <= z;
  end
  ring_line #(
      .Width(ZW),
      .Depth(Clocks - ZAt)
  ) u_z_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(z_q),
      .q_o(z_out)
  );

  localparam int MadeW = MW + EW + 2 * UvW + RatioW + HW + ZW + 1;
  logic [MadeW-1:0] made;
  assign made = {recip_out, place_out, ratio_out, h_out, z_out, inside_out} & {MadeW{out_front}};
  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(MadeW)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i(made),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_recip_m_o, out_recip_e_o, out_s_o, out_t_o, out_ratio_o, out_h_o, out_z_o, out_inside_o}),
      .out_rest_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_project_pkg::ProjectClocks)
    else $fatal(1, "project: has %0d clocks, told %0d", Clocks, bitspan_project_pkg::ProjectClocks);
  end
`endif
endmodule
