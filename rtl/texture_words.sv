// SPDX-License-Identifier: Apache-2.0
// The words of a level's four texels as colours and alphas, without the reserved colour; three enabled clocks.
//
//   clocks  | one texel or none for four | which are reserved, Q of alpha | the nearest in their place |
//
// Texels 0, 1, 2, 3 are V1, V4, V2, V3: in words_i and colors_o that is from the lowest place on. A single texel stands for all
// four, and no texture for white.
module texture_words (
    input  logic clk_i,
    input  logic en_i,
    input  logic [127:0] words_i,
    input  logic textured_i,
    input  logic quad_i,
    // Of the texels along u (bit 0) and v, the second one is nearest.
    input  logic [1:0] upper_i,
    // The reserved colour, if there is one.
    input  logic has_reserved_i,
    input  logic [23:0] reserved_i,
    output logic [95:0] colors_o,
    output logic [4*bitspan_pixel_pkg::TextureAlphaW-1:0] alphas_o,
    // The nearest texel has the reserved colour.
    output logic hole_o
);
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int AlphaFrac = bitspan_pixel_pkg::TextureAlphaFrac;

  // Clock 1: the words.
  logic [31:0] word_1[4];
  logic [1:0] upper_1;
  logic has_reserved_1;
  logic [23:0] reserved_1;
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      for (int p = 0; p < 4; p++) word_1[p] <= quad_i ? words_i[32*p+:32] : textured_i ? words_i[31:0] : '1;
      upper_1 <= upper_i;
      has_reserved_1 <= has_reserved_i;
      reserved_1 <= reserved_i;
    end
  end

  // Clock 2: which texels are reserved, and Q of alpha; place 4 is the texel nearest to the fragment.
  //
  // a / 255 in binary is a, repeated for ever behind the point; for 255 it is 1.
  localparam int Copies = AlphaFrac / 8 + 1;
  logic [31:0] word[5];
  logic [3:0] reserved_2;
  logic [23:0] color_2[5];
  logic [AlphaW-1:0] alpha_2[5];
  for (genvar p = 0; p < 5; p++) begin : gen_word
    if (p < 4) begin : gen_texel
      assign word[p] = word_1[p];
    end else begin : gen_nearest
      assign word[p] = word_1[upper_1];
    end
    logic [7:0] code;
    logic opaque;
    logic signed [8*Copies+1:0] exact;
    logic [AlphaW-1:0] alpha;
    assign code = word[p][31:24];
    assign opaque = &code;
    assign exact = opaque ? {2'b01, {8 * Copies{1'b0}}} : {2'b00, {Copies{code}}};
    quantize #(
        .InW(8 * Copies + 2),
        .InFrac(8 * Copies),
        .OutW(AlphaW),
        .OutFrac(AlphaFrac),
        .OutSigned(bitspan_pixel_pkg::TextureAlphaSigned),
        .Rounding(bitspan_pixel_pkg::TextureAlphaRnd),
        .Overflow(bitspan_pixel_pkg::TextureAlphaOvf)
    ) u_alpha (
        .x_i(exact),
        .sticky_i(!opaque && code != '0),
        .q_o(alpha)
    );
    always_ff @(posedge clk_i) begin
      if (en_i) begin
        color_2[p] <= word[p][23:0];
        alpha_2[p] <= alpha;
      end
    end
    if (p < 4) begin : gen_reserved
      always_ff @(posedge clk_i) begin
        if (en_i) reserved_2[p] <= has_reserved_1 && word[p][23:0] == reserved_1;
      end
    end
  end
  logic [1:0] upper_2;
  always_ff @(posedge clk_i) begin
    if (en_i) upper_2 <= upper_1;
  end

  // Clock 3: the nearest texel in place of reserved ones.
  always_ff @(posedge clk_i) begin
    if (en_i) begin
      for (int p = 0; p < 4; p++) begin
        colors_o[24*p+:24] <= reserved_2[p] ? color_2[4] : color_2[p];
        alphas_o[AlphaW*p+:AlphaW] <= reserved_2[p] ? alpha_2[4] : alpha_2[p];
      end
      hole_o <= reserved_2[upper_2];
    end
  end
endmodule
