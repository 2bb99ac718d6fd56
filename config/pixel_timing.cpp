// SPDX-License-Identifier: Apache-2.0
#include "config/pixel_timing.hpp"

#include <algorithm>
#include <bit>

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {
namespace {

// With the sign that an unsigned factor does not have.
int signed_bits(const Format& f) { return signed_grid(f).bits(); }

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
      t.code = 1 + pixel_unit + t.product + 3 + 1;  // h + B, R_pixel, the product, shifts and sum, Q
      break;
  }
  // The scoreboard; z and its FIFO, or request, memory and answer; join, compare, out.
  t.total = 2 + std::max(t.code + 1, 3) + 3;
  return t;
}

// Of rtl/blend.sv: a + (b - a) e.
int blend_product(Grid a, Grid b, const Format& e) { return product_clocks((b - a).bits(), signed_bits(e)); }

MergeTiming merge_timing(const Config& config) {
  MergeTiming t;
  t.product =
      blend_product(grid_of(config.format(FormatId::merge_color)),
                    grid_of(config.format(FormatId::fog_color)), config.format(FormatId::texture_alpha));
  // The scoreboard, FIFO; join, blend, out.
  t.total = 2 + 1 + 1 + (t.product + 3) + 1;
  // Request, memory and answer instead of the FIFO.
  t.total_blending = t.total + 2;
  return t;
}

}  // namespace

int product_clocks(int a_bits, int b_bits) { return a_bits <= 18 && b_bits <= 18 ? 1 : 3; }

bool pixel_stages_have_reciprocal(const Config& config) {
  return is_linear_in_distance(config.depth_code) || is_linear_in_distance(config.fog);
}

PixelTiming pixel_timing(const Config& config) {
  if (pixel_stages_have_reciprocal(config) && !config.pixel_reciprocal.pipelined) {
    throw InputError(
        config.name +
        ": reciprocal.pixel.pipelined is false; the RTL makes one pixel per clock and needs true");
  }
  PixelTiming t;
  // The memory's latency, and the clocks to and from it.
  t.in_flight =
      static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(config.memory.latency + 8, 16, 64))));
  t.pixel_unit = reciprocal_latency(config.pixel_reciprocal, pixel_operand(config));
  t.depth = depth_timing(config, t.pixel_unit);
  t.merge = merge_timing(config);
  return t;
}

}  // namespace bitspan
