// SPDX-License-Identifier: Apache-2.0
// R_pixel(h + B) for the pixel stages: m and e, 1 + PixelUnitClocks enabled clocks after h and B. It takes an h on each.
//
//   h + B | R_pixel: PixelUnitClocks
module pixel_reciprocal (
    input  logic                                                clk_i,
    input  logic                                                rst_ni,
    input  logic                                                en_i,
    input  logic        [        bitspan_pixel_pkg::SpanHW-1:0] h_i,
    input  logic        [       bitspan_pixel_pkg::SetupBW-1:0] b_i,
    output logic        [bitspan_pixel_pkg::PixelRecipOutW-1:0] m_o,
    output logic signed [     bitspan_pixel_pkg::ExponentW-1:0] e_o
);
  localparam int SumW = bitspan_pixel_pkg::DepthSumW;
  logic [SumW-2:0] operand, operand_q;
  depth_operand #(
      .HW(bitspan_pixel_pkg::SpanHW),
      .HFrac(bitspan_pixel_pkg::SpanHFrac),
      .HSigned(bitspan_pixel_pkg::SpanHSigned),
      .BW(bitspan_pixel_pkg::SetupBW),
      .BFrac(bitspan_pixel_pkg::SetupBFrac),
      .BSigned(bitspan_pixel_pkg::SetupBSigned),
      .SumW(SumW),
      .SumFrac(bitspan_pixel_pkg::DepthSumFrac)
  ) u_operand (
      .h_i,
      .b_i,
      .operand_o(operand)
  );
  always_ff @(posedge clk_i) begin
    if (en_i) operand_q <= operand;
  end
  logic unused_a, unused_b;
  reciprocal #(
      .Kind(bitspan_pixel_pkg::PixelRecipKind),
      .Normalize(bitspan_pixel_pkg::PixelRecipNormalize),
      .OpW(bitspan_pixel_pkg::PixelRecipOpW),
      .OpFrac(bitspan_pixel_pkg::PixelRecipOpFrac),
      .OperandBits(bitspan_pixel_pkg::PixelRecipOperandBits),
      .IndexBits(bitspan_pixel_pkg::PixelRecipIndexBits),
      .TableBits(bitspan_pixel_pkg::PixelRecipTableBits),
      .InternalBits(bitspan_pixel_pkg::PixelRecipInternalBits),
      .Steps(bitspan_pixel_pkg::PixelRecipSteps),
      .BitsPerCycle(bitspan_pixel_pkg::PixelRecipBitsPerCycle),
      .Pipelined(bitspan_pixel_pkg::PixelRecipPipelined),
      .Iterations(bitspan_pixel_pkg::PixelRecipIterations),
      .QuotientFrac(bitspan_pixel_pkg::PixelRecipQuotientFrac),
      .OutW(bitspan_pixel_pkg::PixelRecipOutW),
      .OutFrac(bitspan_pixel_pkg::PixelRecipOutFrac),
      .OutSigned(bitspan_pixel_pkg::PixelRecipOutSigned),
      .OutRnd(bitspan_pixel_pkg::PixelRecipOutRnd),
      .OutOvf(bitspan_pixel_pkg::PixelRecipOutOvf),
      .EW(bitspan_pixel_pkg::ExponentW),
      .TableEntries(bitspan_pixel_pkg::PixelRecipTableEntries),
      .NormaliseClocks(bitspan_pixel_pkg::NormaliseClocks),
      .ProductClocks(bitspan_pixel_pkg::ProductClocks),
      .Clocks(bitspan_pixel_pkg::PixelUnitClocks),
      .Table(bitspan_pixel_pkg::PixelRecipTable)
  ) u_reciprocal (
      .clk_i,
      .rst_ni,
      .en_i,
      .start_i(1'b1),  // for iterative units
      .d_i(operand_q),
      .a_o(unused_a),
      .b_o(unused_b),
      .product_i(2'b0),
      .m_o,
      .e_o
  );
endmodule
