// SPDX-License-Identifier: Apache-2.0
// Fields of numbers as pictures.
#include "report/heatmap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "io/png.hpp"
#include "scene/texture.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

std::array<std::uint8_t, 3> pixel(const HeatMap& map, int x, int y) {
  const std::size_t at = 3 * static_cast<std::size_t>(y * map.width + x);
  return {map.rgb[at], map.rgb[at + 1], map.rgb[at + 2]};
}

TEST(HeatMap, ColoursRunFromDarkToLight) {
  EXPECT_EQ(viridis(0), (std::array<std::uint8_t, 3>{68, 1, 84}));
  EXPECT_EQ(viridis(1), (std::array<std::uint8_t, 3>{253, 231, 37}));
  EXPECT_EQ(viridis(-3), viridis(0));
  EXPECT_EQ(viridis(7), viridis(1));
  double before = 0;
  for (int i = 0; i <= 100; ++i) {
    const auto c = viridis(i / 100.0);
    const double light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    EXPECT_GT(light, before) << i;
    before = light;
  }
}

TEST(HeatMap, FieldStandsPixelForPixel) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<double> values{0, 5, 10, std::nan(""), inf, -inf};
  const HeatMap map =
      draw_heat_map(3, 2, values, {.title = "t", .logarithmic = false, .low = {}, .high = {}});
  EXPECT_EQ(map.rgb.size(), static_cast<std::size_t>(map.width * map.height * 3));
  EXPECT_EQ(pixel(map, 0, 0), viridis(0));
  EXPECT_EQ(pixel(map, 1, 0), viridis(0.5));
  EXPECT_EQ(pixel(map, 2, 0), viridis(1));
  EXPECT_EQ(pixel(map, 0, 1), (std::array<std::uint8_t, 3>{128, 128, 128}));
  EXPECT_EQ(pixel(map, 1, 1), viridis(1));
  EXPECT_EQ(pixel(map, 2, 1), viridis(0));
}

TEST(HeatMap, LogarithmicScaleAndZeros) {
  const std::vector<double> values{0, 0.001, 0.1, 10};
  const HeatMap map = draw_heat_map(4, 1, values, {.title = "", .logarithmic = true, .low = {}, .high = {}});
  EXPECT_EQ(pixel(map, 0, 0), viridis(0));
  EXPECT_EQ(pixel(map, 1, 0), viridis(0));
  EXPECT_EQ(pixel(map, 2, 0), viridis(0.5));
  EXPECT_EQ(pixel(map, 3, 0), viridis(1));
}

TEST(HeatMap, BarHasColoursAndNumbers) {
  const HeatMap map = draw_heat_map(300, 10, std::vector<double>(3000, 1),
                                    {.title = "u", .logarithmic = false, .low = 0, .high = 8});
  std::set<std::array<std::uint8_t, 3>> colors;
  int ink = 0;
  for (int y = 10; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      colors.insert(pixel(map, x, y));
      ink += pixel(map, x, y) == std::array<std::uint8_t, 3>{32, 32, 32};
    }
  }
  EXPECT_GT(colors.size(), 150U);
  EXPECT_GT(ink, 60);
  // The numbers say the range.
  const HeatMap other = draw_heat_map(300, 10, std::vector<double>(3000, 1),
                                      {.title = "u", .logarithmic = false, .low = 0, .high = 9});
  EXPECT_NE(map.rgb, other.rgb);
}

TEST(HeatMap, EmptyAndConstantFields) {
  for (const double value : {0.0, std::nan(""), -3.0, 5.0}) {
    for (const bool logarithmic : {false, true}) {
      EXPECT_NO_THROW(draw_heat_map(2, 2, std::vector<double>(4, value),
                                    {.title = "", .logarithmic = logarithmic, .low = {}, .high = {}}));
    }
  }
  EXPECT_THROW(draw_heat_map(2, 3, std::vector<double>(4), {}), std::invalid_argument);
  const TemporaryFolder folder;
  write_heat_map(folder.path("h.png"), 2, 2, std::vector<double>(4, 1), {});
  EXPECT_EQ(read_texture(folder.path("h.png")).width, 240);
}

}  // namespace
}  // namespace bitspan
