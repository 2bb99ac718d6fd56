// SPDX-License-Identifier: Apache-2.0
#include "model/stages/plane_walk.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "model/stages/setup.hpp"
#include "model/stages/span.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

Config plane_config() {
  Config c = plain_config();
  c.perspective = Perspective::const_depth_rows;
  return c;
}

struct Walk {
  explicit Walk(const Config& c, int w = 64, int h = 48) : config(c) {
    const model::Constants k = model::make_constants(c, worked_scene());
    setup_stage = model::prepare_setup(c, k);
    stage = model::prepare_plane_walk(c, k, w, h);
  }
  std::vector<PlaneRowRecord> operator()(const Triangle& t) {
    std::vector<PlaneRowRecord> rows;
    SetupRecord vertices;
    if (!model::setup(setup_stage, t, 3, vertices)) {
      return rows;
    }
    model::start_plane_walk(stage, vertices, state);
    PlaneRowRecord row;
    while (!model::finished(state)) {
      if (model::plane_walk(stage, state, row)) {
        rows.push_back(row);
      }
    }
    return rows;
  }
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  Config config;
  model::SetupStage setup_stage;
  model::PlaneWalkStage stage;
  model::PlaneWalkState state;
};

// h depends on y alone: rows of constant depth are rows of the screen.
TEST(PlaneWalk, FloorHasHorizontalRows) {
  Walk walk(plane_config());
  const auto rows = walk(triangle(vertex(0, 0, 2, 0), vertex(16, 0, 2, 16), vertex(0, 16, 1, 0)));
  EXPECT_EQ(walk.state.record.major, 0);
  EXPECT_EQ(walk.state.record.k, 0);
  EXPECT_EQ(walk.state.record.major_first, 0);
  EXPECT_EQ(walk.state.record.h_x, 0);
  EXPECT_NEAR(walk.value(walk.state.record.h_y, FormatId::plane_h_grad), 65535.0 / 16, 1e-5);
  // Vertex 1 is (16, 0), where u = 16 and q = 65535.
  EXPECT_EQ(walk.value(walk.state.record.gu1, FormatId::plane_g), 16 * 65535.0);
  ASSERT_EQ(rows.size(), 15U);
  for (const PlaneRowRecord& r : rows) {
    EXPECT_EQ(r.major_first, 0);
    EXPECT_EQ(r.minor_first, r.row);
    EXPECT_EQ(r.count, 15 - r.row);
    EXPECT_NEAR(walk.value(r.h, FormatId::span_h), 65535.0 / 16 * (static_cast<double>(r.row) + 0.5), 1e-4);
    EXPECT_EQ(r.phase, std::int64_t{1} << 19);  // 1/2
    EXPECT_EQ(walk.value(r.gu_step0, FormatId::span_f_step), 65535);
    EXPECT_EQ(r.gu_step1, r.gu_step0);  // nothing changes with y
    EXPECT_EQ(walk.value(r.gu, FormatId::span_f), 65535 * 0.5);
  }
}

// h depends on x alone: the axes are swapped.
TEST(PlaneWalk, WallSwapsTheAxes) {
  Walk walk(plane_config());
  const auto rows = walk(triangle(vertex(0, 0, 2), vertex(16, 0, 1), vertex(0, 16, 2)));
  EXPECT_EQ(walk.state.record.major, 1);
  EXPECT_EQ(walk.state.record.k, 0);
  ASSERT_EQ(rows.size(), 15U);
  EXPECT_EQ(rows[0].minor_first, 0);
  EXPECT_EQ(rows[0].count, 15);
}

// h along x + y: k = -1, rows step each pixel.
TEST(PlaneWalk, DiagonalRows) {
  Walk walk(plane_config());
  const auto rows = walk(triangle(vertex(0, 0, 2), vertex(16, 0, 1), vertex(0, 16, 1)));
  EXPECT_EQ(walk.state.record.major, 0);  // |nx| = |ny|
  EXPECT_EQ(walk.value(walk.state.record.k, FormatId::plane_k), -1);
  for (const PlaneRowRecord& r : rows) {
    EXPECT_EQ(r.major_first, 0);
    EXPECT_EQ(r.minor_first, r.row);
    EXPECT_EQ(r.count, r.row + 1);
  }
}

TEST(PlaneWalk, FlatTriangle) {
  Walk walk(plane_config());
  const auto rows = walk(triangle(vertex(0, 0, 1.5), vertex(16, 0, 1.5), vertex(0, 16, 1.5)));
  EXPECT_EQ(walk.state.record.k, 0);
  EXPECT_EQ(walk.state.record.major, 0);
  EXPECT_EQ(rows.size(), 15U);
}

// Every pixel inside is walked exactly once, and no other is marked covered: the rows tile the triangle.
void expect_tiling(FillRule rule, std::uint64_t seed) {
  Config c = plane_config();
  c.fill_rule = rule;
  constexpr int w = 40;
  constexpr int h = 30;
  Walk walk(c, w, h);
  std::mt19937_64 random(seed);
  std::uint64_t inside = 0;
  std::uint64_t between = 0;
  for (int i = 0; i < 2000; ++i) {
    const Triangle t = random_triangle(random, w, h, i % 3 == 0 ? 6 : (i % 3 == 1 ? 40 : 400));
    std::vector<int> hits(w * h, 0);
    std::vector<int> visits(w * h, 0);
    std::int64_t last_row = INT64_MIN;
    for (const PlaneRowRecord& r : walk(t)) {
      ASSERT_GT(r.row, last_row);
      last_row = r.row;
      // Walk the digital line from its definition, y = row + floor(k (m - m0) + 1/2).
      const double k = decoded(walk.state.record.k, c.format(FormatId::plane_k));
      for (std::int64_t n = 0; n < r.count; ++n) {
        const std::int64_t m = r.major_first + n;
        const std::int64_t minor =
            r.row + static_cast<std::int64_t>(
                        std::floor(k * static_cast<double>(m - walk.state.record.major_first) + 0.5));
        const std::int64_t x = walk.state.record.major == 0 ? m : minor;
        const std::int64_t y = walk.state.record.major == 0 ? minor : m;
        ASSERT_TRUE(x >= 0 && x < w && y >= 0 && y < h);
        const bool covered = model::covers(walk.state.geometry.coverage, x, y);
        if (n == 0 || n == r.count - 1) {
          ASSERT_TRUE(covered);  // rows begin and end on a covered pixel
        }
        ++visits[static_cast<std::size_t>(y * w + x)];
        hits[static_cast<std::size_t>(y * w + x)] += covered ? 1 : 0;
        between += covered ? 0 : 1;
      }
    }
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const bool want = centre_inside(t, c.subpixel_bits, rule, x, y);
        inside += want ? 1 : 0;
        ASSERT_EQ(hits[static_cast<std::size_t>(y * w + x)], want ? 1 : 0)
            << "seed " << seed << ", triangle " << i << ", pixel " << x << ", " << y;
        ASSERT_LE(visits[static_cast<std::size_t>(y * w + x)], 1);
      }
    }
  }
  EXPECT_GT(inside, 50000U);
  EXPECT_GT(between, 10U);
}

TEST(PlaneWalk, RowsTileTheTriangle) {
  expect_tiling(FillRule::top_left, 21);
  expect_tiling(FillRule::inclusive, 22);
}

// With wide formats the start values are those of the plane at the first pixel's centre, and the depth is
// that of the ideal line, half a pixel away at most.
TEST(PlaneWalk, StartValuesLieOnThePlane) {
  std::mt19937_64 random(23);
  for (const Numerator numerator : {Numerator::pixel_centre, Numerator::ideal_line}) {
    Config c = plane_config();
    c.numerator = numerator;
    Walk walk(c);
    int rows_seen = 0;
    for (int i = 0; i < 200; ++i) {
      const Triangle t = random_triangle(random, 64, 48, 60);
      for (const PlaneRowRecord& r : walk(t)) {
        ++rows_seen;
        const PlaneRecord& p = walk.state.record;
        const auto& s = walk.state.setup;
        const double x0 = std::ldexp(static_cast<double>(s.x0), -4);
        const double y0 = std::ldexp(static_cast<double>(s.y0), -4);
        const double k = walk.value(p.k, FormatId::plane_k);
        const double phase = std::ldexp(static_cast<double>(r.phase), -20);
        ASSERT_GE(phase, 0);
        ASSERT_LT(phase, 1);
        const double m = static_cast<double>(r.major_first) + 0.5;
        const double pixel = static_cast<double>(r.minor_first) + 0.5;
        const double line = pixel + phase - 0.5;  // the ideal line passes above or below the centre
        const double grid = numerator == Numerator::ideal_line ? line : pixel;
        const auto at = [&](double w0, double wx, double wy, double minor) {
          return p.major == 0 ? w0 + wx * (m - x0) + wy * (minor - y0)
                              : w0 + wx * (minor - x0) + wy * (m - y0);
        };
        const double h = at(walk.value(s.h0, FormatId::setup_h), walk.value(p.h_x, FormatId::plane_h_grad),
                            walk.value(p.h_y, FormatId::plane_h_grad), line);
        const double gu = at(walk.value(p.gu0, FormatId::plane_g), walk.value(p.gu_x, FormatId::plane_g_grad),
                             walk.value(p.gu_y, FormatId::plane_g_grad), grid);
        const double red =
            at(walk.value(s.r0, FormatId::setup_shade), walk.value(p.r_x, FormatId::plane_shade_grad),
               walk.value(p.r_y, FormatId::plane_shade_grad), pixel);
        ASSERT_NEAR(walk.value(r.h, FormatId::span_h), h, 1e-5);
        ASSERT_NEAR(walk.value(r.r, FormatId::span_shade_acc), red, 1e-5);
        if (std::abs(gu) < 1e8) {  // not where span.f saturates
          ASSERT_NEAR(walk.value(r.gu, FormatId::span_f), gu, 1e-3);
        }
        ASSERT_LE(std::abs(k), 1);
      }
    }
    EXPECT_GT(rows_seen, 1000);
  }
}

}  // namespace
}  // namespace bitspan
