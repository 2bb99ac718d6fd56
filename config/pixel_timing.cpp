// SPDX-License-Identifier: Apache-2.0
#include "config/pixel_timing.hpp"

#include <algorithm>
#include <bit>

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {
namespace {

DepthTiming depth_timing(const Config& config, int pixel_unit) {
  DepthTiming t;
  t.product = product_clocks(signed_bits(config.format(FormatId::depth_c1)),
                             signed_bits(config.pixel_reciprocal.output));
  switch (config.depth_code) {
    case DepthCode::inverse:
      t.code = 1;  // Q
      break;
    case DepthCode::opengl:
      t.code = 2;  // zmax - h, Q
      break;
    case DepthCode::linear:
      t.code = 1 + pixel_unit + multiply_round_clocks(t.product);  // h + B, R_pixel in front
      break;
    case DepthCode::w_float:   // h + B, its highest bit, the shift, Q
    case DepthCode::float_dz:  // zmax - h, Q, the exponent, the shift
      t.code = 4;
      break;
  }
  // The scoreboard; z and its FIFO, or request, memory and answer; join, compare, out.
  t.total = 4 + std::max(t.code + 1, 3) + 3;
  return t;
}

LodTiming lod_timing(const Config& config, int pixel_unit) {
  using F = FormatId;
  const auto grid = [&](F id) { return grid_of(config.format(id)); };
  const int mantissa = signed_bits(config.pixel_reciprocal.output);
  const Grid into = as_signed(grid(F::distance_s)) - zone_starts();
  // One place more than a sum needs, as in the RTL.
  const Grid product = as_signed(grid(F::span_uv)) * as_signed(grid(F::plane_h_grad));
  const Grid numerator = as_signed(grid(F::plane_g_grad)) - product;
  LodTiming t;
  t.distance_product = product_clocks(signed_bits(config.format(F::distance_a)), mantissa);
  t.zone_product = product_clocks(into.bits(), signed_bits(config.format(F::lod_k)));
  t.gradient_product =
      product_clocks(signed_bits(config.format(F::span_uv)), signed_bits(config.format(F::plane_h_grad)));
  t.slope_product = product_clocks(numerator.bits(), mantissa);
  const int inverse = 1 + pixel_unit;
  int sum = 0;
  switch (config.lod) {
    case LodMode::none:
    case LodMode::zone_d:  // rtl/lod.sv does not have these two
    case LodMode::finite:
      break;
    case LodMode::zone_s:
      // s; what it reaches, the zone, its start, s - S_z; the product, Q; the sum.
      sum = inverse + multiply_round_clocks(t.distance_product) + 4 + t.zone_product + 1 + 1;
      break;
    case LodMode::gradient:
      // The slopes; their sizes, the larger ones, the largest; the logarithm; the sum.
      sum = std::max(t.gradient_product + 1, inverse) + multiply_round_clocks(t.slope_product) + 3 +
            config.rtl.normalise_clocks + 1;
      break;
  }
  // Lambda; held; level and f.
  t.clocks = sum + 3;
  t.total = t.clocks + 1;
  return t;
}

// Clocks of the product in rtl/blend.sv, which forms a + (b - a) e.
int blend_product(Grid a, Grid b, const Format& e) { return product_clocks((b - a).bits(), signed_bits(e)); }

TextureTiming texture_timing(const Config& config) {
  using F = FormatId;
  const Format& frac = config.format(F::texture_frac);
  const Grid mix = grid_of(config.format(F::texture_mix));
  const Grid alpha = grid_of(config.format(F::texture_alpha));
  const int shade = signed_bits(config.format(shade_factor(config)));
  TextureTiming t;
  t.filter_product = std::max(blend_product(mix, mix, frac), blend_product(alpha, alpha, frac));
  const Format& share = config.format(F::lod_frac);
  t.level_product = std::max(blend_product(mix, mix, share), blend_product(alpha, alpha, share));
  t.levels = 2 * (3 + t.filter_product) + 3 + t.level_product;
  t.shade_product =
      std::max(product_clocks(as_signed(mix).bits(), shade), product_clocks(as_signed(alpha).bits(), shade));
  const bool has_levels = has_levels_in_rtl(config);
  // Two shifts by the level; u - 1/2, whole and fraction, wrapping, two shifts by the pitch, plus the base.
  t.address = (has_levels ? 2 : 0) + 6;
  // Words, reserved texels, their replacement; the filter of two levels, or two blends; factors, product, Q.
  const int shade_clocks = 1 + t.shade_product + 1;
  const bool mixes = has_levels && mixes_levels(config.mip);
  t.color = 3 + (mixes ? t.levels : 2 * (3 + t.filter_product) + shade_clocks);
  t.shade = mixes ? shade_clocks : 0;
  // The skids of requests and answers, and those behind the segments.
  t.total = t.address + 1 + 1 + 1 + t.color + 1 + (mixes ? t.shade + 1 : 0);
  return t;
}

FogTiming fog_timing(const Config& config, int pixel_unit) {
  using F = FormatId;
  const Format& factor = config.format(F::fog_factor);
  FogTiming t;
  // Minus fog_scale is a factor.
  t.scale_product =
      product_clocks(config.format(F::fog_scale).word + 1, signed_bits(config.pixel_reciprocal.output));
  t.blend_product = blend_product(Grid{8, 0, false}, grid_of(config.format(F::texture_color)), factor);
  // Distances from the middle and their sizes, the squares' sums, r^2, one clock per bit of the zone, the
  // table.
  const int square = static_cast<int>(std::bit_width(static_cast<unsigned>(pixel_index_bits(config) - 1)));
  int entry = 2 + square + 1 + config.fog_zone_bits + 1;
  // h + B and R_pixel in front.
  if (is_linear_in_distance(config.fog))
    entry = std::max(entry, 1 + pixel_unit + multiply_round_clocks(t.scale_product));
  // The choice of the factor; difference, product, sum, Q.
  t.clocks = entry + 1 + 3 + t.blend_product;
  t.total = t.clocks + 1;
  return t;
}

MergeTiming merge_timing(const Config& config) {
  MergeTiming t;
  t.product =
      blend_product(grid_of(config.format(FormatId::merge_color)),
                    grid_of(config.format(FormatId::fog_color)), config.format(FormatId::texture_alpha));
  const Grid code{8, 0, true};
  const Grid factor = Grid{1, 8, true} - aligned(grid_of(config.format(FormatId::texture_alpha)), 0);
  const Grid color = as_signed(aligned(grid_of(config.format(FormatId::fog_color)), 0));
  t.any_product = product_clocks(std::max(color.bits(), code.bits()), factor.bits());
  // Operands, factors; the products; operation, Q.
  t.any_blend = 2 + t.any_product + 2;
  // Join; difference, product, sum, Q; or the unit.
  t.clocks = 1 + (has_blend_equation(config.rtl.blend) ? t.any_blend : t.product + 3);
  // The scoreboard, FIFO; join and blend, out.
  t.total = 4 + 1 + t.clocks + 1;
  // Request, memory and answer instead of the FIFO.
  t.total_blending = t.total + 2;
  return t;
}

void check_pipelined(const Config& config) {
  if (config.pixel_reciprocal.pipelined) return;
  throw InputError(config.name +
                   ": reciprocal.pixel.pipelined is false; the RTL makes one pixel per clock and needs true");
}

}  // namespace

int signed_bits(const Format& f) { return signed_grid(f).bits(); }

int product_clocks(int a_bits, int b_bits) { return a_bits <= 18 && b_bits <= 18 ? 1 : 3; }

bool pixel_stages_have_reciprocal(const Config& config) {
  return is_linear_in_distance(config.depth_code) || is_linear_in_distance(config.fog) ||
         (has_levels_in_rtl(config) && takes_pixel_reciprocal(config.lod));
}

PixelTiming pixel_timing(const Config& config) {
  if (pixel_stages_have_reciprocal(config)) check_pipelined(config);
  PixelTiming t;
  // The memory's latency, and the clocks to and from it.
  t.in_flight =
      static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(config.memory.latency + 8, 16, 64))));
  t.has_lod = has_levels_in_rtl(config);
  // A draw state per triangle, and triangles may have few fragments.
  if (t.has_lod && has_gradients(config.lod)) t.slot_bits = 4;
  t.pixel_unit = reciprocal_latency(config.pixel_reciprocal, pixel_operand(config), config.rtl);
  t.depth = depth_timing(config, t.pixel_unit);
  t.lod = lod_timing(config, t.pixel_unit);
  t.texture = texture_timing(config);
  t.fog = fog_timing(config, t.pixel_unit);
  t.merge = merge_timing(config);
  return t;
}

Grid project_operand(const Config& config) {
  return positive(signed_grid(config.format(FormatId::project_value)));
}

ProjectTiming project_timing(const Config& config) {
  check_pipelined(config);
  const int mantissa = signed_bits(config.pixel_reciprocal.output);
  const auto bits = [&](FormatId id) { return signed_bits(config.format(id)); };
  ProjectTiming t;
  t.unit = reciprocal_latency(config.pixel_reciprocal, project_operand(config), config.rtl);
  t.place_product = product_clocks(bits(FormatId::project_value), mantissa);
  t.ratio_product = product_clocks(as_signed(pixel_operand(config)).bits(), mantissa);
  t.code_product = product_clocks(bits(FormatId::distance_a), bits(FormatId::project_ratio));
  // The operand and R_project; s and t, and whether they lie inside; or ratio, h_p and its code.
  const int inverse = 1 + t.unit;
  const int place = inverse + multiply_round_clocks(t.place_product) + 1;
  const int code = inverse + multiply_round_clocks(t.ratio_product) + multiply_round_clocks(t.code_product) +
                   (is_complement_of_h(config.depth_code) ? 2 : 1);
  t.clocks = std::max(place, code);
  t.total = t.clocks + 1;
  return t;
}

LightTiming light_timing(const Config& config) {
  LightTiming t;
  const int rounded = multiply_round_clocks(t.product);
  t.root = config.rtl.normalise_clocks + 2 + config.light_root.steps * (3 * t.product + 1);
  t.vector = t.product + 2 + t.root + rounded;
  // The place, and its difference to the light's; or a choice of normals.
  const int place = 1 + t.product + rounded;
  const int join = (has_light_points(config) ? place + 1 : has_relief(config) ? 1 : 0) + t.vector;
  // The cosine; the mirrored one; the table's two entries and what lies between.
  const int specular = join + t.product + 2 + rounded + 4 + rounded + 1;
  // A division: its operand, the root, its square, the quotient. The cosine above 0, and so divided; both
  // parts of V.
  const int inverse = 1 + t.root + rounded;
  const int lit = join + t.product + 2 + 2;
  const int scattered = lit + (has_lunar(config) ? 1 + inverse + rounded : 0);
  const int near = std::max(specular, scattered + t.product + 1) + rounded;
  const int shaded = near + (has_light_shadow(config) ? rounded : 0);
  // The length, the reach, the divisor, the quotient of 1.
  const int away = place + (falls_to_viewer(config.light_fall_to) ? 0 : 1) + t.vector;
  const int divisor = falls_by_square(config.light_fall) ? rounded : 1;
  const int fall = away + t.product + 2 + rounded + divisor + inverse + multiply_round_clocks(1);
  const int value = has_light_fall(config)     ? std::max(shaded, fall) + rounded
                    : has_light_shadow(config) ? shaded + 1
                                               : near;
  t.clocks = value + rounded;
  t.total = t.clocks + 1;
  return t;
}

}  // namespace bitspan
