// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/curve.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <random>
#include <vector>

#include "config/config.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Pieces = std::vector<Cubic<Rational>>;

std::vector<Rational> random_points(std::mt19937_64& random, std::size_t count) {
  std::vector<Rational> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(static_cast<int>(random() % 2001) - 1000);
  return out;
}
Pieces pieces_of(const std::vector<Rational>& points, CurveKind kind, CurveEnd end = CurveEnd::mirrored,
                 const Rational& first = 0, const Rational& last = 0) {
  return curve_pieces<Rational>(points, kind, end, first, last);
}

// How many derivatives, from the value itself on, agree at every joint.
int continuous(const Pieces& pieces, bool closed = false) {
  int out = 3;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (i + 1 == pieces.size() && !closed) break;
    const Cubic<Rational>& here = pieces[i];
    const Cubic<Rational>& next = pieces[(i + 1) % pieces.size()];
    const bool value = here.at(1) == next.at(0);
    const bool slope = value && here.slope_at(1) == next.slope_at(0);
    const bool bend = slope && here.bend_at(1) == next.bend_at(0);
    out = std::min(out, static_cast<int>(value) + static_cast<int>(slope) + static_cast<int>(bend));
  }
  return out;
}

TEST(Curve, HermiteHasItsEndsAndTangents) {
  const Pieces p = pieces_of({3, 5, 7, -2, 4, 1}, CurveKind::hermite);
  ASSERT_EQ(p.size(), 2U);
  EXPECT_EQ(p[0].at(0), 3);
  EXPECT_EQ(p[0].slope_at(0), 5);
  EXPECT_EQ(p[0].at(1), 7);
  EXPECT_EQ(p[0].slope_at(1), -2);
  EXPECT_EQ(p[1].at(1), 4);
  EXPECT_EQ(p[1].slope_at(1), 1);
  EXPECT_EQ(continuous(p), 2);
}

// The tangents at its ends are three times the control polygon's first and last side.
TEST(Curve, BezierHasItsEndsAndTangents) {
  const Pieces p = pieces_of({1, 4, 9, 2, -5, 0, 6}, CurveKind::bezier);
  ASSERT_EQ(p.size(), 2U);
  EXPECT_EQ(p[0].at(0), 1);
  EXPECT_EQ(p[0].slope_at(0), 9);
  EXPECT_EQ(p[0].at(1), 2);
  EXPECT_EQ(p[0].slope_at(1), -21);
  EXPECT_EQ(p[1].at(1), 6);
  EXPECT_EQ(continuous(p), 2);  // 9, 2, -5 lie as far apart
  EXPECT_EQ(continuous(pieces_of({1, 4, 9, 2, -4, 0, 6}, CurveKind::bezier)), 1);
}

// By the sums of Bernstein's polynomials: within the control points.
TEST(Curve, BezierStaysInsideItsControlPoints) {
  std::mt19937_64 random(3);
  for (int n = 0; n < 50; ++n) {
    const std::vector<Rational> points = random_points(random, 4);
    const Pieces p = pieces_of(points, CurveKind::bezier);
    const auto [low, high] = std::minmax_element(points.begin(), points.end());
    for (int i = 0; i <= 16; ++i) {
      const Rational x = p[0].at(Rational{i, 16});
      EXPECT_GE(x, *low);
      EXPECT_LE(x, *high);
    }
  }
}

TEST(Curve, ASplineOfControlPointsHasTwoContinuousDerivatives) {
  std::mt19937_64 random(4);
  const std::vector<Rational> points = random_points(random, 9);
  for (const CurveEnd end : {CurveEnd::mirrored, CurveEnd::closed, CurveEnd::doubled}) {
    EXPECT_EQ(continuous(pieces_of(points, CurveKind::bspline, end), end == CurveEnd::closed), 3)
        << to_string(end);
  }
}

TEST(Curve, CatmullRomGoesThroughItsPoints) {
  std::mt19937_64 random(5);
  const std::vector<Rational> points = random_points(random, 9);
  for (const CurveEnd end : {CurveEnd::mirrored, CurveEnd::closed, CurveEnd::doubled}) {
    const Pieces p = pieces_of(points, CurveKind::catmull_rom, end);
    EXPECT_EQ(continuous(p, end == CurveEnd::closed), 2) << to_string(end);
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_EQ(p[i].at(0), points[i]);
      EXPECT_EQ(p[i].at(1), points[(i + 1) % points.size()]);
    }
  }
}

// Three ways to end a curve: where it begins and ends, and how many pieces it has.
TEST(Curve, EndsInThreeWays) {
  const std::vector<Rational> points{2, 8, 5, 11};
  const Pieces mirrored = pieces_of(points, CurveKind::bspline, CurveEnd::mirrored);
  EXPECT_EQ(mirrored.size(), 3U);
  EXPECT_EQ(mirrored.front().at(0), 2);
  EXPECT_EQ(mirrored.back().at(1), 11);
  EXPECT_EQ(mirrored.front().slope_at(0), 6);  // towards the next point
  EXPECT_EQ(mirrored.front().bend_at(0), 0);
  const Pieces closed = pieces_of(points, CurveKind::bspline, CurveEnd::closed);
  EXPECT_EQ(closed.size(), 4U);
  EXPECT_EQ(closed.front().at(0), (Rational{11 + 4 * 2 + 8, 6}));
  EXPECT_EQ(closed.back().at(1), closed.front().at(0));
  const Pieces doubled = pieces_of(points, CurveKind::bspline, CurveEnd::doubled);
  EXPECT_EQ(doubled.size(), 3U);
  EXPECT_EQ(doubled.front().at(0), (Rational{5 * 2 + 8, 6}));
  EXPECT_EQ(doubled.back().at(1), (Rational{5 * 11 + 5, 6}));
}

TEST(Curve, TheClampedSplineSolvesItsSystem) {
  std::mt19937_64 random(6);
  for (std::size_t n = 2; n < 12; ++n) {
    const std::vector<Rational> points = random_points(random, n);
    const Rational first = 7;
    const Rational last = -3;
    const std::vector<Rational> m = spline_tangents(points, first, last);
    for (std::size_t i = 1; i + 1 < n; ++i) {
      EXPECT_EQ(m[i - 1] + 4 * m[i] + m[i + 1] - 3 * (points[i + 1] - points[i - 1]), 0);
    }
    const Pieces p = pieces_of(points, CurveKind::spline, CurveEnd::mirrored, first, last);
    ASSERT_EQ(p.size(), n - 1);
    EXPECT_EQ(continuous(p), 3);
    EXPECT_EQ(p.front().slope_at(0), first);
    EXPECT_EQ(p.back().slope_at(1), last);
    for (std::size_t i = 0; i + 1 < n; ++i) {
      EXPECT_EQ(p[i].at(0), points[i]);
      EXPECT_EQ(p[i].at(1), points[i + 1]);
    }
  }
}

// t^3 is its own spline.
TEST(Curve, TheClampedSplineOfACubicIsTheCubic) {
  const Pieces p = pieces_of({0, 1, 8, 27, 64}, CurveKind::spline, CurveEnd::mirrored, 0, 48);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_EQ(p[i].power[3], 1) << i;
}

TEST(Curve, APieceInSpaceHasEachAxisAlone) {
  const std::vector<CurvePiece> pieces = make_curve(
      {{0, 1, 2}, {3, 5, 7}, {4, 4, 4}}, {.kind = CurveKind::spline, .first_tangent = Vec3{1, 2, 3}});
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(point_at(pieces[1], 0), (Vec3{3, 5, 7}));
  EXPECT_EQ(pieces[0][2].slope_at(0), 3);
  EXPECT_EQ(pieces[1][0].slope_at(1), 1);  // towards the last point
}

TEST(Curve, JointsOnAGridAreOnePoint) {
  const auto pieces = make_curve({{0.1, 0, 0}, {1.7, 1, 0}, {2.3, -1, 0.3}, {3.9, 0, 0}}, {});
  const std::vector<GridPiece> grid = on_curve_grid(pieces, 8);
  ASSERT_EQ(grid.size(), 3U);
  EXPECT_EQ(grid[0][0][0], 26);  // 0.1 * 256
  for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(grid[i][axis][3], grid[i + 1][axis][0]);
  }
  EXPECT_THROW(on_curve_grid(make_curve({{0, 0, 0}, {1e12, 0, 0}}, {}), 8), InputError);
}

TEST(Curve, RefusesPointsThatAreTooFew) {
  const Vec3 o{};
  EXPECT_THROW(make_curve({o, o, o}, {.kind = CurveKind::hermite}), InputError);
  EXPECT_THROW(make_curve({o, o, o, o, o}, {.kind = CurveKind::bezier}), InputError);
  EXPECT_THROW(make_curve({o}, {.kind = CurveKind::bspline}), InputError);
  EXPECT_THROW(make_curve({o, o}, {.kind = CurveKind::bspline, .end = CurveEnd::closed}), InputError);
  EXPECT_THROW(make_curve({}, {.kind = CurveKind::spline}), InputError);
}

TEST(Curve, ReadsPoints) {
  const TemporaryFolder folder;
  const auto points = read_points(folder.write("p.csv", "# x,y,z\n1,2\n\n 3 , 4.5 , -6 \r\n"));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0], (Vec3{1, 2, 0}));
  EXPECT_EQ(points[1], (Vec3{3, 4.5, -6}));
  for (const char* bad : {"1", "1,", "1,2,3,4", "1,x", "nan,1", "1;2", "1e13,0"}) {
    const std::string path = folder.write("bad.csv", std::string("0,0\n") + bad + "\n");
    try {
      read_points(path);
      ADD_FAILURE() << bad;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("bad.csv:2: "), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace bitspan
