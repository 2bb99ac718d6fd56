// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_light_sv.hpp"

#include <algorithm>
#include <utility>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/reciprocal.hpp"
#include "config/rtl_timing.hpp"
#include "engine/sv_writer.hpp"

namespace bitspan {

std::string emit_light_sv(const Config& config) {
  using F = FormatId;
  if (!lights_pixels(config.light)) {
    throw InputError(config.name + ": light.at is " + std::string(to_string(config.light)) +
                     "; the RTL of light needs pixel");
  }
  const auto needs = [&](F id, bool is_held, const std::string& what) {
    if (is_held) return;
    throw InputError(config.name + ": formats." + std::string(key_of(id)) + ": the RTL of light needs " +
                     what);
  };
  for (const F id : {F::light_normal, F::light_direction, F::light_cosine}) {
    const Format& f = config.format(id);
    needs(id, f.is_signed && f.fraction() >= 1, "a sign and a place behind the point");
  }
  // Where nothing falls and there is no shadow, the factors are 1.
  if (has_light_fall(config)) {
    needs(F::light_fall, config.format(F::light_fall).fraction() >= 0, "the ones in front of the point");
  }
  if (has_light_shadow(config)) {
    const Format& share = config.format(F::texture_alpha);
    const Format& texel = config.format(F::texture_mix);
    needs(F::texture_alpha, share.fraction() >= 0, "the ones in front of the point");
    // rtl/over_255.sv
    needs(F::texture_mix,
          !texel.is_signed && texel.word + std::max(share.fraction() + 1 - texel.fraction(), 0) <= 56,
          "no sign, and at most 56 bits with those of texture.alpha behind them");
  }
  const LightTiming t = light_timing(config);
  SvWriter w;
  w.line("// Generated from configuration " + config_hash(config) + "; do not edit.");
  w.line("// Formats are named as in bitspan_cfg_pkg.");
  w.line("/* verilator lint_off UNUSED */");
  w.line("package bitspan_light_pkg;");
  for (const auto& [name, id] : {std::pair{"NormalValue", F::normal_value},
                                 {"DistanceS", F::distance_s},
                                 {"LightScale", F::light_scale},
                                 {"LightPosition", F::light_position},
                                 {"LightRoot", F::light_root},
                                 {"LightNormal", F::light_normal},
                                 {"LightDirection", F::light_direction},
                                 {"LightCosine", F::light_cosine},
                                 {"LightSpecular", F::light_specular},
                                 {"LightInverse", F::light_inverse},
                                 {"LightLunar", F::light_lunar},
                                 {"LightDistance", F::light_distance},
                                 {"LightFall", F::light_fall},
                                 {"LightValue", F::light_value},
                                 {"ReliefValue", F::relief_value},
                                 {"SpanUv", F::span_uv},
                                 {"TextureMix", F::texture_mix},
                                 {"TextureAlpha", F::texture_alpha},
                                 {"TextureColor", F::texture_color}}) {
    w.format(name, config.format(id));
  }
  w.line("  // Lights may stand at points.");
  w.integer("LightHasPoint", has_light_points(config) ? 1 : 0);
  w.line("  // A map of normals, the lunar law, a shadow map, a fall with the distance.");
  w.integer("LightHasRelief", has_relief(config) ? 1 : 0);
  w.integer("LightHasLunar", has_lunar(config) ? 1 : 0);
  w.integer("LightHasShadow", has_light_shadow(config) ? 1 : 0);
  w.integer("LightHasFall", has_light_fall(config) ? 1 : 0);
  w.integer("LightFallsBySquare", falls_by_square(config.light_fall) ? 1 : 0);
  w.integer("LightFallsToViewer", falls_to_viewer(config.light_fall_to) ? 1 : 0);
  w.integer("LightIndexBits", config.light_index_bits);
  w.integer("CoordW", pixel_index_bits(config));
  w.integer("ExponentW", exponent_bits);
  w.integer("ScaleExponentW", 6);
  w.integer("ScaleExponentMin", light_scale_exponent_min);
  w.integer("ScaleExponentMax", light_scale_exponent_max);
  w.integer("ReachExponentMin", light_reach_exponent_min);
  w.integer("ReachExponentMax", light_reach_exponent_max);
  w.integer("NormaliseClocks", config.rtl.normalise_clocks);
  w.line("");
  w.root("Root", config.light_root);
  w.integer("LightProductClocks", t.product);
  w.integer("LightRootClocks", t.root);
  w.integer("LightVectorClocks", t.vector);
  w.integer("LightClocks", t.clocks);
  w.line("endpackage");
  w.line("/* verilator lint_on UNUSED */");
  return w.text;
}

}  // namespace bitspan
