// SPDX-License-Identifier: Apache-2.0
// Clocks and internal widths of the pixel stages in RTL, as a pure function of the configuration: depth, lod,
// texture, fog and merge. engine/emit_pixel_sv writes them into the package; the RTL asserts that its
// structure has them.
#pragma once

#include "config/config.hpp"
#include "config/grid.hpp"

namespace bitspan {

// Bits of a factor of a format, with the sign that an unsigned one does not have.
int signed_bits(const Format& f);
// Clocks of rtl/mul_pipe.sv for factors of these widths, signs included: 1 where one multiplier of 18 x 18
// bits makes the product, else 3.
int product_clocks(int a_bits, int b_bits);

struct DepthTiming {
  int product = 1;  // of c1 m
  int code = 1;     // from a fragment's h to its z
  int total =
      0;  // acceptance to out_valid_o where the answer comes on the clock after the request's acceptance
};
// rtl/stencil.sv, behind depth where the tests are late.
struct StencilTiming {
  int clocks = 2;  // from acceptance to the skid at the output: the comparison, the operation
  int total = 3;   // acceptance to out_valid_o
};
// Two segments with a skid behind each, and the texels' way in between. Where two levels are mixed, the
// product with the fragment's colour is a third segment.
struct TextureTiming {
  int filter_product = 1;  // of a blend of two texels
  int level_product = 1;   // of a blend of two levels
  int levels = 0;          // rtl/texture_levels.sv: from the texels of two levels to the skid at its output
  int shade_product = 1;   // of the mixed texel and the fragment's colour
  int address = 0;         // from acceptance to the skid in front of the requests
  int color = 0;           // from the texels to the skid at the output, or to that behind two levels
  int shade = 0;           // from there to the skid at the output; 0 where no levels are mixed
  int total = 0;           // acceptance to out_valid_o where the texels come on the clock after their request
};
struct FogTiming {
  int scale_product = 1;  // of fog_scale m
  int blend_product = 1;  // of the mix with the fog's colour
  int clocks = 0;         // from acceptance to the skid at the output
  int total = 0;          // acceptance to out_valid_o
};
struct MergeTiming {
  int product = 1;         // of the mix by alpha: rtl.blend = alpha
  int any_product = 1;     // rtl/blend_unit.sv: of a colour or alpha and its factor
  int any_blend = 0;       // rtl/blend_unit.sv: from acceptance to the skid at its output
  int clocks = 0;          // from the join with the stored colour to the skid at the output
  int total = 0;           // acceptance to write_valid_o without a read
  int total_blending = 0;  // with one, answered on the clock after its acceptance
};
// rtl/lod.sv, which takes R_pixel only in the modes zone_s and gradient.
struct LodTiming {
  int distance_product = 1;  // zone_s: of A' and m
  int zone_product = 1;      // zone_s: of s - S_z and k_z
  int gradient_product = 1;  // gradient: of u and h_x
  int slope_product = 1;     // gradient: of gu_x - u h_x and m
  int clocks = 0;            // from acceptance to the skid at the output
  int total = 0;             // acceptance to out_valid_o
};
// rtl/project.sv.
struct ProjectTiming {
  int unit = 0;           // latency of R_project
  int place_product = 1;  // of X and m
  int ratio_product = 1;  // of h + B and m
  int code_product = 1;   // of A_p and ratio
  int clocks = 0;         // from acceptance to the skid at the output
  int total = 0;          // acceptance to out_valid_o
};
// rtl/light.sv. Its multipliers lie all over a device, and each product has clocks for the ways to them and
// back.
struct LightTiming {
  int product = 5;  // of every product: rtl/mul_pipe.sv with registers on both sides of its multipliers
  int root = 0;     // latency of rtl/root.sv
  int vector = 0;   // of rtl/unit_vector.sv
  int clocks = 0;   // from acceptance to the skid at the output
  int total = 0;    // acceptance to out_valid_o
};
struct PixelTiming {
  int in_flight = 0;     // fragments that a stage holds while a memory answers
  int place_bits = 10;   // a scoreboard has 2^place_bits places: many times the fragments in flight
  int slot_bits = 2;     // draw states in flight: 2^slot_bits; more where each triangle has its own
  bool has_lod = false;  // lod stands between depth and texture
  int pixel_unit = 0;    // latency of R_pixel
  DepthTiming depth;
  StencilTiming stencil;
  LodTiming lod;
  TextureTiming texture;
  FogTiming fog;
  MergeTiming merge;
};

// The distances at which the zones of a mip chain begin, S_i = lod.first 2^(i-16), as signed numbers.
constexpr Grid zone_starts() { return {max_mip_level + 2, 16, true}; }

// Whether a stage behind span takes R_pixel in RTL: the linear depth code, linear fog, lod.
bool pixel_stages_have_reciprocal(const Config& config);

// Throws InputError where a stage takes an R_pixel that is not pipelined.
PixelTiming pixel_timing(const Config& config);

// W, as a positive number.
Grid project_operand(const Config& config);
// Throws InputError where R_pixel, whose keys R_project has, is not pipelined.
ProjectTiming project_timing(const Config& config);
// Of a configuration whose light is per pixel.
LightTiming light_timing(const Config& config);

}  // namespace bitspan
