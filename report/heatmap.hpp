// SPDX-License-Identifier: Apache-2.0
// Heat maps: a scalar field as colours, with a bar that says what they mean.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace bitspan {

struct HeatMapOptions {
  std::string title;         // drawn beside the bar; printable ASCII
  bool logarithmic = false;  // values at or below the bar's low end, 0 included, take its low colour
  std::optional<double>
      low;  // of the bar; default 0, logarithmic: the smallest positive value, at least high / 1e6
  std::optional<double> high;  // default: the largest finite value
};

struct HeatMap {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

// viridis at t in 0..1, clamped.
std::array<std::uint8_t, 3> viridis(double t);

// The field pixel for pixel at the top left, height rows of width values; below it the bar. The picture is at
// least 240 pixels wide. NaN is neutral grey; infinities take the colour of the bar's end.
HeatMap draw_heat_map(int width, int height, std::span<const double> values, const HeatMapOptions& options);

// The same as a PNG file, whole or not at all.
void write_heat_map(const std::string& path, int width, int height, std::span<const double> values,
                    const HeatMapOptions& options);

}  // namespace bitspan
