// SPDX-License-Identifier: Apache-2.0
// Configurations for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {

// The configurations config/NAME.toml of the source tree.
inline const std::array<std::string, 3> shipped_names{"depth16", "depth20", "narrow"};
inline Config shipped_config(const std::string& name) {
  return load_config(source_path("config/") + name + ".toml");
}
inline std::vector<Config> shipped_configs() {
  std::vector<Config> out;
  for (const std::string& name : shipped_names) out.push_back(shipped_config(name));
  return out;
}

inline constexpr std::array all_perspectives{Perspective::delta_f, Perspective::const_depth_rows,
                                             Perspective::hyperbolic, Perspective::affine};

// Wide registers that keep the small numbers of a worked example exact: 28 integer and 20 fraction bits,
// signed, SC_RND, SC_SAT, unless the value wants another shape. Slopes are exact quotients, no start offset;
// delta_f, nearest, no fog, 16-bit inverse depth.
inline Config plain_config() {
  Config c;
  c.name = "plain";
  c.formats.fill({48, 28, true, Rounding::rnd, Overflow::sat, false});
  const auto is_unsigned = [&](FormatId id, int word, int integer) {
    c.format(id) = {word, integer, false, Rounding::rnd, Overflow::sat, false};
  };
  is_unsigned(FormatId::setup_s, 40, 1);
  c.format(FormatId::depth_c1) = {62, 42, true, Rounding::rnd, Overflow::sat, false};  // about hmax^2
  c.format(FormatId::plane_k) = {22, 2, true, Rounding::rnd, Overflow::sat, false};
  c.format(FormatId::texture_frac) = {8, 0, false, Rounding::trn, Overflow::sat, false};
  is_unsigned(FormatId::lod_frac, 8, 0);
  is_unsigned(FormatId::distance_g, 16, 2);
  is_unsigned(FormatId::texture_mix, 12, 8);
  is_unsigned(FormatId::texture_color, 12, 8);
  is_unsigned(FormatId::texture_alpha, 11, 1);
  is_unsigned(FormatId::fog_factor, 11, 1);
  is_unsigned(FormatId::fog_color, 12, 8);
  is_unsigned(FormatId::merge_color, 8, 8);
  c.row_slope = RowSlope::divide;
  c.fog = FogMode::none;
  Reciprocal exact;  // 1 / n to 30 bits
  exact.output = {31, 1, false, Rounding::rnd, Overflow::sat, false};
  c.edge_reciprocal = c.row_reciprocal = c.pixel_reciprocal = exact;
  return c;
}

// A raw value of a format, and a value as the nearest raw value.
inline double decoded(std::int64_t raw, const Format& f) {
  return std::ldexp(static_cast<double>(raw), -f.fraction());
}
inline std::int64_t encoded(double value, const Format& f) {
  return std::llround(std::ldexp(value, f.fraction()));
}

}  // namespace bitspan
