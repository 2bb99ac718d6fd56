// SPDX-License-Identifier: Apache-2.0
// A fragment's depth code z, DepthCodeClocks clocks after its h. It takes an h on each clock.
//
//   inverse  | Q(h)                                                                              |
//   opengl   | zmax - h | Q                                                                      |
//   linear   | h + B | R_pixel | c1 m (DepthProductClocks) | shift by e, twice | minus c0 | Q     |
module depth_code (
    input  logic                                   clk_i,
    input  logic                                   rst_ni,
    input  logic [ bitspan_pixel_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_pixel_pkg::DepthC1W-1:0] c1_i,
    input  logic [bitspan_pixel_pkg::DepthC0W-1:0] c0_i,
    input  logic                                   valid_i,
    input  logic [  bitspan_pixel_pkg::SpanHW-1:0] h_i,
    output logic [ bitspan_pixel_pkg::DepthZW-1:0] z_o,
    // m and e of the linear code, else 0.
    output logic [bitspan_pixel_pkg::PixelRecipOutW+bitspan_pixel_pkg::ExponentW-1:0] recip_o
);
  localparam int HW = bitspan_pixel_pkg::SpanHW;
  localparam int HFrac = bitspan_pixel_pkg::SpanHFrac;
  localparam int ZW = bitspan_pixel_pkg::DepthZW;
  localparam int Code = bitspan_pixel_pkg::DepthCode;
  localparam int MW = bitspan_pixel_pkg::PixelRecipOutW;
  localparam int EW = bitspan_pixel_pkg::ExponentW;
  // What stands in front of Q.
  localparam int HGrid = (HFrac > 0) ? HFrac : 0;
  localparam int DifferenceW = ((ZW + HGrid > HW + HGrid - HFrac) ? ZW + HGrid : HW + HGrid - HFrac) + 3;
  localparam int C0Frac = bitspan_pixel_pkg::DepthC0Frac;
  localparam int SumFrac = (C0Frac > 1) ? C0Frac : 1;
  localparam int SubtrahendW = bitspan_pixel_pkg::DepthC0W + 2 + SumFrac - C0Frac;
  localparam int KeptW = (SubtrahendW + 4 > ZW + SumFrac + 6) ? SubtrahendW + 4 : ZW + SumFrac + 6;
  localparam int ExactW = (Code == bitspan_pixel_pkg::DepthInverse) ? HW + 1 :
                          (Code == bitspan_pixel_pkg::DepthOpengl) ? DifferenceW : KeptW;
  localparam int ExactFrac = (Code == bitspan_pixel_pkg::DepthInverse) ? HFrac :
                             (Code == bitspan_pixel_pkg::DepthOpengl) ? HGrid : SumFrac;
  localparam int Clocks = (Code == bitspan_pixel_pkg::DepthInverse) ? 1 :
                          (Code == bitspan_pixel_pkg::DepthOpengl) ? 2 :
                          1 + bitspan_pixel_pkg::PixelUnitClocks + bitspan_pixel_pkg::DepthProductClocks + 3 + 1;

  logic signed [HW:0] h;
  assign h = $signed({(bitspan_pixel_pkg::SpanHSigned != 0) & h_i[HW-1], h_i});
  logic signed [ExactW-1:0] exact;
  logic sticky;

  if (Code == bitspan_pixel_pkg::DepthInverse) begin : gen_inverse
    assign exact = h;
    assign sticky = 1'b0;
    assign recip_o = '0;
    logic unused;
    assign unused = rst_ni ^ valid_i ^ (^{b_i, c1_i, c0_i});
  end else if (Code == bitspan_pixel_pkg::DepthOpengl) begin : gen_opengl
    localparam logic signed [DifferenceW-1:0] Zmax = ((DifferenceW'(1) <<< ZW) - DifferenceW'(1)) <<< HGrid;
    logic signed [DifferenceW-1:0] difference_q;
    always_ff @(posedge clk_i) difference_q <= Zmax - (DifferenceW'(h) <<< (HGrid - HFrac));
    assign exact = difference_q;
    assign sticky = 1'b0;
    assign recip_o = '0;
    logic unused;
    assign unused = rst_ni ^ valid_i ^ (^{b_i, c1_i, c0_i});
  end else begin : gen_linear
    // h + B; not positive: 0, which the unit takes for one ulp.
    localparam int SumW = bitspan_pixel_pkg::DepthSumW;
    localparam int QFrac = bitspan_pixel_pkg::DepthSumFrac;
    localparam int BW = bitspan_pixel_pkg::SetupBW;
    logic signed [BW:0] b;
    logic signed [SumW-1:0] h_sum;
    logic [SumW-2:0] operand_q;
    logic summed_q;
    assign b = $signed({(bitspan_pixel_pkg::SetupBSigned != 0) & b_i[BW-1], b_i});
    assign h_sum = (SumW'(h) <<< (QFrac - HFrac)) + (SumW'(b) <<< (QFrac - bitspan_pixel_pkg::SetupBFrac));
    always_ff @(posedge clk_i) operand_q <= h_sum[SumW-1] ? '0 : h_sum[SumW-2:0];
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) summed_q <= 1'b0;
      else summed_q <= valid_i;
    end
    logic [MW-1:0] m;
    logic signed [EW-1:0] e, e_1;
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
        .EW(EW),
        .TableEntries(bitspan_pixel_pkg::PixelRecipTableEntries),
        .NormaliseClocks(bitspan_pixel_pkg::NormaliseClocks),
        .ProductClocks(bitspan_pixel_pkg::ProductClocks),
        .Clocks(bitspan_pixel_pkg::PixelUnitClocks),
        .Table(bitspan_pixel_pkg::PixelRecipTable)
    ) u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i   (1'b1),
        .start_i(summed_q),
        .d_i    (operand_q),
        .m_o    (m),
        .e_o    (e)
    );

    localparam int C1W = bitspan_pixel_pkg::DepthC1W;
    localparam int C1Signed = bitspan_pixel_pkg::DepthC1Signed;
    localparam int MSigned = bitspan_pixel_pkg::PixelRecipOutSigned;
    localparam int EMin = bitspan_pixel_pkg::PixelRecipEMin;
    localparam int ShiftMax = bitspan_pixel_pkg::PixelRecipEMax - EMin;
    localparam int ShiftW = (ShiftMax > 0) ? $clog2(ShiftMax + 1) : 1;
    logic [C1W+MW-1:0] product;
    mul_pipe #(
        .AW(C1W),
        .BW(MW),
        .ASigned(C1Signed),
        .BSigned(MSigned),
        .Clocks(bitspan_pixel_pkg::DepthProductClocks)
    ) u_product (
        .clk_i,
        .en_i(1'b1),
        .a_i (c1_i),
        .b_i (m),
        .p_o (product)
    );
    delay_line #(
        .Width(EW),
        .Depth(bitspan_pixel_pkg::DepthProductClocks)
    ) u_exponent (
        .clk_i,
        .en_i(1'b1),
        .d_i (e),
        .q_o (e_1)
    );
    logic signed [EW:0] shift;
    assign shift = (EW + 1)'(e_1) - (EW + 1)'(EMin);

    localparam int C0W = bitspan_pixel_pkg::DepthC0W;
    logic signed [SubtrahendW-1:0] c0, subtrahend_q;
    assign c0 = SubtrahendW'($signed({(bitspan_pixel_pkg::DepthC0Signed != 0) & c0_i[C0W-1], c0_i}));
    always_ff @(posedge clk_i) subtrahend_q <= -(c0 <<< (SumFrac - C0Frac));
    logic signed [KeptW-1:0] sum;
    logic far, sign;
    shift_add #(
        .InW(C1W + MW + 1),
        .Base(bitspan_pixel_pkg::DepthC1Frac + bitspan_pixel_pkg::PixelRecipOutFrac + EMin - SumFrac),
        .ShiftMax(ShiftMax),
        .CW(SubtrahendW),
        .KeptW(KeptW)
    ) u_sum (
        .clk_i,
        .en_i(1'b1),
        .x_i($signed({(C1Signed != 0 || MSigned != 0) & product[C1W+MW-1], product})),
        .shift_i(shift[ShiftW-1:0]),
        .c_i(subtrahend_q),
        .sum_o(sum),
        .sticky_o(sticky),
        .far_o(far),
        .sign_o(sign)
    );
    // What does not fit the sum is out of z's range, too. SC_WRAP takes its low bits and, in rounding, its sign.
    assign exact = !far ? sum :
                   (bitspan_pixel_pkg::DepthZOvf == bitspan_pixel_pkg::OvfWrap) ? {sign, sum[KeptW-2:0]} :
                   {sign, {(KeptW - 1) {!sign}}};
    delay_line #(
        .Width(MW + EW),
        .Depth(bitspan_pixel_pkg::DepthProductClocks + 4)
    ) u_recip (
        .clk_i,
        .en_i(1'b1),
        .d_i ({m, e}),
        .q_o (recip_o)
    );
    logic unused;
    assign unused = ^shift;
  end

  logic [ZW-1:0] z;
  quantize #(
      .InW(ExactW),
      .InFrac(ExactFrac),
      .OutW(ZW),
      .OutFrac(bitspan_pixel_pkg::DepthZFrac),
      .OutSigned(bitspan_pixel_pkg::DepthZSigned),
      .Rounding(bitspan_pixel_pkg::DepthZRnd),
      .Overflow(bitspan_pixel_pkg::DepthZOvf)
  ) u_z (
      .x_i(exact),
      .sticky_i(sticky),
      .q_o(z)
  );
  always_ff @(posedge clk_i) z_o <= z;

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::DepthCodeClocks)
    else $fatal(1, "depth_code: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::DepthCodeClocks);
  end
`endif
endmodule
