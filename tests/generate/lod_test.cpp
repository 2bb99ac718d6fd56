// SPDX-License-Identifier: Apache-2.0
// Ranks of points: errors formed again from the triangles, and what is left where nothing is to be seen.
#include "scene/generate/lod.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

HeightField hills(int columns, int rows) {
  HeightField field{columns, rows, {}};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      field.heights.push_back(std::round(400 * std::exp(-std::hypot(i - 20, j - 30) / 8) +
                                         60 * std::sin(0.2 * i) * std::cos(0.15 * j)));
    }
  }
  return field;
}

// Of a sample: the triangle that holds it, found by looking at all, and the height there.
SurfaceError recomputed(const HeightField& field, const Delaunay& surface) {
  SurfaceError out;
  double squares = 0;
  const auto triangles = surface.triangles();
  for (int y = 0; y < field.rows; ++y) {
    for (int x = 0; x < field.columns; ++x) {
      for (const auto& t : triangles) {
        const GridPoint &a = surface.points()[t[0]], &b = surface.points()[t[1]], &c = surface.points()[t[2]],
                        p{x, y};
        if (side_of(a, b, p) < 0 || side_of(b, c, p) < 0 || side_of(c, a, p) < 0) continue;
        // The plane through the three, as z = h + r dx + s dy.
        const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
        const double h = field.at(a.x, a.y), uh = field.at(b.x, b.y) - h, vh = field.at(c.x, c.y) - h;
        const double area = ux * vy - uy * vx;
        const double r = (uh * vy - vh * uy) / area, s = (ux * vh - vx * uh) / area;
        const double error = h + r * (x - a.x) + s * (y - a.y) - field.at(x, y);
        out.largest = std::max(out.largest, std::abs(error));
        squares += error * error;
        break;
      }
    }
  }
  out.rms = std::sqrt(squares / static_cast<double>(field.heights.size()));
  return out;
}

constexpr LodCost costs[] = {LodCost::normal, LodCost::error};

TEST(Lod, ReportedErrorsAreThoseOfTheTriangles) {
  const HeightField field = hills(50, 45);
  for (const LodCost cost : costs) {
    const Lod lod = make_lod(field, {cost, 6, 0.05, 0.02});
    ASSERT_EQ(lod.ranks.size(), 6U);
    double bound = 0;
    for (std::size_t r = 0; r < 6; ++r) {
      const LodRank& rank = lod.ranks[r];
      // From the ranks alone, in another order of insertion.
      const Delaunay surface = lod_surface(field, lod.rank, static_cast<std::int32_t>(r) + 1);
      EXPECT_EQ(surface.size(), rank.points);
      EXPECT_EQ(surface.triangle_count(), rank.triangles);
      const SurfaceError again = recomputed(field, surface);
      EXPECT_NEAR(again.largest, rank.error.largest, 1e-9);
      EXPECT_NEAR(again.rms, rank.error.rms, 1e-9);
      bound = std::max(bound, again.largest);
      EXPECT_NEAR(rank.bound, bound, 1e-9);
      EXPECT_EQ(rank.points, static_cast<std::size_t>(
                                 std::lround(2250 * std::pow(0.05, (static_cast<double>(r) + 1) / 6))));
    }
  }
}

TEST(Lod, APlaneNeedsItsCornersOnly) {
  HeightField field{20, 15, {}};
  for (int j = 0; j < 15; ++j) {
    for (int i = 0; i < 20; ++i) field.heights.push_back(3 * i - 2 * j + 5);
  }
  for (const LodCost cost : costs) {
    const Lod lod = make_lod(field, {cost, 3, 0.001, 1});
    EXPECT_EQ(lod.ranks.back().points, 4U);
    EXPECT_LT(lod.ranks.back().error.largest, 1e-12);
    EXPECT_EQ(std::ranges::count(lod.rank, 3), 4);
  }
  EXPECT_LT(grid_error(field, 4).largest, 1e-12);
}

TEST(Lod, ARidgeIsCarriedByItsEnds) {
  HeightField field{21, 21, {}};
  for (int j = 0; j < 21; ++j) {
    for (int i = 0; i < 21; ++i) field.heights.push_back(10 - std::abs(i - 10));
  }
  const Lod lod = make_lod(field, {LodCost::error, 1, 8.0 / 441, 1});
  EXPECT_EQ(lod.rank[10], 1);
  EXPECT_EQ(lod.rank[20 * 21 + 10], 1);
  EXPECT_LT(lod.ranks[0].error.largest, 1e-12);
}

TEST(Lod, ARealFieldIsTwiceAsGoodAsAGrid) {
  // Sample data of Debian's Matplotlib: 344 x 403 elevations in metres, some 90 m apart.
  const char* const path = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const HeightField whole = read_height_field(path);
  ASSERT_EQ(whole.columns, 403);
  ASSERT_EQ(whole.rows, 344);
  EXPECT_EQ(*std::ranges::min_element(whole.heights), 236);
  EXPECT_EQ(*std::ranges::max_element(whole.heights), 1076);
  // All of it, or a part in its middle.
  HeightField part{161, 137, {}};
  for (int j = 0; j < part.rows; ++j) {
    for (int i = 0; i < part.columns; ++i) part.heights.push_back(whole.at(i + 120, j + 100));
  }
  const HeightField& field = is_long_run() ? whole : part;
  const Lod lod = make_lod(field, {LodCost::error, 8, 0.1, 0.011});
  for (std::size_t r = 1; r < 8; ++r)
    EXPECT_GE(lod.ranks[r].error.largest, lod.ranks[r - 1].error.largest) << r;
  const double grid = grid_error(field, lod.ranks.back().points).rms;
  EXPECT_LE(lod.ranks.back().error.rms, 0.5 * grid) << lod.ranks.back().error.rms << " " << grid;
}

}  // namespace
}  // namespace bitspan
