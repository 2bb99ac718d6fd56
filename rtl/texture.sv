// SPDX-License-Identifier: Apache-2.0
// texture of docs/numeric-spec.md: a fragment in, its texel times its colour out; one per clock.
//
//   in --> address ---> skid --> requests ------------------> four texel ports
//    |                              |                              |
//    |                              +--> FIFO `asked`, skid    4 skids
//    |                                       |                     |
//    +--> FIFO `held` (shades, rest) --------+--> join <-----------+
//                                                  |
//                                                  +--> filter and colour --> skid --> out
//
// `address` and `filter and colour` each shift as one on the ready of the skid behind them, which is a register. The
// FIFOs have InFlight entries; a fragment is accepted where `held` has room, so that `asked` never overflows.
//
// A texel is 32 bits: red in the lowest byte, then green, blue, alpha. texture_address says where it lies; the base is a
// multiple of 2^pitch, and 2^pitch at least the texture's width. Port 0 reads the nearest texel or V1, port 1 V4, port 2 V2,
// port 3 V3. Each port answers in the order of its requests.
//
// Where textures have levels, the fragment brings the one that lod chose. Where two are mixed, ports 4 to 7 read those of the
// next level as 0 to 3 those of the level, for fragments with f above 0; texture_levels is the filter, with a skid of its own,
// and the product with the fragment's colour a segment behind it. Elsewhere f and those ports' inputs are ignored, and they
// never ask.
//
// A killed fragment is delivered, too: killed_o says so. The stage is not made for cyclic textures of another width or
// height than a power of two; an assertion stops them.
module texture #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    // The fragment; what else it brings comes out beside it.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_u_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_v_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_r_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_g_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_b_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_a_i,
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] in_level_i,
    input  logic [bitspan_pixel_pkg::LodFracW-1:0] in_f_i,
    input  logic [RestW-1:0] in_rest_i,
    // The draw state, taken with the fragment: a texture or none, bilinear or nearest, clamp or cyclic along u (bit 0) and
    // v, the last column and row of texels, the pitch, the address of texel (0, 0), and the reserved colour, if there is one.
    input  logic in_textured_i,
    input  logic in_bilinear_i,
    input  logic [1:0] in_clamp_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] in_last_i_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] in_last_j_i,
    input  logic [bitspan_pixel_pkg::TexelPitchW-1:0] in_pitch_i,
    input  logic [bitspan_pixel_pkg::TexelAddressW-1:0] in_base_i,
    input  logic in_transparent_i,
    input  logic [23:0] in_reserved_i,
    // The alpha test of the fragment of alpha_rest_o, on the same clock. func: bit 0 passes where the fragment's alpha code
    // is less than the reference, bit 1 where it is equal, bit 2 where it is greater.
    input  logic [2:0] alpha_func_i,
    input  logic [7:0] alpha_ref_i,
    // Whether alpha 0 leaves it alive; on the same clock.
    input  logic alpha_keeps_zero_i,
    output logic [RestW-1:0] alpha_rest_o,
    output logic request0_valid_o,
    input  logic request0_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request0_address_o,
    input  logic answer0_valid_i,
    output logic answer0_ready_o,
    input  logic [31:0] answer0_texel_i,
    output logic request1_valid_o,
    input  logic request1_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request1_address_o,
    input  logic answer1_valid_i,
    output logic answer1_ready_o,
    input  logic [31:0] answer1_texel_i,
    output logic request2_valid_o,
    input  logic request2_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request2_address_o,
    input  logic answer2_valid_i,
    output logic answer2_ready_o,
    input  logic [31:0] answer2_texel_i,
    output logic request3_valid_o,
    input  logic request3_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request3_address_o,
    input  logic answer3_valid_i,
    output logic answer3_ready_o,
    input  logic [31:0] answer3_texel_i,
    output logic request4_valid_o,
    input  logic request4_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request4_address_o,
    input  logic answer4_valid_i,
    output logic answer4_ready_o,
    input  logic [31:0] answer4_texel_i,
    output logic request5_valid_o,
    input  logic request5_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request5_address_o,
    input  logic answer5_valid_i,
    output logic answer5_ready_o,
    input  logic [31:0] answer5_texel_i,
    output logic request6_valid_o,
    input  logic request6_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request6_address_o,
    input  logic answer6_valid_i,
    output logic answer6_ready_o,
    input  logic [31:0] answer6_texel_i,
    output logic request7_valid_o,
    input  logic request7_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] request7_address_o,
    input  logic answer7_valid_i,
    output logic answer7_ready_o,
    input  logic [31:0] answer7_texel_i,
    // The record of docs/numeric-spec.md.
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] out_i_o,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] out_j_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] out_ex_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] out_ey_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_texel_r_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_texel_g_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_texel_b_o,
    output logic [bitspan_pixel_pkg::TextureAlphaW-1:0] out_texel_a_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] out_r_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] out_g_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] out_b_o,
    output logic [bitspan_pixel_pkg::TextureAlphaW-1:0] out_a_o,
    output logic out_killed_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int ShadeW = bitspan_pixel_pkg::SpanShadeW;
  localparam int ShadeFrac = bitspan_pixel_pkg::SpanShadeFrac;
  localparam int ShadeSigned = bitspan_pixel_pkg::SpanShadeSigned;
  localparam int MixW = bitspan_pixel_pkg::TextureMixW;
  localparam int MixFrac = bitspan_pixel_pkg::TextureMixFrac;
  localparam int MixSigned = bitspan_pixel_pkg::TextureMixSigned;
  localparam int MixRnd = bitspan_pixel_pkg::TextureMixRnd;
  localparam int MixOvf = bitspan_pixel_pkg::TextureMixOvf;
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int AlphaFrac = bitspan_pixel_pkg::TextureAlphaFrac;
  localparam int AlphaSigned = bitspan_pixel_pkg::TextureAlphaSigned;
  localparam int AlphaRnd = bitspan_pixel_pkg::TextureAlphaRnd;
  localparam int AlphaOvf = bitspan_pixel_pkg::TextureAlphaOvf;
  localparam int ColorW = bitspan_pixel_pkg::TextureColorW;
  localparam int FracW = bitspan_pixel_pkg::TextureFracW;
  localparam int IndexW = bitspan_pixel_pkg::TexelIndexW;
  localparam int AddressW = bitspan_pixel_pkg::TexelAddressW;
  localparam int LevelW = bitspan_pixel_pkg::LodLevelW;
  localparam int InFlight = bitspan_pixel_pkg::FragmentsInFlight;
  // Two levels.
  localparam bit Mixes = bitspan_pixel_pkg::TextureHasLevels != 0 && bitspan_pixel_pkg::LodMixesLevels != 0;
  localparam int ShareW = Mixes ? bitspan_pixel_pkg::LodFracW : 0;
  localparam int Ports = 8;

  localparam int AddressClocks = bitspan_pixel_pkg::TextureAddressClocks;
  localparam int FilterClocks = bitspan_pixel_pkg::TextureFilterProductClocks;
  localparam int ShadeProductClocks = bitspan_pixel_pkg::TextureShadeProductClocks;
  localparam int BlendClocks = 3 + FilterClocks;
  // Words, reserved colours, replacement; the filter; factors, product, Q.
  localparam int FilterAt = 3;
  localparam int MixedAt = FilterAt + 2 * BlendClocks;
  localparam int ShadeClocks = 1 + ShadeProductClocks + 1;
  localparam int ColorClocks = Mixes ? FilterAt + bitspan_pixel_pkg::TextureLevelsClocks : MixedAt + ShadeClocks;
  // Beside the last of them: the reference; its wholes and byte; the least alpha.
  localparam int AlphaTestClocks = 3;

  // ---------------------------------------------------------------- address

  logic address_en, held_ready, in_taken;
  logic [AddressClocks-1:0] address_valid_q;
  assign in_ready_o = address_en && held_ready;
  assign in_taken = in_valid_i && in_ready_o;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) address_valid_q <= '0;
    else if (address_en) address_valid_q <= {address_valid_q[AddressClocks-2:0], in_taken};
  end

  // What the filter must know of a level whose texels are on their way, and the requests.
  localparam int AskedW = 2 + 2 * IndexW + 2 * FracW;
  localparam int RowsW = IndexW + 2 * AddressW;
  logic textured_6, quad_6;
  logic [1:0] upper_6;
  logic [AddressW-1:0] first_row_6, second_row_6;
  logic [IndexW-1:0] first_i_6, second_i_6, first_j_6;
  logic [FracW-1:0] ex_6, ey_6;
  texture_address u_address (
      .clk_i,
      .rst_ni,
      .en_i(address_en),
      .u_i(in_u_i),
      .v_i(in_v_i),
      .level_i(in_level_i),
      .textured_i(in_textured_i),
      .bilinear_i(in_bilinear_i),
      .clamp_i(in_clamp_i),
      .last_i_i(in_last_i_i),
      .last_j_i(in_last_j_i),
      .pitch_i(in_pitch_i),
      .base_i(in_base_i),
      .textured_o(textured_6),
      .quad_o(quad_6),
      .first_row_o(first_row_6),
      .second_row_o(second_row_6),
      .first_i_o(first_i_6),
      .second_i_o(second_i_6),
      .first_j_o(first_j_6),
      .upper_o(upper_6),
      .ex_o(ex_6),
      .ey_o(ey_6)
  );
  // The next level, where it is mixed in.
  logic next_6;
  logic [AskedW-1:0] next_asked_6;
  logic [RowsW-1:0] next_rows_6;
  logic unused_share;
  if (Mixes) begin : gen_next_address
    logic next_textured, next_quad, mixed_in;
    logic [1:0] next_upper;
    logic [AddressW-1:0] next_first_row, next_second_row;
    logic [IndexW-1:0] next_first_i, next_second_i, next_first_j;
    logic [FracW-1:0] next_ex, next_ey;
    texture_address u_next_address (
        .clk_i,
        .rst_ni,
        .en_i(address_en),
        .u_i(in_u_i),
        .v_i(in_v_i),
        .level_i(in_level_i + LevelW'(1)),
        .textured_i(in_textured_i),
        .bilinear_i(in_bilinear_i),
        .clamp_i(in_clamp_i),
        .last_i_i(in_last_i_i),
        .last_j_i(in_last_j_i),
        .pitch_i(in_pitch_i),
        .base_i(in_base_i),
        .textured_o(next_textured),
        .quad_o(next_quad),
        .first_row_o(next_first_row),
        .second_row_o(next_second_row),
        .first_i_o(next_first_i),
        .second_i_o(next_second_i),
        .first_j_o(next_first_j),
        .upper_o(next_upper),
        .ex_o(next_ex),
        .ey_o(next_ey)
    );
    delay_line #(
        .Width(1),
        .Depth(AddressClocks)
    ) u_next_line (
        .clk_i,
        .en_i(address_en),
        .d_i(in_f_i != '0),
        .q_o(mixed_in)
    );
    assign next_6 = mixed_in && next_textured;
    assign next_asked_6 = {next_upper, next_first_i, next_first_j, next_ex, next_ey};
    assign next_rows_6 = {next_second_i, next_first_row, next_second_row};
    assign unused_share = next_quad;
  end else begin : gen_no_next_address
    assign next_6 = 1'b0;
    assign next_asked_6 = '0;
    assign next_rows_6 = '0;
    assign unused_share = ^in_f_i;
  end

  // ---------------------------------------------------------------- requests

  // What is of the next level stands in the highest places, where there is one.
  localparam int LevelAskedW = 2 + AskedW;
  localparam int AllAskedW = LevelAskedW + (Mixes ? 1 + AskedW : 0);
  localparam int AllRowsW = RowsW + (Mixes ? RowsW : 0);
  logic ask_valid, ask_taken, ask_textured, ask_quad, ask_next;
  logic [AskedW-1:0] ask_level, ask_next_level;
  logic [AllAskedW-1:0] ask_all;
  logic [AllRowsW-1:0] ask_rows;
  logic [AddressW-1:0] first_row, second_row, next_first_row, next_second_row;
  logic [IndexW-1:0] first_i, second_i, next_first_i, next_second_i;
  skid #(
      .Width(AllAskedW + AllRowsW)
  ) u_address_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(address_valid_q[AddressClocks-1]),
      .in_ready_o(address_en),
      .in_i({AllAskedW'({next_6, next_asked_6, textured_6, quad_6, upper_6, first_i_6, first_j_6, ex_6, ey_6}),
             AllRowsW'({next_rows_6, second_i_6, first_row_6, second_row_6})}),
      .out_valid_o(ask_valid),
      .out_ready_i(ask_taken),
      .out_o({ask_all, ask_rows})
  );
  localparam int BothAskedW = 1 + AskedW + LevelAskedW;
  assign {ask_next, ask_next_level, ask_textured, ask_quad, ask_level} = BothAskedW'(ask_all);
  assign {next_second_i, next_first_row, next_second_row, second_i, first_row, second_row} = (2 * RowsW)'(ask_rows);
  assign first_i = ask_level[AskedW-3-:IndexW];
  assign next_first_i = ask_next_level[AskedW-3-:IndexW];

  // A fragment leaves when the ports have taken all its requests, on this clock or before.
  logic [Ports-1:0] wanted, asked_q, request_valid, request_ready;
  assign wanted = {{3{ask_next && ask_quad}}, ask_next, {3{ask_quad}}, ask_textured};
  assign request_valid = {Ports{ask_valid}} & wanted & ~asked_q;
  assign ask_taken = &(~wanted | asked_q | request_ready);
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) asked_q <= '0;
    else if (ask_valid) asked_q <= ask_taken ? '0 : asked_q | (request_valid & request_ready);
  end
  assign request0_valid_o = request_valid[0];
  assign request_ready[0] = request0_ready_i;
  assign request0_address_o = first_row | AddressW'(first_i);
  assign request1_valid_o = request_valid[1];
  assign request_ready[1] = request1_ready_i;
  assign request1_address_o = first_row | AddressW'(second_i);
  assign request2_valid_o = request_valid[2];
  assign request_ready[2] = request2_ready_i;
  assign request2_address_o = second_row | AddressW'(first_i);
  assign request3_valid_o = request_valid[3];
  assign request_ready[3] = request3_ready_i;
  assign request3_address_o = second_row | AddressW'(second_i);
  assign request4_valid_o = request_valid[4];
  assign request_ready[4] = request4_ready_i;
  assign request4_address_o = next_first_row | AddressW'(next_first_i);
  assign request5_valid_o = request_valid[5];
  assign request_ready[5] = request5_ready_i;
  assign request5_address_o = next_first_row | AddressW'(next_second_i);
  assign request6_valid_o = request_valid[6];
  assign request_ready[6] = request6_ready_i;
  assign request6_address_o = next_second_row | AddressW'(next_first_i);
  assign request7_valid_o = request_valid[7];
  assign request_ready[7] = request7_ready_i;
  assign request7_address_o = next_second_row | AddressW'(next_second_i);

  // ---------------------------------------------------------------- join

  logic color_en, join_valid, join_taken;
  logic queue_valid, queue_ready, queue_taken, asked_valid, held_valid;
  logic textured, quad, next;
  logic [1:0] upper, next_upper;
  logic [2*IndexW-1:0] index, next_index;
  logic [FracW-1:0] ex, ey, next_ex, next_ey;
  logic [AllAskedW-1:0] queue, asked;
  fifo #(
      .Width(AllAskedW),
      .Depth(InFlight)
  ) u_asked (
      .clk_i,
      .rst_ni,
      .in_valid_i(ask_valid && ask_taken),
      .in_ready_o(queue_ready),
      .in_i(ask_all),
      .out_valid_o(queue_valid),
      .out_ready_i(queue_taken),
      .out_o(queue)
  );
  skid #(
      .Width(AllAskedW)
  ) u_asked_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(queue_valid),
      .in_ready_o(queue_taken),
      .in_i(queue),
      .out_valid_o(asked_valid),
      .out_ready_i(join_taken),
      .out_o(asked)
  );
  assign {next, next_upper, next_index, next_ex, next_ey, textured, quad, upper, index, ex, ey} = BothAskedW'(asked);

  // f waits in front of the rest, where there is one.
  localparam int HeldRestW = ShareW + RestW;
  localparam int HeldW = 4 * ShadeW + 25 + HeldRestW;
  logic [4*ShadeW-1:0] shades;
  logic has_reserved;
  logic [23:0] reserved;
  logic [HeldRestW-1:0] held_rest;
  logic [RestW-1:0] rest;
  assign rest = held_rest[RestW-1:0];
  fifo #(
      .Width(HeldW),
      .Depth(InFlight)
  ) u_held (
      .clk_i,
      .rst_ni,
      .in_valid_i(in_valid_i && address_en),
      .in_ready_o(held_ready),
      .in_i({in_a_i, in_b_i, in_g_i, in_r_i, in_textured_i && in_transparent_i, in_reserved_i,
             HeldRestW'({in_f_i, in_rest_i})}),
      .out_valid_o(held_valid),
      .out_ready_i(join_taken),
      .out_o({shades, has_reserved, reserved, held_rest})
  );

  logic [Ports-1:0] answer_valid, answer_ready, skid_valid, skid_taken;
  logic [32*Ports-1:0] answer, texel;
  assign answer_valid[0] = answer0_valid_i;
  assign answer0_ready_o = answer_ready[0];
  assign answer[0+:32] = answer0_texel_i;
  assign answer_valid[1] = answer1_valid_i;
  assign answer1_ready_o = answer_ready[1];
  assign answer[32+:32] = answer1_texel_i;
  assign answer_valid[2] = answer2_valid_i;
  assign answer2_ready_o = answer_ready[2];
  assign answer[64+:32] = answer2_texel_i;
  assign answer_valid[3] = answer3_valid_i;
  assign answer3_ready_o = answer_ready[3];
  assign answer[96+:32] = answer3_texel_i;
  assign answer_valid[4] = answer4_valid_i;
  assign answer4_ready_o = answer_ready[4];
  assign answer[128+:32] = answer4_texel_i;
  assign answer_valid[5] = answer5_valid_i;
  assign answer5_ready_o = answer_ready[5];
  assign answer[160+:32] = answer5_texel_i;
  assign answer_valid[6] = answer6_valid_i;
  assign answer6_ready_o = answer_ready[6];
  assign answer[192+:32] = answer6_texel_i;
  assign answer_valid[7] = answer7_valid_i;
  assign answer7_ready_o = answer_ready[7];
  assign answer[224+:32] = answer7_texel_i;
  for (genvar p = 0; p < Ports; p++) begin : gen_answer
    if (Mixes || p < 4) begin : gen_port
      // Icarus 11 takes a genvar in the connection of a port here for a new net.
      logic [31:0] word, word_q;
      logic valid, ready, valid_q, taken;
      assign word = answer[32*p+:32];
      assign valid = answer_valid[p];
      assign taken = skid_taken[p];
      skid #(
          .Width(32)
      ) u_skid (
          .clk_i,
          .rst_ni,
          .in_valid_i(valid),
          .in_ready_o(ready),
          .in_i(word),
          .out_valid_o(valid_q),
          .out_ready_i(taken),
          .out_o(word_q)
      );
      assign answer_ready[p] = ready;
      assign skid_valid[p] = valid_q;
      assign texel[32*p+:32] = word_q;
    end else begin : gen_no_port
      assign answer_ready[p] = 1'b0;
      assign skid_valid[p] = 1'b0;
      assign texel[32*p+:32] = '0;
      logic unused;
      assign unused = ^{answer_valid[p], answer[32*p+:32], skid_taken[p]};
    end
  end
  logic [Ports-1:0] awaited;
  assign awaited = {{3{next && quad}}, next, {3{quad}}, textured};
  assign join_valid = asked_valid && (&(~awaited | skid_valid));
  assign join_taken = join_valid && color_en;
  assign skid_taken = {Ports{join_taken}} & awaited;

  // ---------------------------------------------------------------- filter

  // Up to the filter of two levels, or behind that of one.
  localparam int ColorValidW = Mixes ? FilterAt : MixedAt;
  logic [ColorValidW-1:0] color_valid_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) color_valid_q <= '0;
    else if (color_en) color_valid_q <= {color_valid_q[ColorValidW-2:0], join_valid};
  end

  logic [95:0] color_3;
  logic [4*AlphaW-1:0] alpha_3;
  logic hole_3;
  texture_words u_words (
      .clk_i,
      .en_i(color_en),
      .words_i(texel[127:0]),
      .textured_i(textured),
      .quad_i(quad),
      .upper_i(upper),
      .has_reserved_i(has_reserved),
      .reserved_i(reserved),
      .colors_o(color_3),
      .alphas_o(alpha_3),
      .hole_o(hole_3)
  );
  logic [FracW-1:0] ex_at_filter;
  delay_line #(
      .Width(FracW),
      .Depth(FilterAt)
  ) u_ex_line (
      .clk_i,
      .en_i(color_en),
      .d_i(ex),
      .q_o(ex_at_filter)
  );

  // Behind the filter the product's segment begins, which may be the same one: V, and a clock later the shades. Behind the
  // product: V, the rest of the record, and what the fragment brings along.
  localparam int TexelsW = 3 * MixW + AlphaW;
  localparam int BesideW = 2 * IndexW + 2 * FracW;
  logic shade_en, shade_valid;
  logic [TexelsW-1:0] mixed, texels_out;
  logic [4*ShadeW-1:0] shades_mixed;
  logic [BesideW-1:0] beside_out;
  logic [RestW-1:0] rest_out;
  logic hole_out;
  if (Mixes) begin : gen_two_levels
    // The other level's texels.
    logic [95:0] next_color_3;
    logic [4*AlphaW-1:0] next_alpha_3;
    logic [FracW-1:0] ey_at_filter, next_ex_at_filter, next_ey_at_filter;
    logic [ShareW-1:0] share_at_filter;
    logic next_hole;
    texture_words u_next_words (
        .clk_i,
        .en_i(color_en),
        .words_i(texel[255:128]),
        .textured_i(next),
        .quad_i(next && quad),
        .upper_i(next_upper),
        .has_reserved_i(has_reserved),
        .reserved_i(reserved),
        .colors_o(next_color_3),
        .alphas_o(next_alpha_3),
        .hole_o(next_hole)
    );
    delay_line #(
        .Width(3 * FracW + ShareW),
        .Depth(FilterAt)
    ) u_shares_line (
        .clk_i,
        .en_i(color_en),
        .d_i({ey, next_ex, next_ey, held_rest[RestW+:ShareW]}),
        .q_o({ey_at_filter, next_ex_at_filter, next_ey_at_filter, share_at_filter})
    );
    localparam int BroughtW = 4 * ShadeW + BesideW + RestW;
    logic [BroughtW-1:0] brought;
    delay_line #(
        .Width(BroughtW),
        .Depth(FilterAt)
    ) u_brought_line (
        .clk_i,
        .en_i(color_en),
        .d_i({shades, index, ex, ey, rest}),
        .q_o(brought)
    );
    logic hole_levels;
    logic [4*ShadeW-1:0] shades_levels;
    logic [BesideW-1:0] beside_levels;
    logic [RestW-1:0] rest_levels;
    texture_levels #(
        .RestW(1 + BroughtW)
    ) u_levels (
        .clk_i,
        .rst_ni,
        .in_valid_i(color_valid_q[FilterAt-1]),
        .in_ready_o(color_en),
        .in_color1_i(color_3[23:0]),
        .in_color4_i(color_3[47:24]),
        .in_color2_i(color_3[71:48]),
        .in_color3_i(color_3[95:72]),
        .in_alpha1_i(alpha_3[0+:AlphaW]),
        .in_alpha4_i(alpha_3[AlphaW+:AlphaW]),
        .in_alpha2_i(alpha_3[2*AlphaW+:AlphaW]),
        .in_alpha3_i(alpha_3[3*AlphaW+:AlphaW]),
        .in_ex_i(ex_at_filter),
        .in_ey_i(ey_at_filter),
        .in_next_color1_i(next_color_3[23:0]),
        .in_next_color4_i(next_color_3[47:24]),
        .in_next_color2_i(next_color_3[71:48]),
        .in_next_color3_i(next_color_3[95:72]),
        .in_next_alpha1_i(next_alpha_3[0+:AlphaW]),
        .in_next_alpha4_i(next_alpha_3[AlphaW+:AlphaW]),
        .in_next_alpha2_i(next_alpha_3[2*AlphaW+:AlphaW]),
        .in_next_alpha3_i(next_alpha_3[3*AlphaW+:AlphaW]),
        .in_next_ex_i(next_ex_at_filter),
        .in_next_ey_i(next_ey_at_filter),
        .in_f_i(share_at_filter),
        .in_rest_i({hole_3, brought}),
        .out_valid_o(shade_valid),
        .out_ready_i(shade_en),
        .out_r_o(mixed[0+:MixW]),
        .out_g_o(mixed[MixW+:MixW]),
        .out_b_o(mixed[2*MixW+:MixW]),
        .out_a_o(mixed[3*MixW+:AlphaW]),
        .out_rest_o({hole_levels, shades_levels, beside_levels, rest_levels})
    );
    ring_line #(
        .Width(1 + TexelsW + BesideW),
        .Depth(ShadeClocks)
    ) u_out_line (
        .clk_i,
        .rst_ni,
        .en_i(shade_en),
        .d_i({hole_levels, mixed, beside_levels}),
        .q_o({hole_out, texels_out, beside_out})
    );
    ring_line #(
        .Width(RestW),
        .Depth(ShadeClocks - AlphaTestClocks)
    ) u_rest_line (
        .clk_i,
        .rst_ni,
        .en_i(shade_en),
        .d_i(rest_levels),
        .q_o(alpha_rest_o)
    );
    always_ff @(posedge clk_i) begin
      if (shade_en) shades_mixed <= shades_levels;
    end
    logic unused;
    assign unused = ^{next_hole, next_index};
  end else begin : gen_one_level
    assign color_en = shade_en;
    assign shade_valid = color_valid_q[MixedAt-1];
    logic [FracW-1:0] ey_at_second;
    ring_line #(
        .Width(FracW),
        .Depth(FilterAt + BlendClocks)
    ) u_ey_line (
        .clk_i,
        .rst_ni,
        .en_i(color_en),
        .d_i(ey),
        .q_o(ey_at_second)
    );
    for (genvar c = 0; c < 3; c++) begin : gen_filter
      logic [7:0] v1, v4, v2, v3;
      logic [MixW-1:0] v;
      assign v1 = color_3[8*c+:8];
      assign v4 = color_3[24+8*c+:8];
      assign v2 = color_3[48+8*c+:8];
      assign v3 = color_3[72+8*c+:8];
      texture_filter #(
          .InW(8),
          .FracW(FracW),
          .OutW(MixW),
          .OutFrac(MixFrac),
          .OutSigned(MixSigned),
          .OutRnd(MixRnd),
          .OutOvf(MixOvf),
          .ProductClocks(FilterClocks),
          .BlendClocks(BlendClocks)
      ) u_filter (
          .clk_i,
          .en_i(color_en),
          .v1_i(v1),
          .v4_i(v4),
          .v2_i(v2),
          .v3_i(v3),
          .ex_i(ex_at_filter),
          .ey_i(ey_at_second),
          .v_o(v)
      );
      assign mixed[c*MixW+:MixW] = v;
    end
    texture_filter #(
        .InW(AlphaW),
        .InFrac(AlphaFrac),
        .InSigned(AlphaSigned),
        .FracW(FracW),
        .OutW(AlphaW),
        .OutFrac(AlphaFrac),
        .OutSigned(AlphaSigned),
        .OutRnd(AlphaRnd),
        .OutOvf(AlphaOvf),
        .ProductClocks(FilterClocks),
        .BlendClocks(BlendClocks)
    ) u_filter_a (
        .clk_i,
        .en_i(color_en),
        .v1_i(alpha_3[0+:AlphaW]),
        .v4_i(alpha_3[AlphaW+:AlphaW]),
        .v2_i(alpha_3[2*AlphaW+:AlphaW]),
        .v3_i(alpha_3[3*AlphaW+:AlphaW]),
        .ex_i(ex_at_filter),
        .ey_i(ey_at_second),
        .v_o(mixed[3*MixW+:AlphaW])
    );

    // What waits beside the filter and the products.
    ring_line #(
        .Width(4 * ShadeW),
        .Depth(MixedAt + 1)
    ) u_shade_line (
        .clk_i,
        .rst_ni,
        .en_i(color_en),
        .d_i(shades),
        .q_o(shades_mixed)
    );
    ring_line #(
        .Width(BesideW),
        .Depth(ColorClocks)
    ) u_record_line (
        .clk_i,
        .rst_ni,
        .en_i(color_en),
        .d_i({index, ex, ey}),
        .q_o(beside_out)
    );
    ring_line #(
        .Width(RestW),
        .Depth(ColorClocks - AlphaTestClocks)
    ) u_rest_line (
        .clk_i,
        .rst_ni,
        .en_i(color_en),
        .d_i(rest),
        .q_o(alpha_rest_o)
    );
    delay_line #(
        .Width(TexelsW),
        .Depth(ShadeClocks)
    ) u_texel_line (
        .clk_i,
        .en_i(color_en),
        .d_i(mixed),
        .q_o(texels_out)
    );
    delay_line #(
        .Width(1),
        .Depth(ColorClocks - FilterAt)
    ) u_hole_line (
        .clk_i,
        .en_i(color_en),
        .d_i(hole_3),
        .q_o(hole_out)
    );
    logic unused;
    assign unused = ^{next_upper, next_index, next_ex, next_ey, texel[255:128]};
  end

  // ---------------------------------------------------------------- colour

  // Times the shades: factors, product, Q. The factors have registers of their own, near the multipliers.
  logic [ShadeClocks-1:0] shade_valid_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) shade_valid_q <= '0;
    else if (shade_en) shade_valid_q <= {shade_valid_q[ShadeClocks-2:0], shade_valid};
  end
  localparam int ShadeFactorW = ShadeW + ((ShadeSigned != 0) ? 0 : 1);
  localparam int MixFactorW = MixW + ((MixSigned != 0) ? 0 : 1);
  localparam int AlphaFactorW = AlphaW + ((AlphaSigned != 0) ? 0 : 1);
  logic signed [ShadeFactorW-1:0] shade[4];
  for (genvar c = 0; c < 4; c++) begin : gen_shade
    assign shade[c] = ShadeFactorW'($signed({(ShadeSigned != 0) & shades_mixed[(c+1)*ShadeW-1],
                                             shades_mixed[c*ShadeW+:ShadeW]}));
  end
  logic [ColorW-1:0] color_q[3];
  for (genvar c = 0; c < 3; c++) begin : gen_color
    logic signed [MixFactorW-1:0] factor_q;
    logic signed [MixFactorW+ShadeFactorW-1:0] product;
    logic [ColorW-1:0] color;
    mul_pipe #(
        .AW(MixFactorW),
        .BW(ShadeFactorW),
        .Clocks(ShadeProductClocks)
    ) u_product (
        .clk_i,
        .en_i(shade_en),
        .a_i(factor_q),
        .b_i(shade[c]),
        .p_o(product)
    );
    quantize #(
        .InW(MixFactorW + ShadeFactorW),
        .InFrac(MixFrac + ShadeFrac),
        .OutW(ColorW),
        .OutFrac(bitspan_pixel_pkg::TextureColorFrac),
        .OutSigned(bitspan_pixel_pkg::TextureColorSigned),
        .Rounding(bitspan_pixel_pkg::TextureColorRnd),
        .Overflow(bitspan_pixel_pkg::TextureColorOvf)
    ) u_color (
        .x_i(product),
        .sticky_i(1'b0),
        .q_o(color)
    );
    always_ff @(posedge clk_i) begin
      if (shade_en) begin
        factor_q <= MixFactorW'($signed({(MixSigned != 0) & mixed[(c+1)*MixW-1], mixed[c*MixW+:MixW]}));
        color_q[c] <= color;
      end
    end
  end
  logic signed [AlphaFactorW-1:0] factor_a_q;
  logic signed [AlphaFactorW+ShadeFactorW-1:0] product_a;
  logic [AlphaW-1:0] alpha, alpha_q;
  mul_pipe #(
      .AW(AlphaFactorW),
      .BW(ShadeFactorW),
      .Clocks(ShadeProductClocks)
  ) u_product_a (
      .clk_i,
      .en_i(shade_en),
      .a_i(factor_a_q),
      .b_i(shade[3]),
      .p_o(product_a)
  );
  quantize #(
      .InW(AlphaFactorW + ShadeFactorW),
      .InFrac(AlphaFrac + ShadeFrac),
      .OutW(AlphaW),
      .OutFrac(AlphaFrac),
      .OutSigned(AlphaSigned),
      .Rounding(AlphaRnd),
      .Overflow(AlphaOvf)
  ) u_alpha (
      .x_i(product_a),
      .sticky_i(1'b0),
      .q_o(alpha)
  );
  always_ff @(posedge clk_i) begin
    if (shade_en) begin
      factor_a_q <= AlphaFactorW'($signed({(AlphaSigned != 0) & mixed[TexelsW-1], mixed[3*MixW+:AlphaW]}));
      alpha_q <= alpha;
    end
  end

  ring_line #(
      .Width(RestW),
      .Depth(AlphaTestClocks)
  ) u_rest_end_line (
      .clk_i,
      .rst_ni,
      .en_i(shade_en),
      .d_i(alpha_rest_o),
      .q_o(rest_out)
  );
  // The alpha test: no division is left where the fragment leaves. Its code floor(255 a + 1/2) reaches k from
  // a = (2 k - 1) / 510 on; a's least raw value for the reference and for the next code are formed beside the products.
  // n / 255 is n's whole 255s, and behind the point the rest's byte for ever.
  localparam int CompareAlphaW = ((AlphaW > AlphaFrac + 1) ? AlphaW : AlphaFrac + 1) + 1;
  localparam int Copies = AlphaFrac / 8 + 1;
  localparam int Digits = 8 * Copies;
  logic [2:0] alpha_func_1, alpha_func_2, alpha_func_3;
  logic [7:0] alpha_ref_1;
  logic keeps_zero_1, keeps_zero_2, keeps_zero_3;
  logic ref_is_zero_2, ref_is_last_2, ref_is_last_3;
  logic signed [CompareAlphaW-1:0] alpha_least_q[2];
  always_ff @(posedge clk_i) begin
    if (shade_en) begin
      alpha_func_1 <= alpha_func_i;
      alpha_func_2 <= alpha_func_1;
      alpha_func_3 <= alpha_func_2;
      alpha_ref_1 <= alpha_ref_i;
      keeps_zero_1 <= alpha_keeps_zero_i;
      keeps_zero_2 <= keeps_zero_1;
      keeps_zero_3 <= keeps_zero_2;
      ref_is_zero_2 <= alpha_ref_1 == '0;
      ref_is_last_2 <= &alpha_ref_1;
      ref_is_last_3 <= ref_is_last_2;
    end
  end
  for (genvar k = 0; k < 2; k++) begin : gen_least
    // 2 k - 1 for the reference, which is above 0, and the code behind it.
    logic [8:0] odd_1;
    logic whole_1, whole_2;
    logic [7:0] byte_1, byte_2;
    logic [Digits:0] exact_2, floor_2;
    logic signed [CompareAlphaW-1:0] least_2;
    if (k == 0) begin : gen_reference
      assign odd_1 = {alpha_ref_1, 1'b0} - 9'd1;
    end else begin : gen_next
      assign odd_1 = {alpha_ref_1, 1'b1};
    end
    assign whole_1 = odd_1 >= 9'd255;
    assign byte_1 = odd_1[7:0] + {7'd0, whole_1};
    assign exact_2 = {whole_2, {Copies{byte_2}}};
    assign floor_2 = exact_2 >> (Digits + 1 - AlphaFrac);
    logic unused_floor;
    assign unused_floor = ^floor_2;
    // Rounded up. Without a fraction, what is cut off is whole, too.
    assign least_2 = CompareAlphaW'(floor_2) + CompareAlphaW'((|byte_2) || ((AlphaFrac == 0) && whole_2));
    if (k == 0) begin : gen_zero
      // Code 0 begins below 0: at -1 / 510.
      logic [Digits:0] ones, below;
      logic signed [CompareAlphaW-1:0] below_wide;
      assign ones = {1'b0, {Copies{8'd1}}};
      assign below = ones >> (Digits + 1 - AlphaFrac);
      assign below_wide = CompareAlphaW'(below);
      logic unused_ones;
      assign unused_ones = ^below;
      always_ff @(posedge clk_i) begin
        if (shade_en) alpha_least_q[k] <= ref_is_zero_2 ? -below_wide : least_2;
      end
    end else begin : gen_others
      always_ff @(posedge clk_i) begin
        if (shade_en) alpha_least_q[k] <= least_2;
      end
    end
    always_ff @(posedge clk_i) begin
      if (shade_en) begin
        whole_2 <= whole_1;
        byte_2 <= byte_1;
      end
    end
  end
  logic signed [CompareAlphaW-1:0] alpha_wide;
  logic reaches_ref, is_above_ref, alpha_passes;
  assign alpha_wide = CompareAlphaW'($signed({(AlphaSigned != 0) & alpha_q[AlphaW-1], alpha_q}));
  assign reaches_ref = alpha_wide >= alpha_least_q[0];
  assign is_above_ref = alpha_wide >= alpha_least_q[1] && !ref_is_last_3;
  assign alpha_passes = (!reaches_ref && alpha_func_3[0]) || (reaches_ref && !is_above_ref && alpha_func_3[1]) ||
                        (is_above_ref && alpha_func_3[2]);

  localparam int RecordW = BesideW + TexelsW + 3 * ColorW + AlphaW + 1;
  skid #(
      .Width(RecordW + RestW)
  ) u_out_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(shade_valid_q[ShadeClocks-1]),
      .in_ready_o(shade_en),
      .in_i({beside_out, texels_out, color_q[0], color_q[1], color_q[2], alpha_q,
             hole_out || (alpha_q == '0 && !keeps_zero_3) || !alpha_passes, rest_out}),
      .out_valid_o,
      .out_ready_i,
      .out_o({out_i_o, out_j_o, out_ex_o, out_ey_o, out_texel_a_o, out_texel_b_o, out_texel_g_o, out_texel_r_o,
              out_r_o, out_g_o, out_b_o, out_a_o, out_killed_o, out_rest_o})
  );

  logic unused;
  assign unused = ^{queue_ready, held_valid, unused_share, ask_level, ask_next_level};

`ifndef SYNTHESIS
  initial begin
    assert (bitspan_pixel_pkg::TextureColorClocks == ColorClocks &&
            bitspan_pixel_pkg::TextureShadeClocks == (Mixes ? ShadeClocks : 0))
    else $fatal(1, "texture: has %0d and %0d clocks, told %0d and %0d", ColorClocks, ShadeClocks,
                bitspan_pixel_pkg::TextureColorClocks, bitspan_pixel_pkg::TextureShadeClocks);
  end
  always @(posedge clk_i) begin
    if (in_taken && in_textured_i) begin
      assert ((in_clamp_i[0] || (in_last_i_i & (in_last_i_i + 1'b1)) == '0) &&
              (in_clamp_i[1] || (in_last_j_i & (in_last_j_i + 1'b1)) == '0))
      else $fatal(1, "texture: a cyclic texture of %0d x %0d texels", in_last_i_i + 1, in_last_j_i + 1);
      assert ((AddressW'(in_last_i_i) >> in_pitch_i) == '0 && (in_base_i & ((AddressW'(1) << in_pitch_i) - 1'b1)) == '0)
      else $fatal(1, "texture: base %0d or pitch %0d do not suit rows of %0d texels", in_base_i, in_pitch_i,
                  in_last_i_i + 1);
    end
    if (ask_valid && ask_taken) begin
      assert (queue_ready)
      else $fatal(1, "texture: more fragments wait for texels than there is room for");
    end
    if (asked_valid) begin
      assert (held_valid)
      else $fatal(1, "texture: a fragment's shades are not there");
    end
  end
`endif
endmodule
