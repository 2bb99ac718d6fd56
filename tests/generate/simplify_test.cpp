// SPDX-License-Identifier: Apache-2.0
// Collapses of edges: costs formed again from planes, and every bit back by the log.
#include "scene/generate/simplify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "scene/obj.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

IndexedMesh spot() {
  std::size_t left_out = 0;
  IndexedMesh mesh = read_indexed_mesh(source_path("tests/data/spot.obj"), left_out);
  EXPECT_EQ(left_out, 0U);
  return mesh;
}

// A square of n x n cells in the plane y = 0, with bumps.
IndexedMesh sheet(int n, double bump) {
  IndexedMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i)
      mesh.vertices.push_back({1.0 * i, bump * std::sin(1.7 * i) * std::sin(2.3 * j), 1.0 * j});
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto at = [&](int x, int z) { return static_cast<std::uint32_t>((j + z) * (n + 1) + i + x); };
      mesh.faces.push_back({at(0, 0), at(0, 1), at(1, 0)});
      mesh.faces.push_back({at(1, 0), at(0, 1), at(1, 1)});
    }
  }
  return mesh;
}

struct TestPlane {
  Vec3 normal, point;
};

// The planes of each vertex: of its faces and, at a border, across them.
std::vector<std::vector<TestPlane>> planes_of(const IndexedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const MeshFace& f : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(f[k], f[(k + 1) % 3])];
  }
  std::vector<std::vector<TestPlane>> out(mesh.vertices.size());
  for (const MeshFace& f : mesh.faces) {
    const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Vec3 n = of_length_1(cross(b - a, c - a));
    for (std::size_t k = 0; k < 3; ++k) {
      out[f[k]].push_back({n, a});
      const std::uint32_t v = f[k], w = f[(k + 1) % 3];
      if (edges[std::minmax(v, w)] != 1) continue;
      const TestPlane across{of_length_1(cross(mesh.vertices[w] - mesh.vertices[v], n)), mesh.vertices[v]};
      out[v].push_back(across);
      out[w].push_back(across);
    }
  }
  return out;
}

// Each cost of the log is the summed squared distance of its place from the planes that have come together
// there, and no greater than that at both ends.
void expect_costs(const IndexedMesh& mesh, const std::vector<Collapse>& log) {
  auto planes = planes_of(mesh);
  for (const Collapse& c : log) {
    auto& kept = planes[c.kept];
    kept.insert(kept.end(), planes[c.gone].begin(), planes[c.gone].end());
    const auto sum_at = [&](const Vec3& place) {
      double sum = 0;
      for (const TestPlane& p : kept) sum += std::pow(dot(p.normal, place - p.point), 2);
      return sum;
    };
    ASSERT_NEAR(c.cost, sum_at(c.to), 1e-12 + 1e-9 * sum_at(c.to));
    ASSERT_LE(c.cost, std::min(sum_at(c.kept_before), sum_at(c.gone_before)) + 1e-12);
  }
}

// Whether each edge of the faces that are there has one face per direction, and how many have one face alone.
std::size_t border_of(const SimplifiedMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t f = 0; f < mesh.mesh.faces.size(); ++f) {
    if (!mesh.has_face[f]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(mesh.has_vertex[mesh.mesh.faces[f][k]]);
      EXPECT_TRUE(edges.insert({mesh.mesh.faces[f][k], mesh.mesh.faces[f][(k + 1) % 3]}).second);
    }
  }
  return static_cast<std::size_t>(std::ranges::count_if(edges, [&](const auto& e) {
    return !edges.contains({e.second, e.first});
  }));
}

TEST(Simplify, SpotIsAThousandTrianglesAndBack) {
  const IndexedMesh whole = spot();
  ASSERT_EQ(whole.faces.size(), 5856U);
  SimplifiedMesh simple = simplify(whole, 1000);
  EXPECT_EQ(simple.face_count, 1000U);
  EXPECT_EQ(simple.log.size(), 2428U);
  EXPECT_EQ(border_of(simple), 0U);
  expect_costs(whole, simple.log);
  // Halfway, and all of it.
  undo(simple, 3000);
  EXPECT_EQ(simple.face_count, 3000U);
  EXPECT_EQ(border_of(simple), 0U);
  undo(simple, 1'000'000);
  EXPECT_TRUE(simple.log.empty());
  EXPECT_EQ(simple.mesh, whole);
}

TEST(Simplify, TheLogAsAFileBringsBackEveryBit) {
  const TemporaryFolder folder;
  const IndexedMesh whole = spot();
  const SimplifiedMesh simple = simplify(whole, 4000);
  write_collapse_log(simple, folder.path("log"));
  SimplifiedMesh read = read_collapse_log(folder.path("log"));
  EXPECT_EQ(read, simple);
  undo(read, 1'000'000);
  EXPECT_EQ(read.mesh, whole);
  // The OBJ file is read back as what it was.
  ObjWriter out(folder.path("a.obj"), "a test");
  write_mesh(read, out);
  out.commit();
  std::size_t left_out = 0;
  EXPECT_EQ(read_indexed_mesh(folder.path("a.obj"), left_out), whole);
}

TEST(Simplify, AFlatSheetKeepsItsOutlineOnly) {
  const SimplifiedMesh simple = simplify(sheet(10, 0), 2);
  EXPECT_EQ(simple.face_count, 2U);
  for (const Collapse& c : simple.log) EXPECT_LT(c.cost, 1e-18);
  std::set<std::pair<double, double>> corners;
  for (std::size_t v = 0; v < simple.mesh.vertices.size(); ++v) {
    if (simple.has_vertex[v])
      corners.insert({std::round(simple.mesh.vertices[v].x), std::round(simple.mesh.vertices[v].z)});
  }
  EXPECT_EQ(corners, (std::set<std::pair<double, double>>{{0, 0}, {0, 10}, {10, 0}, {10, 10}}));
}

TEST(Simplify, ABorderStaysOne) {
  const IndexedMesh whole = sheet(12, 0.4);
  const SimplifiedMesh simple = simplify(whole, 60);
  EXPECT_LE(simple.face_count, 60U);
  EXPECT_GE(border_of(simple), 4U);
  expect_costs(whole, simple.log);
}

TEST(Simplify, StopsInFrontOfAFold) {
  // A tetrahedron has no edge that can go.
  const IndexedMesh whole{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const SimplifiedMesh simple = simplify(whole, 1);
  EXPECT_EQ(simple.face_count, 4U);
  EXPECT_EQ(simple.mesh, whole);
}

TEST(CollapseLog, DamagedFilesAreRefusedOrUndone) {
  const TemporaryFolder folder;
  const SimplifiedMesh simple = simplify(sheet(3, 0.3), 8);
  write_collapse_log(simple, folder.path("log"));
  const std::string good = folder.read("log");
  const auto refused = [&](std::string_view from, std::string_view to, std::string_view part) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    folder.write("bad", text.replace(at, from.size(), to));
    expect_refusal([&] { read_collapse_log(folder.path("bad")); }, part);
  };
  refused("\"simplify\": 1", "\"simplify\": 0", "bad:1: is no log of version 1");
  refused("\"vertices\": 16", "\"vertices\": 4000000000", "bad:1: vertices is no whole number");
  refused("\"vertices\": 16", "\"vertices\": 17", "neither there nor gone");
  refused("\"corners\"", "\"corner\"", "has no corners");
  refused("\"gone\": ", "\"gone\": 9", "gone is no whole number");
  refused("\"gone_faces\": [[", "\"gone_faces\": [[[", "is no JSON object");
  folder.write("bad", "");
  expect_refusal([&] { read_collapse_log(folder.path("bad")); }, "is empty");
  constexpr unsigned seed = 11;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  int bad = 0;
  for (int k = 0; k < (is_long_run() ? 3000 : 200); ++k) {
    std::string text = good;
    text[random() % text.size()] = static_cast<char>(random() % 2 == 0 ? '0' + random() % 10 : random());
    folder.write("bad", text);
    bad += error_of([&] {
             SimplifiedMesh mesh = read_collapse_log(folder.path("bad"));
             undo(mesh, 1000);
             ObjWriter out(folder.path("a.obj"), "a test");
             write_mesh(mesh, out);
           }).empty()
               ? 0
               : 1;
  }
  EXPECT_GT(bad, 40);
}

}  // namespace
}  // namespace bitspan
