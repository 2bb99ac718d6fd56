// SPDX-License-Identifier: Apache-2.0
#include "engine/emit_light_sv.hpp"

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
  if (has_lunar(config) || has_light_fall(config) || has_relief(config) || has_light_shadow(config)) {
    throw InputError(
        config.name +
        ": light.law, light.fall, light.normal or light.shadow: the RTL of light has lambert, none, "
        "channel and none");
  }
  for (const F id : {F::light_normal, F::light_direction, F::light_cosine}) {
    const Format& f = config.format(id);
    if (f.is_signed && f.fraction() >= 1) continue;
    throw InputError(config.name + ": formats." + std::string(key_of(id)) +
                     ": the RTL of light needs a sign and a place behind the point");
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
                                 {"LightValue", F::light_value},
                                 {"TextureColor", F::texture_color}}) {
    w.format(name, config.format(id));
  }
  w.line("  // Lights may stand at points.");
  w.integer("LightHasPoint", has_light_points(config) ? 1 : 0);
  w.integer("LightIndexBits", config.light_index_bits);
  w.integer("CoordW", pixel_index_bits(config));
  w.integer("ExponentW", exponent_bits);
  w.integer("ScaleExponentW", 6);
  w.integer("ScaleExponentMin", light_scale_exponent_min);
  w.integer("ScaleExponentMax", light_scale_exponent_max);
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
