// SPDX-License-Identifier: Apache-2.0
// texture of docs/numeric-spec.md: a fragment in, its texel times its colour out; one per clock.
//
//   in --> address ---> skid --> requests ------------------> four texel ports
//    |     (6 clocks)               |                              |
//    |                              +--> FIFO `asked`, skid    4 skids
//    |                                       |                     |
//    +--> FIFO `held` (shades, rest) --------+--> join <-----------+
//                                                  |
//                                                  +--> filter and colour --> skid --> out
//
// `address` and `filter and colour` each shift as one on the ready of the skid behind them, which is a register. The
// FIFOs have InFlight entries; a fragment is accepted where `held` has room, so that `asked` never overflows.
//
// A texel is 32 bits: red in the lowest byte, then green, blue, alpha. Texel (i, j) of a texture has the address
// base + j 2^pitch + i, with base a multiple of 2^pitch and 2^pitch at least the texture's width. Port 0 reads the
// nearest texel or V1, port 1 V4, port 2 V2, port 3 V3. Each port answers in the order of its requests.
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
    input  logic [RestW-1:0] in_rest_i,
    // The draw state, taken with the fragment: a texture or none, bilinear or nearest, clamp or cyclic, the last column
    // and row of texels, the pitch, the address of texel (0, 0), and the reserved colour, if there is one.
    input  logic in_textured_i,
    input  logic in_bilinear_i,
    input  logic in_clamp_i,
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
  localparam int UvW = bitspan_pixel_pkg::SpanUvW;
  localparam int UvFrac = bitspan_pixel_pkg::SpanUvFrac;
  localparam int UvSigned = bitspan_pixel_pkg::SpanUvSigned;
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
  localparam int PitchW = bitspan_pixel_pkg::TexelPitchW;
  localparam int AddressW = bitspan_pixel_pkg::TexelAddressW;
  localparam int InFlight = bitspan_pixel_pkg::FragmentsInFlight;

  localparam int AddressClocks = 6;
  localparam int FilterClocks = bitspan_pixel_pkg::TextureFilterProductClocks;
  localparam int ShadeClocks = bitspan_pixel_pkg::TextureShadeProductClocks;
  localparam int BlendClocks = 3 + FilterClocks;
  // Words, reserved colours, replacement; the filter; factors, product, Q.
  localparam int FilterAt = 3;
  localparam int MixedAt = FilterAt + 2 * BlendClocks;
  localparam int FactorsAt = MixedAt + 1;
  localparam int ColorClocks = FactorsAt + ShadeClocks + 1;
  // Beside the last of them: the reference; its wholes and byte; the least alpha.
  localparam int AlphaTestClocks = 3;

  // ---------------------------------------------------------------- address

  // u on a grid that has the half, as a signed number that can lose it.
  localparam int Grid = (UvFrac > 1) ? UvFrac : 1;
  localparam int LowW = UvW + Grid - UvFrac + ((UvSigned != 0) ? 1 : 2);
  localparam int WholeW = LowW - Grid;
  // A texel's index beside the wholes of u, which may be the narrower.
  localparam int CompareW = (WholeW > IndexW + 1) ? WholeW : IndexW + 1;

  logic address_en, held_ready, in_taken;
  logic [AddressClocks-1:0] address_valid_q;
  assign in_ready_o = address_en && held_ready;
  assign in_taken = in_valid_i && in_ready_o;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) address_valid_q <= '0;
    else if (address_en) address_valid_q <= {address_valid_q[AddressClocks-2:0], in_taken};
  end

  // Axis 0 is u, 1 is v.
  logic [UvW-1:0] in_uv[2];
  logic [IndexW-1:0] in_last[2];
  assign in_uv[0] = in_u_i;
  assign in_uv[1] = in_v_i;
  assign in_last[0] = in_last_i_i;
  assign in_last[1] = in_last_j_i;
  logic textured_1, quad_1, clamp_1;
  always_ff @(posedge clk_i) begin
    if (address_en) begin
      textured_1 <= in_textured_i;
      quad_1 <= in_textured_i && in_bilinear_i;
      clamp_1 <= in_clamp_i;
    end
  end
  logic textured_6, quad_6;
  delay_line #(
      .Width(2),
      .Depth(AddressClocks - 1)
  ) u_filter_line (
      .clk_i,
      .en_i(address_en),
      .d_i({textured_1, quad_1}),
      .q_o({textured_6, quad_6})
  );

  // No unpacked array: Yosys 0.23 would take a word at an output port for a read of memory.
  logic [2*FracW-1:0] frac_6;
  logic [1:0] upper_6;  // of the two texels along an axis, the second one is nearest
  logic [IndexW-1:0] first_3[2], second_3[2];
  for (genvar axis = 0; axis < 2; axis++) begin : gen_axis
    // Clock 1: u - 1/2, or u for the nearest texel.
    logic signed [LowW-1:0] low, low_1;
    logic [IndexW-1:0] last_1;
    assign low = LowW'($signed({(UvSigned != 0) & in_uv[axis][UvW-1], in_uv[axis]})) <<< (Grid - UvFrac);
    always_ff @(posedge clk_i) begin
      if (address_en) begin
        low_1 <= low - ((in_bilinear_i) ? LowW'(1) <<< (Grid - 1) : '0);
        last_1 <= in_last[axis];
      end
    end

    // Clock 2: the texels' indices before they are wrapped, where they lie, and E.
    logic signed [CompareW-1:0] whole;
    logic [FracW-1:0] frac;
    assign whole = CompareW'($signed(low_1[LowW-1:Grid]));
    quantize #(
        .InW(Grid + 1),
        .InFrac(Grid),
        .OutW(FracW),
        .OutFrac(FracW),
        .OutSigned(0),
        .Rounding(bitspan_pixel_pkg::TextureFracRnd),
        .Overflow(bitspan_pixel_pkg::TextureFracOvf)
    ) u_frac (
        .x_i($signed({1'b0, low_1[Grid-1:0]})),
        .sticky_i(1'b0),
        .q_o(frac)
    );
    logic [IndexW-1:0] first_2, second_2, last_2;
    logic zero_2, first_past_2, second_past_2, cyclic_2, upper_2;
    logic [FracW-1:0] frac_2;
    always_ff @(posedge clk_i) begin
      if (address_en) begin
        first_2 <= whole[IndexW-1:0];
        second_2 <= whole[IndexW-1:0] + IndexW'(1);
        zero_2 <= !textured_1 || (clamp_1 && whole < 0);
        first_past_2 <= clamp_1 && whole > $signed(CompareW'({1'b0, last_1}));
        second_past_2 <= clamp_1 && whole >= $signed(CompareW'({1'b0, last_1}));
        cyclic_2 <= !clamp_1;
        last_2 <= last_1;
        upper_2 <= quad_1 && low_1[Grid-1];
        frac_2 <= quad_1 ? frac : '0;
      end
    end

    // Clock 3: wrapped. The last index of a cyclic texture is a mask.
    always_ff @(posedge clk_i) begin
      if (address_en) begin
        first_3[axis] <= zero_2 ? '0 : first_past_2 ? last_2 : first_2 & (last_2 | {IndexW{!cyclic_2}});
        second_3[axis] <= zero_2 ? '0 : second_past_2 ? last_2 : second_2 & (last_2 | {IndexW{!cyclic_2}});
      end
    end

    delay_line #(
        .Width(FracW + 1),
        .Depth(AddressClocks - 2)
    ) u_frac_line (
        .clk_i,
        .en_i(address_en),
        .d_i({upper_2, frac_2}),
        .q_o({upper_6[axis], frac_6[axis*FracW+:FracW]})
    );
  end

  // Clocks 4 and 5: rows by the pitch, first by its two low bits; clock 6: plus the base.
  logic [PitchW-1:0] pitch_3;
  logic [PitchW-3:0] pitch_high_4;
  logic [AddressW-1:0] base_5;
  delay_line #(
      .Width(PitchW),
      .Depth(3)
  ) u_pitch_line (
      .clk_i,
      .en_i(address_en),
      .d_i(in_pitch_i),
      .q_o(pitch_3)
  );
  ring_line #(
      .Width(AddressW),
      .Depth(5)
  ) u_base_line (
      .clk_i,
      .rst_ni,
      .en_i(address_en),
      .d_i(in_base_i),
      .q_o(base_5)
  );
  logic [AddressW-1:0] first_row_4, second_row_4, first_row_5, second_row_5, first_row_6, second_row_6;
  always_ff @(posedge clk_i) begin
    if (address_en) begin
      pitch_high_4 <= pitch_3[PitchW-1:2];
      first_row_4 <= AddressW'(first_3[1]) << pitch_3[1:0];
      second_row_4 <= AddressW'(second_3[1]) << pitch_3[1:0];
      first_row_5 <= first_row_4 << {pitch_high_4, 2'b00};
      second_row_5 <= second_row_4 << {pitch_high_4, 2'b00};
      first_row_6 <= base_5 + first_row_5;
      second_row_6 <= base_5 + second_row_5;
    end
  end
  logic [IndexW-1:0] first_i_6, second_i_6, first_j_6;
  delay_line #(
      .Width(3 * IndexW),
      .Depth(3)
  ) u_index_line (
      .clk_i,
      .en_i(address_en),
      .d_i({first_3[0], second_3[0], first_3[1]}),
      .q_o({first_i_6, second_i_6, first_j_6})
  );

  // ---------------------------------------------------------------- requests

  // What the filter needs to know of a fragment whose texels are on their way.
  localparam int AskedW = 4 + 2 * IndexW + 2 * FracW;
  logic ask_valid, ask_taken, ask_textured, ask_quad;
  logic [1:0] ask_upper;
  logic [AddressW-1:0] first_row, second_row;
  logic [IndexW-1:0] first_i, second_i, ask_j;
  logic [FracW-1:0] ask_ex, ask_ey;
  skid #(
      .Width(AskedW + IndexW + 2 * AddressW)
  ) u_address_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(address_valid_q[AddressClocks-1]),
      .in_ready_o(address_en),
      .in_i({textured_6, quad_6, upper_6, first_i_6, first_j_6, frac_6[FracW-1:0], frac_6[2*FracW-1:FracW], second_i_6, first_row_6,
             second_row_6}),
      .out_valid_o(ask_valid),
      .out_ready_i(ask_taken),
      .out_o({ask_textured, ask_quad, ask_upper, first_i, ask_j, ask_ex, ask_ey, second_i, first_row, second_row})
  );

  // A fragment leaves when the ports have taken all its requests, on this clock or before.
  logic [3:0] wanted, asked_q, request_valid, request_ready;
  assign wanted = {{3{ask_quad}}, ask_textured};
  assign request_valid = {4{ask_valid}} & wanted & ~asked_q;
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

  // ---------------------------------------------------------------- join

  logic color_en, join_valid, join_taken;
  logic queue_valid, queue_ready, queue_taken, asked_valid, held_valid;
  logic textured, quad;
  logic [1:0] upper;
  logic [2*IndexW-1:0] index;
  logic [FracW-1:0] ex, ey;
  logic [AskedW-1:0] queue;
  fifo #(
      .Width(AskedW),
      .Depth(InFlight)
  ) u_asked (
      .clk_i,
      .rst_ni,
      .in_valid_i(ask_valid && ask_taken),
      .in_ready_o(queue_ready),
      .in_i({ask_textured, ask_quad, ask_upper, first_i, ask_j, ask_ex, ask_ey}),
      .out_valid_o(queue_valid),
      .out_ready_i(queue_taken),
      .out_o(queue)
  );
  skid #(
      .Width(AskedW)
  ) u_asked_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(queue_valid),
      .in_ready_o(queue_taken),
      .in_i(queue),
      .out_valid_o(asked_valid),
      .out_ready_i(join_taken),
      .out_o({textured, quad, upper, index, ex, ey})
  );

  localparam int HeldW = 4 * ShadeW + 25 + RestW;
  logic [4*ShadeW-1:0] shades;
  logic has_reserved;
  logic [23:0] reserved;
  logic [RestW-1:0] rest;
  fifo #(
      .Width(HeldW),
      .Depth(InFlight)
  ) u_held (
      .clk_i,
      .rst_ni,
      .in_valid_i(in_valid_i && address_en),
      .in_ready_o(held_ready),
      .in_i({in_a_i, in_b_i, in_g_i, in_r_i, in_textured_i && in_transparent_i, in_reserved_i, in_rest_i}),
      .out_valid_o(held_valid),
      .out_ready_i(join_taken),
      .out_o({shades, has_reserved, reserved, rest})
  );

  logic [3:0] answer_valid, answer_ready, skid_valid, skid_taken;
  logic [31:0] answer[4], texel[4];
  assign answer_valid[0] = answer0_valid_i;
  assign answer0_ready_o = answer_ready[0];
  assign answer[0] = answer0_texel_i;
  assign answer_valid[1] = answer1_valid_i;
  assign answer1_ready_o = answer_ready[1];
  assign answer[1] = answer1_texel_i;
  assign answer_valid[2] = answer2_valid_i;
  assign answer2_ready_o = answer_ready[2];
  assign answer[2] = answer2_texel_i;
  assign answer_valid[3] = answer3_valid_i;
  assign answer3_ready_o = answer_ready[3];
  assign answer[3] = answer3_texel_i;
  for (genvar p = 0; p < 4; p++) begin : gen_answer
    skid #(
        .Width(32)
    ) u_skid (
        .clk_i,
        .rst_ni,
        .in_valid_i(answer_valid[p]),
        .in_ready_o(answer_ready[p]),
        .in_i(answer[p]),
        .out_valid_o(skid_valid[p]),
        .out_ready_i(skid_taken[p]),
        .out_o(texel[p])
    );
  end
  logic [3:0] awaited;
  assign awaited = {{3{quad}}, textured};
  assign join_valid = asked_valid && (&(~awaited | skid_valid));
  assign join_taken = join_valid && color_en;
  assign skid_taken = {4{join_taken}} & awaited;

  // ---------------------------------------------------------------- filter and colour

  logic [ColorClocks-1:0] color_valid_q;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) color_valid_q <= '0;
    else if (color_en) color_valid_q <= {color_valid_q[ColorClocks-2:0], join_valid};
  end

  // Clock 1: the words; a single texel stands for all four, and no texture for white.
  logic [31:0] word_1[4];
  logic [1:0] upper_1;
  logic has_reserved_1;
  logic [23:0] reserved_1;
  always_ff @(posedge clk_i) begin
    if (color_en) begin
      for (int p = 0; p < 4; p++) word_1[p] <= quad ? texel[p] : textured ? texel[0] : '1;
      upper_1 <= upper;
      has_reserved_1 <= has_reserved;
      reserved_1 <= reserved;
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
      // Texels 0, 1, 2, 3 are V1, V4, V2, V3.
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
        .OutSigned(AlphaSigned),
        .Rounding(AlphaRnd),
        .Overflow(AlphaOvf)
    ) u_alpha (
        .x_i(exact),
        .sticky_i(!opaque && code != '0),
        .q_o(alpha)
    );
    always_ff @(posedge clk_i) begin
      if (color_en) begin
        color_2[p] <= word[p][23:0];
        alpha_2[p] <= alpha;
      end
    end
    if (p < 4) begin : gen_reserved
      always_ff @(posedge clk_i) begin
        if (color_en) reserved_2[p] <= has_reserved_1 && word[p][23:0] == reserved_1;
      end
    end
  end
  logic [1:0] upper_2;
  always_ff @(posedge clk_i) begin
    if (color_en) upper_2 <= upper_1;
  end

  // Clock 3: the nearest texel in place of reserved ones.
  logic [23:0] color_3[4];
  logic [AlphaW-1:0] alpha_3[4];
  logic hole_3;
  always_ff @(posedge clk_i) begin
    if (color_en) begin
      for (int p = 0; p < 4; p++) begin
        color_3[p] <= reserved_2[p] ? color_2[4] : color_2[p];
        alpha_3[p] <= reserved_2[p] ? alpha_2[4] : alpha_2[p];
      end
      hole_3 <= reserved_2[upper_2];
    end
  end

  // The filter.
  logic [FracW-1:0] ex_at_filter, ey_at_second;
  delay_line #(
      .Width(FracW),
      .Depth(FilterAt)
  ) u_ex_line (
      .clk_i,
      .en_i(color_en),
      .d_i(ex),
      .q_o(ex_at_filter)
  );
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
  logic [MixW-1:0] mixed[3];
  logic [AlphaW-1:0] mixed_a;
  for (genvar c = 0; c < 3; c++) begin : gen_filter
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
        .v1_i(color_3[0][8*c+:8]),
        .v4_i(color_3[1][8*c+:8]),
        .v2_i(color_3[2][8*c+:8]),
        .v3_i(color_3[3][8*c+:8]),
        .ex_i(ex_at_filter),
        .ey_i(ey_at_second),
        .v_o(mixed[c])
    );
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
      .v1_i(alpha_3[0]),
      .v4_i(alpha_3[1]),
      .v2_i(alpha_3[2]),
      .v3_i(alpha_3[3]),
      .ex_i(ex_at_filter),
      .ey_i(ey_at_second),
      .v_o(mixed_a)
  );

  // Times the shades: factors, product, Q. The factors have registers of their own, near the multipliers.
  logic [4*ShadeW-1:0] shades_mixed;
  ring_line #(
      .Width(4 * ShadeW),
      .Depth(FactorsAt)
  ) u_shade_line (
      .clk_i,
      .rst_ni,
      .en_i(color_en),
      .d_i(shades),
      .q_o(shades_mixed)
  );
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
        .Clocks(ShadeClocks)
    ) u_product (
        .clk_i,
        .en_i(color_en),
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
      if (color_en) begin
        factor_q <= MixFactorW'($signed({(MixSigned != 0) & mixed[c][MixW-1], mixed[c]}));
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
      .Clocks(ShadeClocks)
  ) u_product_a (
      .clk_i,
      .en_i(color_en),
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
    if (color_en) begin
      factor_a_q <= AlphaFactorW'($signed({(AlphaSigned != 0) & mixed_a[AlphaW-1], mixed_a}));
      alpha_q <= alpha;
    end
  end

  // What waits beside the filter and the products.
  logic [2*IndexW-1:0] index_out;
  logic [FracW-1:0] ex_out, ey_out;
  logic [RestW-1:0] rest_out;
  ring_line #(
      .Width(2 * IndexW + 2 * FracW),
      .Depth(ColorClocks)
  ) u_record_line (
      .clk_i,
      .rst_ni,
      .en_i(color_en),
      .d_i({index, ex, ey}),
      .q_o({index_out, ex_out, ey_out})
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
  ring_line #(
      .Width(RestW),
      .Depth(AlphaTestClocks)
  ) u_rest_end_line (
      .clk_i,
      .rst_ni,
      .en_i(color_en),
      .d_i(alpha_rest_o),
      .q_o(rest_out)
  );
  localparam int TexelsW = 3 * MixW + AlphaW;
  logic [TexelsW-1:0] texels_out;
  delay_line #(
      .Width(TexelsW),
      .Depth(ColorClocks - MixedAt)
  ) u_texel_line (
      .clk_i,
      .en_i(color_en),
      .d_i({mixed[0], mixed[1], mixed[2], mixed_a}),
      .q_o(texels_out)
  );
  logic hole_out;
  delay_line #(
      .Width(1),
      .Depth(ColorClocks - FilterAt)
  ) u_hole_line (
      .clk_i,
      .en_i(color_en),
      .d_i(hole_3),
      .q_o(hole_out)
  );
  // The alpha test: no division is left where the fragment leaves. Its code floor(255 a + 1/2) reaches k from
  // a = (2 k - 1) / 510 on; a's least raw value for the reference and for the next code are formed beside the products.
  // n / 255 is n's whole 255s, and behind the point the rest's byte for ever.
  localparam int CompareAlphaW = ((AlphaW > AlphaFrac + 1) ? AlphaW : AlphaFrac + 1) + 1;
  localparam int Digits = 8 * Copies;
  logic [2:0] alpha_func_1, alpha_func_2, alpha_func_3;
  logic [7:0] alpha_ref_1;
  logic ref_is_zero_2, ref_is_last_2, ref_is_last_3;
  logic signed [CompareAlphaW-1:0] alpha_least_q[2];
  always_ff @(posedge clk_i) begin
    if (color_en) begin
      alpha_func_1 <= alpha_func_i;
      alpha_func_2 <= alpha_func_1;
      alpha_func_3 <= alpha_func_2;
      alpha_ref_1 <= alpha_ref_i;
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
        if (color_en) alpha_least_q[k] <= ref_is_zero_2 ? -below_wide : least_2;
      end
    end else begin : gen_others
      always_ff @(posedge clk_i) begin
        if (color_en) alpha_least_q[k] <= least_2;
      end
    end
    always_ff @(posedge clk_i) begin
      if (color_en) begin
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

  localparam int RecordW = 2 * IndexW + 2 * FracW + TexelsW + 3 * ColorW + AlphaW + 1;
  skid #(
      .Width(RecordW + RestW)
  ) u_out_skid (
      .clk_i,
      .rst_ni,
      .in_valid_i(color_valid_q[ColorClocks-1]),
      .in_ready_o(color_en),
      .in_i({index_out, ex_out, ey_out, texels_out, color_q[0], color_q[1], color_q[2], alpha_q,
             hole_out || alpha_q == '0 || !alpha_passes, rest_out}),
      .out_valid_o,
      .out_ready_i,
      .out_o({out_i_o, out_j_o, out_ex_o, out_ey_o, out_texel_r_o, out_texel_g_o, out_texel_b_o, out_texel_a_o,
              out_r_o, out_g_o, out_b_o, out_a_o, out_killed_o, out_rest_o})
  );

  logic unused;
  assign unused = ^{queue_ready, held_valid};

`ifndef SYNTHESIS
  initial begin
    assert (bitspan_pixel_pkg::TextureAddressClocks == AddressClocks &&
            bitspan_pixel_pkg::TextureColorClocks == ColorClocks)
    else $fatal(1, "texture: has %0d and %0d clocks, told %0d and %0d", AddressClocks, ColorClocks,
                bitspan_pixel_pkg::TextureAddressClocks, bitspan_pixel_pkg::TextureColorClocks);
  end
  always @(posedge clk_i) begin
    if (in_taken && in_textured_i) begin
      assert (in_clamp_i || ((in_last_i_i & (in_last_i_i + 1'b1)) == '0 && (in_last_j_i & (in_last_j_i + 1'b1)) == '0))
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
