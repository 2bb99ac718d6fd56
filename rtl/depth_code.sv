// SPDX-License-Identifier: Apache-2.0
// A fragment's depth code z, DepthCodeClocks clocks after its h. It takes an h on each clock.
//
//   inverse  | Q(h)                                                                              |
//   opengl   | zmax - h | Q                                                                      |
//   linear   | pixel_reciprocal | multiply_round: c1 m 2^-e - c0                                |
module depth_code (
    input  logic                                   clk_i,
    input  logic                                   rst_ni,
    input  logic [ bitspan_pixel_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_pixel_pkg::DepthC1W-1:0] c1_i,
    input  logic [bitspan_pixel_pkg::DepthC0W-1:0] c0_i,
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
  localparam int Clocks = (Code == bitspan_pixel_pkg::DepthInverse) ? 1 :
                          (Code == bitspan_pixel_pkg::DepthOpengl) ? 2 :
                          1 + bitspan_pixel_pkg::PixelUnitClocks + bitspan_pixel_pkg::DepthProductClocks + 4;

  if (Code == bitspan_pixel_pkg::DepthLinear) begin : gen_linear
    logic [MW-1:0] m;
    logic signed [EW-1:0] e;
    pixel_reciprocal u_reciprocal (
        .clk_i,
        .rst_ni,
        .en_i(1'b1),
        .h_i,
        .b_i,
        .m_o (m),
        .e_o (e)
    );
    localparam int C0W = bitspan_pixel_pkg::DepthC0W;
    logic signed [C0W+1:0] c0, minus_c0;
    assign c0 = (C0W + 2)'($signed({(bitspan_pixel_pkg::DepthC0Signed != 0) & c0_i[C0W-1], c0_i}));
    assign minus_c0 = -c0;
    multiply_round #(
        .AW(bitspan_pixel_pkg::DepthC1W),
        .AFrac(bitspan_pixel_pkg::DepthC1Frac),
        .ASigned(bitspan_pixel_pkg::DepthC1Signed),
        .BW(MW),
        .BFrac(bitspan_pixel_pkg::PixelRecipOutFrac),
        .BSigned(bitspan_pixel_pkg::PixelRecipOutSigned),
        .CW(C0W + 2),
        .CFrac(bitspan_pixel_pkg::DepthC0Frac),
        .EW(EW),
        .EMin(bitspan_pixel_pkg::PixelRecipEMin),
        .EMax(bitspan_pixel_pkg::PixelRecipEMax),
        .OutW(ZW),
        .OutFrac(bitspan_pixel_pkg::DepthZFrac),
        .OutSigned(bitspan_pixel_pkg::DepthZSigned),
        .OutRnd(bitspan_pixel_pkg::DepthZRnd),
        .OutOvf(bitspan_pixel_pkg::DepthZOvf),
        .ProductClocks(bitspan_pixel_pkg::DepthProductClocks)
    ) u_z (
        .clk_i,
        .en_i(1'b1),
        .a_i (c1_i),
        .b_i (m),
        .c_i (minus_c0),
        .e_i (e),
        .q_o (z_o)
    );
    delay_line #(
        .Width(MW + EW),
        .Depth(bitspan_pixel_pkg::DepthProductClocks + 4)
    ) u_recip (
        .clk_i,
        .en_i(1'b1),
        .d_i ({m, e}),
        .q_o (recip_o)
    );
  end else begin : gen_of_h
    // What stands in front of Q: h, or zmax - h.
    localparam bit Flips = Code == bitspan_pixel_pkg::DepthOpengl;
    localparam int HGrid = (HFrac > 0) ? HFrac : 0;
    localparam int DifferenceW = ((ZW + HGrid > HW + HGrid - HFrac) ? ZW + HGrid : HW + HGrid - HFrac) + 3;
    localparam int ExactW = Flips ? DifferenceW : HW + 1;
    logic signed [HW:0] h;
    logic signed [ExactW-1:0] exact;
    logic [ZW-1:0] z;
    assign h = $signed({(bitspan_pixel_pkg::SpanHSigned != 0) & h_i[HW-1], h_i});
    if (Flips) begin : gen_opengl
      localparam logic signed [DifferenceW-1:0] Zmax = ((DifferenceW'(1) <<< ZW) - DifferenceW'(1)) <<< HGrid;
      always_ff @(posedge clk_i) exact <= Zmax - (DifferenceW'(h) <<< (HGrid - HFrac));
    end else begin : gen_inverse
      assign exact = h;
    end
    quantize #(
        .InW(ExactW),
        .InFrac(Flips ? HGrid : HFrac),
        .OutW(ZW),
        .OutFrac(bitspan_pixel_pkg::DepthZFrac),
        .OutSigned(bitspan_pixel_pkg::DepthZSigned),
        .Rounding(bitspan_pixel_pkg::DepthZRnd),
        .Overflow(bitspan_pixel_pkg::DepthZOvf)
    ) u_z (
        .x_i(exact),
        .sticky_i(1'b0),
        .q_o(z)
    );
    always_ff @(posedge clk_i) z_o <= z;
    assign recip_o = '0;
    logic unused;
    assign unused = rst_ni ^ (^{b_i, c1_i, c0_i});
  end

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::DepthCodeClocks)
    else $fatal(1, "depth_code: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::DepthCodeClocks);
  end
`endif
endmodule
