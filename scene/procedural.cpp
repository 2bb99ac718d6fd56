// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace bitspan {
namespace {

constexpr int colors = 8;  // values of the table in front of the others
constexpr int seed_limit = 32767;
constexpr int side_limit = 16384;  // texels, as of a texture
constexpr auto checker_values =
    std::to_array<ProceduralValue>({{"cell_width", 1, side_limit}, {"cell_height", 1, side_limit}});
constexpr auto brick_values = std::to_array<ProceduralValue>({{"brick_width", 1, side_limit},
                                                              {"brick_height", 1, side_limit},
                                                              {"mortar", 0, side_limit},
                                                              {"shift", 0, side_limit},
                                                              {"vary", 0, 255},
                                                              {"seed", 0, seed_limit}});
constexpr auto noise_values =
    std::to_array<ProceduralValue>({{"log2_cell", 0, 14}, {"octaves", 1, 15}, {"seed", 0, seed_limit}});
static_assert(colors + checker_values.size() == checker_table_size);
static_assert(colors + brick_values.size() == brick_table_size);
static_assert(colors + noise_values.size() == noise_table_size);

}  // namespace

std::span<const ProceduralValue> procedural_values(TexelFormat format) {
  if (format == TexelFormat::checker) return checker_values;
  if (format == TexelFormat::brick) return brick_values;
  if (format == TexelFormat::noise) return noise_values;
  return {};
}

std::string procedural_fault(const Texture& t) {
  const auto out_of_range = [](std::string_view key, int value, int low, int high) {
    return fmt::format("{}: {} is out of range; expected {}..{}", key, value, low, high);
  };
  for (std::size_t c = 0; c < colors; ++c) {
    if (t.table[c] < 0 || t.table[c] > 255) return out_of_range("colors", t.table[c], 0, 255);
  }
  const auto values = procedural_values(t.format);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const int value = t.table[colors + k];
    if (value < values[k].low || value > values[k].high)
      return out_of_range(values[k].key, value, values[k].low, values[k].high);
  }
  // The shortest period of an octave is one texel.
  if (t.format == TexelFormat::noise && t.table[noise_octaves] > t.table[noise_cell] + 1)
    return out_of_range("octaves", t.table[noise_octaves], 1, t.table[noise_cell] + 1);
  return "";
}

Texture random_procedural(Random& random, TexelFormat format, int width, int height) {
  Texture out;
  out.name = to_string(format);
  out.width = width;
  out.height = height;
  out.format = format;
  const auto draw = [&](std::int64_t low, std::int64_t high) {
    out.table.push_back(static_cast<std::int16_t>(random.integer(low, high)));
  };
  for (int c = 0; c < colors; ++c) draw(0, 255);
  const int side = std::max(width, height);
  for (const ProceduralValue& v : procedural_values(format)) {
    if (v.key == "octaves") {
      draw(v.low, out.table[noise_cell] + 1);
    } else if (v.high == side_limit && v.key != "mortar") {
      // Small ones are seen more than once in the texture.
      out.table.push_back(static_cast<std::int16_t>(random.log_uniform(1, side + 1)));
    } else {
      draw(v.low, v.key == "mortar" ? 2 : v.high);
    }
  }
  return out;
}

}  // namespace bitspan
