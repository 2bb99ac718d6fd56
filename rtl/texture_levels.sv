// SPDX-License-Identifier: Apache-2.0
// The trilinear filter of docs/numeric-spec.md, "Levels" (T11): eight texels in, V out; one fragment per clock.
//
//   four texels of level      --> texture_filter --+
//                                                  +--> V (1 - f) + V_next f --> skid --> out
//   four texels of level + 1  --> texture_filter --+
//
// The two levels are filtered side by side, each with Ex and Ey of its own; `next` names what belongs to level + 1. With
// f = 0 V is that of the level, whatever stands at the inputs of the next one. With Ex = Ey = 0 the first texel of a level
// stands alone. The stage shifts as one on the ready of the skid at its end, which is a register.
//
// A texel's colour has red in the lowest byte; its alpha is Q[texture.alpha] of a / 255.
module texture_levels #(
    parameter int RestW = 32
) (
    input  logic clk_i,
    input  logic rst_ni,
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [23:0] in_color1_i,
    input  logic [23:0] in_color4_i,
    input  logic [23:0] in_color2_i,
    input  logic [23:0] in_color3_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_alpha1_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_alpha4_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_alpha2_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_alpha3_i,
    input  logic [bitspan_pixel_pkg::TextureFracW-1:0] in_ex_i,
    input  logic [bitspan_pixel_pkg::TextureFracW-1:0] in_ey_i,
    input  logic [23:0] in_next_color1_i,
    input  logic [23:0] in_next_color4_i,
    input  logic [23:0] in_next_color2_i,
    input  logic [23:0] in_next_color3_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_next_alpha1_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_next_alpha4_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_next_alpha2_i,
    input  logic [bitspan_pixel_pkg::TextureAlphaW-1:0] in_next_alpha3_i,
    input  logic [bitspan_pixel_pkg::TextureFracW-1:0] in_next_ex_i,
    input  logic [bitspan_pixel_pkg::TextureFracW-1:0] in_next_ey_i,
    input  logic [bitspan_pixel_pkg::LodFracW-1:0] in_f_i,
    input  logic [RestW-1:0] in_rest_i,
    output logic out_valid_o,
    input  logic out_ready_i,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_r_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_g_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] out_b_o,
    output logic [bitspan_pixel_pkg::TextureAlphaW-1:0] out_a_o,
    output logic [RestW-1:0] out_rest_o
);
  localparam int MixW = bitspan_pixel_pkg::TextureMixW;
  localparam int MixFrac = bitspan_pixel_pkg::TextureMixFrac;
  localparam int MixSigned = bitspan_pixel_pkg::TextureMixSigned;
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int AlphaFrac = bitspan_pixel_pkg::TextureAlphaFrac;
  localparam int AlphaSigned = bitspan_pixel_pkg::TextureAlphaSigned;
  localparam int FracW = bitspan_pixel_pkg::TextureFracW;
  localparam int ShareW = bitspan_pixel_pkg::LodFracW;
  localparam int FilterProductClocks = bitspan_pixel_pkg::TextureFilterProductClocks;
  localparam int LevelProductClocks = bitspan_pixel_pkg::TextureLevelProductClocks;
  localparam int BlendClocks = 3 + FilterProductClocks;
  localparam int LevelClocks = 3 + LevelProductClocks;
  localparam int FilteredAt = 2 * BlendClocks;
  localparam int Clocks = FilteredAt + LevelClocks;

  logic en;
  assign en = in_ready_o;

  // The lowest part of each vector is the level's, the one above it the next level's.
  logic [2*96-1:0] colors;
  logic [2*4*AlphaW-1:0] alphas;
  logic [2*FracW-1:0] ex, ey, ey_late;
  logic [ShareW-1:0] share;
  assign colors = {in_next_color3_i, in_next_color2_i, in_next_color4_i, in_next_color1_i,
                   in_color3_i, in_color2_i, in_color4_i, in_color1_i};
  assign alphas = {in_next_alpha3_i, in_next_alpha2_i, in_next_alpha4_i, in_next_alpha1_i,
                   in_alpha3_i, in_alpha2_i, in_alpha4_i, in_alpha1_i};
  assign ex = {in_next_ex_i, in_ex_i};
  assign ey = {in_next_ey_i, in_ey_i};
  ring_line #(
      .Width(2 * FracW),
      .Depth(BlendClocks)
  ) u_ey_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(ey),
      .q_o(ey_late)
  );
  ring_line #(
      .Width(ShareW),
      .Depth(FilteredAt)
  ) u_share_line (
      .clk_i,
      .rst_ni,
      .en_i(en),
      .d_i(in_f_i),
      .q_o(share)
  );

  logic [2*3*MixW-1:0] filtered;
  logic [2*AlphaW-1:0] filtered_a;
  for (genvar l = 0; l < 2; l++) begin : gen_level
    logic [FracW-1:0] level_ex, level_ey;
    assign level_ex = ex[l*FracW+:FracW];
    assign level_ey = ey_late[l*FracW+:FracW];
    for (genvar c = 0; c < 3; c++) begin : gen_color
      logic [7:0] v1, v4, v2, v3;
      logic [MixW-1:0] v;
      assign v1 = colors[l*96+8*c+:8];
      assign v4 = colors[l*96+24+8*c+:8];
      assign v2 = colors[l*96+48+8*c+:8];
      assign v3 = colors[l*96+72+8*c+:8];
      texture_filter #(
          .InW(8),
          .FracW(FracW),
          .OutW(MixW),
          .OutFrac(MixFrac),
          .OutSigned(MixSigned),
          .OutRnd(bitspan_pixel_pkg::TextureMixRnd),
          .OutOvf(bitspan_pixel_pkg::TextureMixOvf),
          .ProductClocks(FilterProductClocks),
          .BlendClocks(BlendClocks)
      ) u_filter (
          .clk_i,
          .en_i(en),
          .v1_i(v1),
          .v4_i(v4),
          .v2_i(v2),
          .v3_i(v3),
          .ex_i(level_ex),
          .ey_i(level_ey),
          .v_o(v)
      );
      assign filtered[(3*l+c)*MixW+:MixW] = v;
    end
    logic [AlphaW-1:0] a1, a4, a2, a3, a;
    assign a1 = alphas[(4*l)*AlphaW+:AlphaW];
    assign a4 = alphas[(4*l+1)*AlphaW+:AlphaW];
    assign a2 = alphas[(4*l+2)*AlphaW+:AlphaW];
    assign a3 = alphas[(4*l+3)*AlphaW+:AlphaW];
    texture_filter #(
        .InW(AlphaW),
        .InFrac(AlphaFrac),
        .InSigned(AlphaSigned),
        .FracW(FracW),
        .OutW(AlphaW),
        .OutFrac(AlphaFrac),
        .OutSigned(AlphaSigned),
        .OutRnd(bitspan_pixel_pkg::TextureAlphaRnd),
        .OutOvf(bitspan_pixel_pkg::TextureAlphaOvf),
        .ProductClocks(FilterProductClocks),
        .BlendClocks(BlendClocks)
    ) u_filter_a (
        .clk_i,
        .en_i(en),
        .v1_i(a1),
        .v4_i(a4),
        .v2_i(a2),
        .v3_i(a3),
        .ex_i(level_ex),
        .ey_i(level_ey),
        .v_o(a)
    );
    assign filtered_a[l*AlphaW+:AlphaW] = a;
  end

  logic [3*MixW-1:0] mixed;
  for (genvar c = 0; c < 3; c++) begin : gen_mix
    logic [MixW-1:0] level, next_level, v;
    assign level = filtered[c*MixW+:MixW];
    assign next_level = filtered[(3+c)*MixW+:MixW];
    blend #(
        .AW(MixW),
        .AFrac(MixFrac),
        .ASigned(MixSigned),
        .BW(MixW),
        .BFrac(MixFrac),
        .BSigned(MixSigned),
        .EW(ShareW),
        .EFrac(ShareW),
        .OutW(MixW),
        .OutFrac(MixFrac),
        .OutSigned(MixSigned),
        .OutRnd(bitspan_pixel_pkg::TextureMixRnd),
        .OutOvf(bitspan_pixel_pkg::TextureMixOvf),
        .ProductClocks(LevelProductClocks),
        .Clocks(LevelClocks)
    ) u_blend (
        .clk_i,
        .en_i(en),
        .a_i(level),
        .b_i(next_level),
        .e_i(share),
        .q_o(v)
    );
    assign mixed[(2-c)*MixW+:MixW] = v;
  end
  logic [AlphaW-1:0] mixed_a;
  blend #(
      .AW(AlphaW),
      .AFrac(AlphaFrac),
      .ASigned(AlphaSigned),
      .BW(AlphaW),
      .BFrac(AlphaFrac),
      .BSigned(AlphaSigned),
      .EW(ShareW),
      .EFrac(ShareW),
      .OutW(AlphaW),
      .OutFrac(AlphaFrac),
      .OutSigned(AlphaSigned),
      .OutRnd(bitspan_pixel_pkg::TextureAlphaRnd),
      .OutOvf(bitspan_pixel_pkg::TextureAlphaOvf),
      .ProductClocks(LevelProductClocks),
      .Clocks(LevelClocks)
  ) u_blend_a (
      .clk_i,
      .en_i(en),
      .a_i(filtered_a[0+:AlphaW]),
      .b_i(filtered_a[AlphaW+:AlphaW]),
      .e_i(share),
      .q_o(mixed_a)
  );

  shift_stage #(
      .Clocks(Clocks),
      .RestW(RestW),
      .Width(3 * MixW + AlphaW)
  ) u_stage (
      .clk_i,
      .rst_ni,
      .in_valid_i,
      .in_ready_o,
      .in_rest_i,
      .made_i({mixed, mixed_a}),
      .out_valid_o,
      .out_ready_i,
      .out_made_o({out_r_o, out_g_o, out_b_o, out_a_o}),
      .out_rest_o
  );

`ifndef SYNTHESIS
  initial begin
    assert (Clocks == bitspan_pixel_pkg::TextureLevelsClocks)
    else $fatal(1, "texture_levels: has %0d clocks, told %0d", Clocks, bitspan_pixel_pkg::TextureLevelsClocks);
  end
`endif
endmodule
