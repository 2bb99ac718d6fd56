// SPDX-License-Identifier: Apache-2.0
// Terrain on grids and in rings: every vertex and every edge is looked at.
#include "scene/generate/terrain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "scene/obj.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

HeightField hills(int columns, int rows) {
  HeightField field{columns, rows, {}};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      field.heights.push_back(std::round(100 * std::sin(0.3 * i) * std::cos(0.2 * j)) - 7);
  }
  return field;
}

MeshFile grid_file(const TemporaryFolder& folder, const HeightField& field, const TerrainPlace& place,
                   const GridOptions& grid, MeshCounts& counts) {
  ObjWriter out(folder.path("a.obj"), "a test");
  counts = write_grid(field, place, grid, out);
  out.commit();
  return read_obj(folder.path("a.obj"));
}

// Twice the area of a triangle seen from above, positive where it looks upward.
double area_from_above(const MeshTriangle& t) {
  const Vec3 a = t.corner[1].position - t.corner[0].position, b = t.corner[2].position - t.corner[0].position;
  return a.z * b.x - a.x * b.z;
}

TEST(Terrain, ARightGridHasTheSamplesAndCoversTheField) {
  const TemporaryFolder folder;
  const HeightField field = hills(9, 6);
  const TerrainPlace place{2, 0.1, true};
  MeshCounts counts;
  const MeshFile mesh = grid_file(folder, field, place, {}, counts);
  EXPECT_EQ(counts.vertices, 54U);
  EXPECT_EQ(counts.triangles, 80U);
  ASSERT_EQ(mesh.triangles.size(), 80U);
  const double low = *std::ranges::min_element(field.heights);
  double area = 0;
  for (const MeshTriangle& t : mesh.triangles) {
    EXPECT_EQ(area_from_above(t), 4);
    area += area_from_above(t) / 2;
    for (const MeshCorner& c : t.corner) {
      // What is read has the bits of what was made.
      const double i = c.position.x / 2 + 4, j = c.position.z / 2 + 2.5;
      ASSERT_EQ(i, std::round(i));
      EXPECT_EQ(c.position.y, (field.at(static_cast<int>(i), static_cast<int>(j)) - low) * 0.1);
    }
  }
  EXPECT_EQ(area, 8 * 5 * 4);
}

TEST(Terrain, AnEquilateralGridHasSidesOfOneLength) {
  const TemporaryFolder folder;
  const HeightField field = hills(30, 27);
  for (const int columns : {30, 12, 75}) {
    MeshCounts counts;
    const MeshFile mesh = grid_file(folder, field, {}, {GridKind::equilateral, columns}, counts);
    EXPECT_EQ(mesh.triangles.size(), counts.triangles);
    const double step = 29.0 / (columns - 1);
    double area = 0;
    std::size_t regular = 0;
    for (const MeshTriangle& t : mesh.triangles) {
      EXPECT_GT(area_from_above(t), 0);
      area += area_from_above(t) / 2;
      bool is_regular = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = t.corner[k].position, &b = t.corner[(k + 1) % 3].position;
        const double side = std::hypot(a.x - b.x, a.z - b.z);
        // Rows are fitted to the field: at most half a row in all is given or taken.
        is_regular = is_regular && std::abs(side / step - 1) < 0.5 / (columns - 1) + 0.5 / 26;
      }
      regular += is_regular ? 1 : 0;
    }
    EXPECT_NEAR(area, 29 * 26, 1e-9);
    // Those at the left and right edge are halves.
    const std::size_t rows = counts.vertices / static_cast<std::size_t>(columns);
    EXPECT_GE(regular + 2 * rows, counts.triangles);
  }
}

TEST(Terrain, AGridOfAnotherSizeHasBilinearHeights) {
  const TemporaryFolder folder;
  const HeightField field = hills(9, 6);
  MeshCounts counts;
  const MeshFile mesh = grid_file(folder, field, {}, {GridKind::right, 17}, counts);
  EXPECT_EQ(counts.triangles, 2U * 16 * 10);
  const double low = *std::ranges::min_element(field.heights);
  for (const MeshTriangle& t : mesh.triangles) {
    for (const MeshCorner& c : t.corner) {
      EXPECT_EQ(c.position.y, height_at(field, c.position.x + 4, c.position.z + 2.5) - low);
    }
  }
}

// Everything that is wrong with rings over a field: edges that have not two sides, or one on the border;
// vertices in the middle of an edge; an area that is not the field's.
std::string faults_of(const RingMesh& mesh, int columns, int rows) {
  using Place = std::array<int, 2>;
  std::set<Place> places(mesh.vertices.begin(), mesh.vertices.end());
  if (places.size() != mesh.vertices.size()) return "two vertices at one place";
  std::map<std::pair<Place, Place>, int> edges;
  long area = 0;
  for (const auto& t : mesh.triangles) {
    const Place &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const long twice = long{b[1] - a[1]} * (c[0] - a[0]) - long{b[0] - a[0]} * (c[1] - a[1]);
    if (twice <= 0) return "a triangle that looks downward";
    area += twice;
    for (std::size_t k = 0; k < 3; ++k) ++edges[{mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]]}];
  }
  if (area != 2L * (columns - 1) * (rows - 1)) return "not the field's area";
  for (const auto& [edge, count] : edges) {
    const auto& [a, b] = edge;
    if (count != 1) return "an edge twice in one direction";
    const bool is_border = (a[0] == b[0] && (a[0] == 0 || a[0] == columns - 1)) ||
                           (a[1] == b[1] && (a[1] == 0 || a[1] == rows - 1));
    if (edges.contains({b, a}) == is_border)
      return is_border ? "a border with two sides" : "an edge with one side";
    const int n = std::gcd(b[0] - a[0], b[1] - a[1]);
    for (int k = 1; k < n; ++k) {
      if (places.contains({a[0] + (b[0] - a[0]) / n * k, a[1] + (b[1] - a[1]) / n * k}))
        return "a vertex inside an edge";
    }
  }
  return "";
}

TEST(Rings, NoVertexLiesInsideAnEdge) {
  constexpr unsigned seed = 41;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int k = 0; k < (is_long_run() ? 3000 : 200); ++k) {
    const int columns = 2 + static_cast<int>(random() % 70), rows = 2 + static_cast<int>(random() % 70);
    const auto place = [&](int n) { return static_cast<double>(random() % 4000) / 1000 * n - 1.5 * n; };
    const RingOptions rings{place(columns), place(rows), 2 + static_cast<double>(random() % 90) / 10};
    EXPECT_EQ(faults_of(ring_mesh(columns, rows, rings), columns, rows), "")
        << columns << " x " << rows << ", viewer " << rings.x << " " << rings.z << ", near " << rings.near;
  }
}

TEST(Rings, AFlightOverTheFieldHasNone) {
  const int frames = is_long_run() ? 300 : 30;
  for (int frame = 0; frame < frames; ++frame) {
    const double part = frame / (frames - 1.0);
    const RingMesh mesh = ring_mesh(403, 344, {403 * part, 172 + 150 * std::sin(9 * part), 16});
    ASSERT_EQ(faults_of(mesh, 403, 344), "") << frame;
    EXPECT_GE(mesh.levels, 5);
    EXPECT_LT(mesh.triangles.size(), 20'000U);  // of 274,872
  }
}

TEST(Rings, HaveTheFullResolutionNearTheViewer) {
  const RingMesh mesh = ring_mesh(129, 129, {64, 64, 20});
  const std::set<std::array<int, 2>> places(mesh.vertices.begin(), mesh.vertices.end());
  for (int j = 0; j < 129; ++j) {
    for (int i = 0; i < 129; ++i) {
      if (std::max(std::abs(i - 64), std::abs(j - 64)) < 20) {
        EXPECT_TRUE(places.contains({i, j})) << i << " " << j;
      }
    }
  }
  EXPECT_FALSE(places.contains({1, 1}));
}

TEST(Rings, AFaultWouldBeSeen) {
  RingMesh mesh = ring_mesh(65, 65, {0, 0, 4});
  ASSERT_EQ(faults_of(mesh, 65, 65), "");
  mesh.triangles.pop_back();
  EXPECT_NE(faults_of(mesh, 65, 65), "");
  // Where neighbours may differ by two levels, some vertex lies inside an edge.
  std::string faults;
  for (int k = 0; k < 20; ++k) faults += faults_of(ring_mesh(65, 65, {3.1 * k, 40.7, 0.3}), 65, 65);
  EXPECT_TRUE(names(faults, "an edge with one side") || names(faults, "inside an edge")) << faults;
}

}  // namespace
}  // namespace bitspan
