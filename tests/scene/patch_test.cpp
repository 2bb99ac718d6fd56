// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/patch.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "config/config.hpp"
#include "scene/bez.hpp"
#include "scene/generate/cubic.hpp"
#include "scene/mesh.hpp"
#include "tests/support/files.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

using Rational = boost::multiprecision::cpp_rational;

PatchSet teapot() { return read_bez(source_path("tests/data/teapot.bez")); }

PatchGrid random_grid(std::mt19937_64& random) {
  PatchGrid grid;
  for (auto& row : grid) {
    for (std::int64_t& p : row) p = static_cast<std::int64_t>(random() % 2097153) - 1048576;
  }
  return grid;
}

// One row and one column through Bezier's form, in rationals.
Rational exact_point(const PatchGrid& grid, const Rational& u, const Rational& v) {
  std::array<Rational, 4> along;
  for (std::size_t j = 0; j < 4; ++j) {
    along[j] = cubic_of<Rational>(bezier_matrix, 1, {grid[0][j], grid[1][j], grid[2][j], grid[3][j]}).at(v);
  }
  return cubic_of<Rational>(bezier_matrix, 1, along).at(u);
}

// A plane: the point is linear in u and v.
TEST(Patch, OfAPlaneIsAGridByHand) {
  PatchGrid grid;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) grid[i][j] = static_cast<std::int64_t>(100 * i + j) * 4;
  }
  const auto points = patch_points(grid, 2, 6);
  ASSERT_EQ(points.size(), 25U);
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 5; ++column) {
      EXPECT_EQ(points[row * 5 + column], static_cast<std::int64_t>(300 * row + 3 * column) << 12);
    }
  }
}

TEST(Patch, EveryPointIsExact) {
  const std::uint64_t seed = 8;
  std::mt19937_64 random(seed);
  for (int k = patch_k_least; k <= patch_k_limit; ++k) {
    const PatchGrid grid = random_grid(random);
    const auto points = patch_points(grid, k, 3 * k);
    const std::size_t side = patch_side(k);
    for (std::size_t n = 0; n < 60; ++n) {
      const std::size_t row = n < 4 ? (n / 2) * (side - 1) : random() % side;
      const std::size_t column = n < 4 ? (n % 2) * (side - 1) : random() % side;
      const Rational at = exact_point(grid, Rational(column, side - 1), Rational(row, side - 1));
      EXPECT_EQ(Rational(points[row * side + column]), at * (std::int64_t{1} << (6 * k)))
          << "seed " << seed << ", k " << k << ", row " << row << ", column " << column;
    }
  }
}

// The largest patch that there may be: no sum leaves 64 bits.
TEST(Patch, HoldsTheLargestDifferences) {
  PatchGrid grid;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) grid[i][j] = (i + j) % 2 == 0 ? 1 << 20 : -(1 << 20);
  }
  const std::size_t side = patch_side(6);
  const auto points = patch_points(grid, 6, 18);
  EXPECT_EQ(points.front(), std::int64_t{1} << 56);
  EXPECT_EQ(points[side - 1], -(std::int64_t{1} << 56));
  EXPECT_EQ(Rational(points[31 * side + 17]),
            exact_point(grid, Rational(17, 64), Rational(31, 64)) * (std::int64_t{1} << 36));
}

TEST(Patch, TheTeapotHasNoCrackWithThreeBitsPerHalving) {
  const PatchSet set = teapot();
  EXPECT_EQ(set.patches.size(), 32U);
  for (int k = patch_k_least; k <= patch_k_limit; ++k) {
    const PatchCracks exact = count_cracks(set, k, 3 * k);
    EXPECT_EQ(exact.boundaries, 52U) << k;
    EXPECT_EQ(exact.points, 52 * patch_side(k)) << k;
    EXPECT_EQ(exact.cracks, 0U) << k;
    EXPECT_EQ(exact.corners, 128U) << k;
    EXPECT_EQ(exact.corners_off, 0U) << k;
    const PatchCracks less = count_cracks(set, k, 3 * k - 1);
    EXPECT_GT(less.cracks, 80U) << k;
    EXPECT_GT(less.corners_off, 30U) << k;
  }
}

std::array<double, 3> bits_of(const Vec3& p) { return {p.x, p.y, p.z}; }

// As triangles: an edge lies between two of them, or on the rim of the pot, and then on a patch's boundary.
TEST(Patch, TheTeapotsTrianglesMeetAtTheSameBits) {
  for (int k = patch_k_least; k <= (is_gate_run() ? 4 : patch_k_limit); ++k) {
    const MeshFile mesh = patch_mesh(teapot(), k);
    std::map<std::pair<std::array<double, 3>, std::array<double, 3>>, int> open;
    for (const MeshTriangle& t : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto a = bits_of(t.corner[i].position);
        const auto b = bits_of(t.corner[(i + 1) % 3].position);
        if (--open[{b, a}] == 0) {
          open.erase({b, a});
          continue;
        }
        if (open[{b, a}] == -1) {
          open.erase({b, a});
          ++open[{a, b}];
        }
      }
    }
    // 16 boundaries belong to one patch alone: rim, lid, spout's and handle's ends.
    EXPECT_EQ(open.size(), 16U << k) << k;
    const std::size_t cells = std::size_t{32} << (2 * k);
    EXPECT_EQ(mesh.triangles.size(), 2 * cells - (std::size_t{8} << k)) << k;  // 8 patches end in a point
  }
}

TEST(Patch, NormalsPointOutward) {
  const MeshFile mesh = patch_mesh(teapot(), 3);
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3 face =
        cross(t.corner[1].position - t.corner[0].position, t.corner[2].position - t.corner[0].position);
    for (const MeshCorner& corner : t.corner) {
      ASSERT_GT(length(corner.normal), 0);
      EXPECT_GT(dot(of_length_1(corner.normal), of_length_1(face)), 0.2);
    }
  }
  // Of the body, away from the axis; y is upward.
  const MeshTriangle& t = mesh.triangles[4 * 128 + 60];
  const Vec3& p = t.corner[0].position;
  EXPECT_GT(dot(t.corner[0].normal, Vec3{p.x, 0, p.z}), 0);
}

TEST(Patch, AMeshHasADepthAndTexturesOfItsPatches) {
  const std::string path = source_path("tests/data/teapot.bez");
  EXPECT_EQ(read_mesh(path).faces.size(), 2 * 32 * 256U - 8 * 16);
  const Mesh mesh =
      read_mesh(path, source_path("tests/data/spot.png"), nullptr, std::nullopt, std::nullopt, 2);
  EXPECT_EQ(mesh.faces.size(), 2 * 32 * 16U - 8 * 4);
  const double width = mesh.textures[0].width;
  const double height = mesh.textures[0].height;
  EXPECT_EQ(mesh.faces[0].corner[0].u, 0);
  EXPECT_EQ(mesh.faces[0].corner[0].v, height);
  EXPECT_EQ(mesh.faces[0].corner[1].u, width / 4);
  EXPECT_EQ(mesh.faces[0].corner[2].v, height * 3 / 4);
}

constexpr const char* flat =
    "1\n1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16\n16\n"
    "0,0,0\n1,0,0\n2,0,0\n3,0,0\n0,1,0\n1,1,0\n2,1,0\n3,1,0\n"
    "0,2,0\n1,2,0\n2,2,0\n3,2,0\n0,3,0\n1,3,0\n2,3,0\n3,3,0\n";

TEST(Patch, ReadsItsTextAndTurnsZUp) {
  const TemporaryFolder folder;
  const PatchSet set = read_bez(folder.write("flat.bez", flat));
  ASSERT_EQ(set.patches.size(), 1U);
  EXPECT_EQ(set.name, "flat");
  EXPECT_EQ(set.fraction, 18);  // 3 is below 2^2
  EXPECT_EQ(set.patches[0].axis[0][0][3], 3 << 18);
  EXPECT_EQ(set.patches[0].axis[1][3][0], 0);
  EXPECT_EQ(set.patches[0].axis[2][3][0], -(3 << 18));
  EXPECT_EQ(patch_mesh(set, 2).triangles.size(), 32U);
}

TEST(Patch, RefusesWhatIsNoPatch) {
  const TemporaryFolder folder;
  const std::string good = flat;
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      read_bez(folder.write("bad.bez", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_EQ(refusal(good), "");
  const std::pair<std::string, const char*> cases[] = {
      {"", "bad.bez:1: the file ends"},
      {with("1\n1,2", "0\n1,2"), "bad.bez:1: \"0\" is no number of patches; expected 1..100000"},
      {with("15,16", "15,17"), "bad.bez:3: \"16\" is no number of vertices; expected 17.."},
      {with("15,16", "15,x"), "bad.bez:2: \"x\" is no number of a vertex"},
      {with("2,3,0\n3", "2,3,nan\n3"), "bad.bez:18: \"nan\" is no coordinate"},
      {good + "7", "bad.bez:20: there is more"},
      {with("1\n1,2", "2\n1,2"), "bad.bez:4: \"0\" is no number of a vertex"},
  };
  for (const auto& [text, part] : cases) {
    EXPECT_NE(refusal(text).find(part), std::string::npos) << refusal(text) << " has no " << part;
  }
  for (std::size_t length = 0; length + 2 < good.size(); length += 5) {
    EXPECT_NE(refusal(good.substr(0, length)), "") << length;
  }
  EXPECT_THROW(read_bez(folder.path("none.bez")), InputError);
}

// Random bytes in a legal file: a patch or one line.
TEST(Patch, SurvivesRandomBytes) {
  const TemporaryFolder folder;
  std::mt19937_64 random(9);
  for (int n = 0; n < 300; ++n) {
    std::string text = flat;
    for (int i = 0; i < 3; ++i) text[random() % text.size()] = static_cast<char>(random() % 128);
    try {
      patch_mesh(read_bez(folder.write("r.bez", text)), 2);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace bitspan
