// SPDX-License-Identifier: Apache-2.0
#include "model/stages/edge_walk.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

// setup and the whole walk over a triangle.
struct Walk {
  explicit Walk(const Config& c, int w = 64, int h = 48) : config(c) {
    const model::Constants k = model::make_constants(c, worked_scene());
    setup_stage = model::prepare_setup(c, k);
    stage = model::prepare_edge_walk(c, k, w, h);
  }
  std::vector<RowRecord> operator()(const Triangle& t) {
    std::vector<RowRecord> rows;
    SetupRecord vertices;
    if (!model::setup(setup_stage, t, 3, vertices)) {
      return rows;
    }
    edges = model::setup_edges(setup_stage, vertices);
    model::EdgeWalkState state = model::start_edge_walk(stage, vertices, edges);
    RowRecord row;
    while (!model::finished(state)) {
      if (model::edge_walk(stage, state, row)) {
        rows.push_back(row);
      }
    }
    return rows;
  }
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  Config config;
  model::SetupStage setup_stage;
  model::EdgeWalkStage stage;
  model::Edges edges;
};

TEST(EdgeWalk, WorkedExample) {
  Walk walk(plain_config());
  Triangle t = triangle(vertex(0, 0, 2, 0), vertex(8, 0, 2, 16), vertex(0, 8, 1, 0));
  t.v[0].c[0] = 0;
  t.v[1].c[0] = 1;
  t.v[2].c[0] = 0;
  const auto rows = walk(t);
  // Row 7 ends at 1/2: its first centre lies on the right edge, outside.
  ASSERT_EQ(rows.size(), 7U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RowRecord& r = rows[i];
    const double y = static_cast<double>(i) + 0.5;
    EXPECT_EQ(r.triangle, 3);
    EXPECT_EQ(r.y, static_cast<std::int64_t>(i));
    EXPECT_EQ(r.x_first, 0);
    EXPECT_EQ(r.x_last, 6 - r.y);  // the centre at x = 7.5 - y lies on the right edge: outside
    EXPECT_EQ(r.l_edge, 0);
    EXPECT_EQ(r.r_edge, 2);
    EXPECT_EQ(walk.value(r.l_x, FormatId::edge_x), 0);
    EXPECT_EQ(walk.value(r.r_x, FormatId::edge_x), 8 - y);
    EXPECT_EQ(r.l_x_acc, 0);
    EXPECT_EQ(walk.value(r.l_h, FormatId::edge_h), 65535.0 / 8 * y);
    EXPECT_EQ(walk.value(r.r_h, FormatId::edge_h), 65535.0 / 8 * y);
    // u on the right edge: 16 at h = 0, 0 at h = 65535, over q = h + 65535: (16 / q')(1 - t) with
    // 1/S linear: u = 16 (1 - t) 65535 / (65535 (1 + t)).
    const double along = y / 8;
    EXPECT_NEAR(walk.value(r.r_u, FormatId::edge_uv), 16 * (1 - along) / (1 + along), 1e-4);
    EXPECT_EQ(r.l_u, 0);
    EXPECT_NEAR(walk.value(r.r_r, FormatId::edge_shade), 1 - along, 1e-5);
    EXPECT_EQ(r.l_r, 0);
  }
}

TEST(EdgeWalk, InclusiveDrawsBothEnds) {
  Config c = plain_config();
  c.fill_rule = FillRule::inclusive;
  Walk walk(c);
  const auto rows = walk(triangle(vertex(0.5, 0.5), vertex(4.5, 0.5), vertex(0.5, 4.5)));
  ASSERT_EQ(rows.size(), 5U);
  for (const RowRecord& r : rows) {
    EXPECT_EQ(r.x_first, 0);
    EXPECT_EQ(r.x_last, 4 - r.y);
  }
}

TEST(EdgeWalk, ClipsToTheViewport) {
  Walk walk(plain_config());
  const auto rows = walk(triangle(vertex(-1000, -1000), vertex(3000, -1000), vertex(-1000, 3000)));
  ASSERT_EQ(rows.size(), 48U);
  EXPECT_EQ(rows.front().y, 0);
  for (const RowRecord& r : rows) {
    EXPECT_EQ(r.x_first, 0);
    EXPECT_EQ(r.x_last, 63);
    // x = 3000 - (y + 1000) = 2000 - y, also where the walk begins far below the edge's start
    EXPECT_EQ(walk.value(r.r_x, FormatId::edge_x), 2000 - (static_cast<double>(r.y) + 0.5));
  }
  EXPECT_TRUE(walk(triangle(vertex(-10, -10), vertex(-5, 5), vertex(-10, 30))).empty());
  EXPECT_TRUE(walk(triangle(vertex(10, 48), vertex(5, 55), vertex(20, 60))).empty());
}

// Every pixel of the viewport against signed areas.
void expect_exact_coverage(FillRule rule, int subpixel_bits, std::uint64_t seed) {
  Config c = plain_config();
  c.fill_rule = rule;
  c.subpixel_bits = subpixel_bits;
  constexpr int w = 40;
  constexpr int h = 30;
  Walk walk(c, w, h);
  std::mt19937_64 random(seed);
  std::uint64_t inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Triangle t = random_triangle(random, w, h, i % 3 == 0 ? 6 : (i % 3 == 1 ? 40 : 400));
    std::vector<bool> covered(w * h, false);
    for (const RowRecord& r : walk(t)) {
      for (std::int64_t x = r.x_first; x <= r.x_last; ++x) {
        covered[static_cast<std::size_t>(r.y * w + x)] = true;
      }
    }
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const bool want = centre_inside(t, subpixel_bits, rule, x, y);
        inside += want ? 1 : 0;
        ASSERT_EQ(covered[static_cast<std::size_t>(y * w + x)], want)
            << "seed " << seed << ", triangle " << i << ", pixel " << x << ", " << y;
      }
    }
  }
  EXPECT_GT(inside, 50000U);
}

TEST(EdgeWalk, CoverageIsExactTopLeft) {
  expect_exact_coverage(FillRule::top_left, 4, 1);
  expect_exact_coverage(FillRule::top_left, 0, 2);
  expect_exact_coverage(FillRule::top_left, 8, 3);
}
TEST(EdgeWalk, CoverageIsExactInclusive) {
  expect_exact_coverage(FillRule::inclusive, 4, 4);
  expect_exact_coverage(FillRule::inclusive, 1, 5);
}

// A grid of triangles with jittered inner vertices, many of them on centres: every pixel exactly once.
TEST(EdgeWalk, AMeshHasNeitherGapNorDoubleHit) {
  constexpr int n = 12;
  constexpr int w = 48;
  Walk walk(plain_config(), w, w);
  std::mt19937_64 random(6);
  for (int round = 0; round < 20; ++round) {
    std::vector<Vertex> grid;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const auto jitter = [&](int k) {
          return k == 0 || k == n ? 0.0 : static_cast<double>(random() % 5) / 2 - 1.0;
        };
        grid.push_back(vertex(4.0 * i + jitter(i), 4.0 * j + jitter(j)));
      }
    }
    std::vector<int> hits(w * w, 0);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const auto at = [&](int a, int b) {
          return grid[static_cast<std::size_t>((j + b) * (n + 1) + i + a)];
        };
        // Jitter of at most 1 of 4 pixels turns neither triangle over.
        for (const Triangle& t :
             {triangle(at(0, 0), at(1, 0), at(1, 1)), triangle(at(0, 0), at(1, 1), at(0, 1))}) {
          for (const RowRecord& r : walk(t)) {
            for (std::int64_t x = r.x_first; x <= r.x_last; ++x) {
              ++hits[static_cast<std::size_t>(r.y * w + x)];
            }
          }
        }
      }
    }
    int wrong = 0;
    for (const int count : hits) {
      wrong += count != 1 ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0) << "round " << round;
  }
}

// The registers are what the recurrences of the specification say, from one record to the next.
TEST(EdgeWalk, AccumulatesAndMultiplies) {
  std::mt19937_64 random(8);
  for (const DdaUpdate update : {DdaUpdate::accumulate, DdaUpdate::multiply}) {
    Config c = shipped_config("depth16");
    c.edge_walk = EdgeWalk::dda;
    c.dda_update = update;
    c.start_offset.edge_x = {true, 0};
    c.format(FormatId::edge_x_step) = {18, 8, true, Rounding::rnd, Overflow::sat, false};
    c.format(FormatId::edge_x_acc) = {26, 12, true, Rounding::rnd_conv, Overflow::sat, false};
    Walk walk(c);
    int steps = 0;
    for (int i = 0; i < 300; ++i) {
      const auto rows = walk(random_triangle(random, 64, 48, 60));
      for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
        const RowRecord& a = rows[k];
        const RowRecord& b = rows[k + 1];
        if (b.y != a.y + 1 || a.l_edge != b.l_edge) {
          continue;
        }
        const EdgeRecord* edge = nullptr;
        for (int n = 0; n < walk.edges.count; ++n) {
          const EdgeRecord& candidate = walk.edges.edge[static_cast<std::size_t>(n)];
          edge = candidate.edge == a.l_edge ? &candidate : edge;
        }
        ASSERT_NE(edge, nullptr);
        ++steps;
        // x_acc has 14 fraction bits, its step 10: nothing is rounded in a step of `accumulate`.
        if (update == DdaUpdate::accumulate) {
          ASSERT_EQ(b.l_x_acc, a.l_x_acc + (edge->x_step << 4));
        } else {
          ASSERT_NEAR(static_cast<double>(b.l_x_acc - a.l_x_acc),
                      std::ldexp(static_cast<double>(edge->x_step), 4), 1);
        }
        // h_acc and its step have one grid; h drops two bits by truncation.
        ASSERT_EQ(b.l_h_acc, std::min(a.l_h_acc + edge->h_step, (std::int64_t{1} << 36) - 1));
        ASSERT_EQ(a.l_h, a.l_h_acc >> 2);
        ASSERT_EQ(b.l_fu, a.l_fu + edge->fu_step);
      }
    }
    EXPECT_GT(steps, 1000);
  }
}

TEST(EdgeWalk, CountsReciprocals) {
  Config c = plain_config();
  EXPECT_EQ(Walk(c).stage.divides_per_row, 2);
  c.perspective = Perspective::affine;
  EXPECT_EQ(Walk(c).stage.divides_per_row, 0);
}

// 16384 pixels wide, partly on the screen; a sliver; and one pixel.
TEST(EdgeWalk, ExtremeTriangles) {
  Walk walk(plain_config());
  const std::vector<Triangle> extreme{
      triangle(vertex(-8192, -3.0625), vertex(8192, 20.5), vertex(-8000, 47.9375)),
      triangle(vertex(0, 10.4375), vertex(16384, 10.5), vertex(1, 10.5625)),
      triangle(vertex(5.4375, 5.4375), vertex(5.5625, 5.5), vertex(5.4375, 5.5625)),
      triangle(vertex(30.5, -32000), vertex(30.5625, 32000), vertex(30.5, 32000))};
  for (const Triangle& t : extreme) {
    std::vector<bool> covered(64 * 48, false);
    for (const RowRecord& r : walk(t)) {
      for (std::int64_t x = r.x_first; x <= r.x_last; ++x) {
        covered[static_cast<std::size_t>(r.y * 64 + x)] = true;
      }
    }
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(covered[static_cast<std::size_t>(y * 64 + x)],
                  centre_inside(t, 4, FillRule::top_left, x, y));
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
