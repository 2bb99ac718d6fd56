// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_pixel_sv.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <initializer_list>
#include <span>
#include <utility>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {
namespace {

void formats(SvWriter& w, const Config& config,
             std::initializer_list<std::pair<const char*, FormatId>> named) {
  for (const auto& [name, id] : named) w.format(name, config.format(id));
}

// The numbers of an enumeration: StencilOpIncrementWrap of increment_wrap.
template <class E>
void numbers(SvWriter& w, const std::string& prefix) {
  for (std::size_t i = 0; i < enum_names<E>.size(); ++i) {
    std::string name = prefix;
    bool begins = true;
    for (const char c : enum_names<E>[i]) {
      if (c != '_') name += begins ? static_cast<char>(std::toupper(c)) : c;
      begins = c == '_';
    }
    w.integer(name, static_cast<std::int64_t>(i));
  }
}

// What several stages have: coordinates, R_pixel, the fragments in flight.
void common_section(SvWriter& w, const Config& config, const PixelTiming& timing) {
  w.integer("CoordW", pixel_index_bits(config));
  w.integer("ExponentW", exponent_bits);
  w.line("  // Fragments that a stage holds while a memory answers.");
  w.integer("FragmentsInFlight", timing.in_flight);
  w.line("  // Places of a scoreboard: 2^PlaceW.");
  w.integer("ScoreboardPlaceW", timing.place_bits);
  w.line("  // Draw states in flight: 2^DrawSlotW.");
  w.integer("DrawSlotW", timing.slot_bits);
  formats(w, config, {{"SetupB", FormatId::setup_b}, {"SpanH", FormatId::span_h}});
  const Grid operand = pixel_operand(config);
  w.line("");
  w.line("  // h + B as a signed number, and R_pixel of it.");
  w.integer("DepthSumW", as_signed(operand).bits());
  w.integer("DepthSumFrac", operand.fraction);
  w.reciprocal("PixelRecip", config.pixel_reciprocal, operand);
  w.integer("ProductClocks", config.rtl.product_clocks);
  w.integer("NormaliseClocks", config.rtl.normalise_clocks);
  w.integer("PixelUnitClocks", timing.pixel_unit);
}

void depth_section(SvWriter& w, const Config& config, const PixelTiming& timing, DepthWhen when) {
  w.line("");
  w.line("  // depth. With DepthIsLate it stands behind texture, and stencil behind it.");
  w.integer("DepthIsLate", is_late(when) ? 1 : 0);
  w.integer("DepthInverse", static_cast<int>(DepthCode::inverse));
  w.integer("DepthOpengl", static_cast<int>(DepthCode::opengl));
  w.integer("DepthLinear", static_cast<int>(DepthCode::linear));
  w.integer("DepthCode", static_cast<int>(config.depth_code));
  w.integer("DepthNearerIsLarger", nearer_is_larger(config.depth_code) ? 1 : 0);
  w.line("  // The code is of a line that comes with a fragment in the place of h.");
  w.integer("DepthHasLine", has_own_depth(config.depth_line) ? 1 : 0);
  w.format("DepthZ", config.depth_format());
  w.line("  // Of depth.bias: no bias beyond the largest code does more than that code.");
  w.integer("DepthBiasW", config.depth_bits + 1);
  formats(w, config, {{"DepthC1", FormatId::depth_c1}, {"DepthC0", FormatId::depth_c0}});
  w.integer("DepthProductClocks", timing.depth.product);
  w.integer("DepthCodeClocks", timing.depth.code);
}

void lod_section(SvWriter& w, const Config& config, const PixelTiming& timing) {
  w.line("");
  w.line("  // lod.");
  formats(w, config,
          {{"DistanceA", FormatId::distance_a},
           {"DistanceS", FormatId::distance_s},
           {"PlaneHGrad", FormatId::plane_h_grad},
           {"PlaneGGrad", FormatId::plane_g_grad},
           {"LodK", FormatId::lod_k},
           {"LodSlope", FormatId::lod_slope},
           {"LodLambda", FormatId::lod_lambda},
           {"LodFrac", FormatId::lod_frac}});
  w.integer("LodModeZone", static_cast<int>(LodMode::zone_s));
  w.integer("LodModeGradient", static_cast<int>(LodMode::gradient));
  w.integer("LodMode", static_cast<int>(config.lod));
  w.line("  // lod stands between depth and texture, which fetches levels.");
  w.integer("TextureHasLevels", has_levels_in_rtl(config) ? 1 : 0);
  w.integer("LodMixesLevels", mixes_levels(config.mip) ? 1 : 0);
  w.integer("LodLevelW", std::bit_width(static_cast<unsigned>(max_mip_level)));
  w.line("  // In sixteenths of a level, and the first start in 2^-16.");
  w.integer("LodBias", config.lod_bias);
  w.integer("LodFirst", config.lod_first);
  w.integer("LodDistanceProductClocks", timing.lod.distance_product);
  w.integer("LodZoneProductClocks", timing.lod.zone_product);
  w.integer("LodGradientProductClocks", timing.lod.gradient_product);
  w.integer("LodSlopeProductClocks", timing.lod.slope_product);
  w.integer("LodClocks", timing.lod.clocks);
}

void stencil_section(SvWriter& w, const PixelTiming& timing) {
  w.line("");
  w.line("  // stencil.");
  w.integer("StencilClocks", timing.stencil.clocks);
  numbers<StencilOp>(w, "StencilOp");
}

void texture_section(SvWriter& w, const Config& config, const PixelTiming& timing) {
  w.line("");
  w.line("  // texture. A texel's address counts texels.");
  formats(w, config,
          {{"SpanUv", FormatId::span_uv},
           {"SpanShade", shade_factor(config)},
           {"TextureFrac", FormatId::texture_frac},
           {"TextureMix", FormatId::texture_mix},
           {"TextureColor", FormatId::texture_color},
           {"TextureAlpha", FormatId::texture_alpha}});
  w.integer("TexelIndexW", texel_index_bits);
  w.integer("TexelPitchW", std::bit_width(static_cast<unsigned>(texel_index_bits)));
  w.integer("TexelAddressW", texel_address_bits);
  w.integer("TextureFilterProductClocks", timing.texture.filter_product);
  w.integer("TextureLevelProductClocks", timing.texture.level_product);
  w.integer("TextureLevelsClocks", timing.texture.levels);
  w.integer("TextureShadeProductClocks", timing.texture.shade_product);
  w.integer("TextureAddressClocks", timing.texture.address);
  w.integer("TextureColorClocks", timing.texture.color);
  w.line("  // Behind two levels.");
  w.integer("TextureShadeClocks", timing.texture.shade);
}

void fog_section(SvWriter& w, const Config& config, const PixelTiming& timing) {
  w.line("");
  w.line("  // fog. Without FogHasLinear there is no linear fog: its widths are not known to be legal.");
  formats(w, config,
          {{"FogScale", FormatId::fog_scale},
           {"FogFactor", FormatId::fog_factor},
           {"FogColor", FormatId::fog_color}});
  w.integer("FogModeNone", static_cast<int>(FogMode::none));
  w.integer("FogModeLinear", static_cast<int>(FogMode::linear));
  w.integer("FogModeTable", static_cast<int>(FogMode::table));
  w.integer("FogHasLinear", is_linear_in_distance(config.fog) ? 1 : 0);
  w.line("  // The factor comes with a fragment, under the mode's number of linear fog.");
  w.integer("FogIsGiven", has_vertex_fog(config.fog) ? 1 : 0);
  w.integer("FogDepthBits", config.fog_depth_bits);
  w.integer("FogZoneBits", config.fog_zone_bits);
  w.integer("FogIndexW", config.fog_index_bits());
  w.line("  // Bits of h below a step of depth; negative where a step is finer than h.");
  w.integer("FogStepShift",
            config.format(FormatId::span_h).fraction() + config.depth_bits - config.fog_depth_bits);
  w.line("  // What is loaded: entries of the table, and thresholds for the square of a distance.");
  w.integer("FogLoadW", std::max(config.format(FormatId::fog_factor).word, 2 * pixel_index_bits(config) + 1));
  w.integer("FogScaleProductClocks", timing.fog.scale_product);
  w.integer("FogBlendProductClocks", timing.fog.blend_product);
  w.integer("FogClocks", timing.fog.clocks);
}

void merge_section(SvWriter& w, const Config& config, const PixelTiming& timing) {
  w.line("");
  w.line("  // merge.");
  formats(w, config, {{"MergeColor", FormatId::merge_color}});
  w.line("  // Whether it has blend_unit, in place of the mix by alpha.");
  w.integer("MergeByEquation", has_blend_equation(config.rtl.blend) ? 1 : 0);
  w.integer("MergeProductClocks", timing.merge.product);
  w.integer("MergeClocks", timing.merge.clocks);
  w.integer("BlendProductClocks", timing.merge.any_product);
  w.integer("BlendClocks", timing.merge.any_blend);
  numbers<BlendFactor>(w, "BlendFactor");
  numbers<BlendOp>(w, "BlendOp");
}

}  // namespace

bool has_pixel_rtl(const Config& config) {
  const bool has_unit = config.pixel_reciprocal.pipelined && fits_operand(pixel_operand(config));
  return pixel_stages_are_in_rtl(config) && (has_unit || !pixel_stages_have_reciprocal(config));
}

bool mixes_by_alpha(const DrawState& s) {
  return s.blend_op == BlendOp::add && s.blend_src == BlendFactor::src_alpha &&
         s.blend_dst == BlendFactor::one_minus_src_alpha;
}

namespace {
// Whatever stood at the pixel, and whatever the fragment's alpha.
bool replaces_color(const DrawState& s) {
  return s.blend_op == BlendOp::add && s.blend_src == BlendFactor::one && s.blend_dst == BlendFactor::zero;
}
// The picture's alpha stays, and the colour is blended.
bool keeps_alpha(const DrawState& s) {
  return s.logic_op == LogicOp::none && s.blend_alpha_op == BlendOp::add &&
         s.blend_alpha_src == BlendFactor::zero && s.blend_alpha_dst == BlendFactor::one;
}
// Levels are chosen by constants of the RTL, and looked up by one filter.
bool takes_levels(const Config& config, const DrawState& s) {
  return !has_lod(config) || (s.texture_lod_bias == config.lod_bias && first_levels(s) == LevelRange{} &&
                              first_magnified(s) == first_lookup(s));
}
}  // namespace

bool pixel_rtl_takes(const Config& config, const DrawState& s) {
  return s.translucency_pass == TranslucencyPass::all && takes_levels(config, s) &&
         is_in_rtl(s.texture_filter) && is_in_rtl(s.texture_wrap_u) && is_in_rtl(s.texture_wrap_v) &&
         s.target_format == TargetFormat::rgba8888 && s.chroma_test == ChromaTest::none &&
         !has_second_texture(s) &&
         (has_blend_equation(config.rtl.blend) ||
          (keeps_alpha(s) && (mixes_by_alpha(s) || replaces_color(s))));
}

bool pixel_rtl_takes(const Config& config, std::span<const DrawCommand> commands) {
  return std::ranges::all_of(states_of(config, commands),
                             [&](const DrawState& state) { return pixel_rtl_takes(config, state); });
}

std::string emit_pixel_sv(const Config& config, DepthWhen when) {
  if (!is_in_rtl(config.depth_code)) {
    throw InputError(config.name + ": depth.code is " + std::string(to_string(config.depth_code)) +
                     ", which the RTL does not have; it needs inverse, linear or opengl");
  }
  const PixelTiming timing = pixel_timing(config);
  if (pixel_stages_have_reciprocal(config)) check_operand(pixel_operand(config), "reciprocal.pixel");
  SvWriter w;
  w.line("// Generated from configuration " + config_hash(config) + "; do not edit.");
  w.line("// Formats are named as in bitspan_cfg_pkg.");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_pixel_pkg;");
  common_section(w, config, timing);
  depth_section(w, config, timing, when);
  lod_section(w, config, timing);
  stencil_section(w, timing);
  texture_section(w, config, timing);
  fog_section(w, config, timing);
  merge_section(w, config, timing);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
