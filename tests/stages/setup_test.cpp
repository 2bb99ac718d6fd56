// SPDX-License-Identifier: Apache-2.0
#include "model/stages/setup.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Stage {
  explicit Stage(const Config& c = plain_config())
      : config(c), stage(model::prepare_setup(c, model::make_constants(c, worked_scene()))) {}
  SetupRecord operator()(const Triangle& t) const {
    SetupRecord r;
    EXPECT_TRUE(model::setup(stage, t, 7, r));
    return r;
  }
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  Config config;
  model::SetupStage stage;
};

TEST(Setup, SnapsHalfUp) {
  const Stage setup;
  const SetupRecord r = setup(triangle(vertex(-1.0 / 32, 1.0 / 32), vertex(10.03, 0.99), vertex(3, 20)));
  // -1/32 and 1/32 are ties on the 1/16 grid: up, to 0 and to 1/16.
  EXPECT_EQ(r.x0, 0);
  EXPECT_EQ(r.y0, 1);
  EXPECT_EQ(r.x1, 160);  // 160.48
  EXPECT_EQ(r.y1, 16);   // 15.84
  EXPECT_EQ(r.triangle, 7);
}

TEST(Setup, EnormousCoordinatesSaturate) {
  const Stage setup;
  const SetupRecord r = setup(triangle(vertex(-1e300, 0), vertex(1e18, 1), vertex(0, 1e9)));
  EXPECT_EQ(r.x0, -(1 << 19));
  EXPECT_EQ(r.x1, (1 << 19) - 1);
  EXPECT_EQ(r.y2, (1 << 19) - 1);
}

TEST(Setup, DepthCodes) {
  const Stage setup;
  const SetupRecord r = setup(triangle(vertex(0, 0, 2), vertex(8, 1, 1.5), vertex(0, 9, 1)));
  EXPECT_EQ(setup.value(r.h0, FormatId::setup_h), 0);
  // s' = 0.75 exactly: 65535 (1 - 0.75) / 0.75
  EXPECT_EQ(setup.value(r.h1, FormatId::setup_h), 21845);
  EXPECT_EQ(setup.value(r.h2, FormatId::setup_h), 65535);
}

TEST(Setup, SortsByRowThenColumnThenInput) {
  const Stage setup;
  std::array<Vertex, 3> v{vertex(5, 3, 2, 1), vertex(2, 3, 2, 2), vertex(4, 1, 2, 3)};
  std::sort(v.begin(), v.end(), [](const Vertex& a, const Vertex& b) { return a.u < b.u; });
  do {
    const SetupRecord r = setup(triangle(v[0], v[1], v[2]));
    EXPECT_EQ(setup.value(r.u0, FormatId::setup_uv), 3);
    EXPECT_EQ(setup.value(r.u1, FormatId::setup_uv), 2);
    EXPECT_EQ(setup.value(r.u2, FormatId::setup_uv), 1);
    // Vertex 1 = (2, 3) lies left of the edge from (4, 1) to (5, 3), whatever the winding.
    EXPECT_EQ(r.mid_right, 0);
  } while (
      std::next_permutation(v.begin(), v.end(), [](const Vertex& a, const Vertex& b) { return a.u < b.u; }));
}

TEST(Setup, NoAreaNoRecord) {
  const Stage setup;
  SetupRecord r;
  EXPECT_FALSE(model::setup(setup.stage, triangle(vertex(0, 0), vertex(4, 4), vertex(8, 8)), 0, r));
  EXPECT_FALSE(model::setup(setup.stage, triangle(vertex(3, 3), vertex(3, 3), vertex(8, 1)), 0, r));
  // An area, but less than the grid shows.
  EXPECT_FALSE(model::setup(setup.stage, triangle(vertex(0, 0), vertex(0.01, 0), vertex(0, 9)), 0, r));
  EXPECT_TRUE(model::setup(setup.stage, triangle(vertex(0, 0), vertex(0.0625, 0), vertex(0, 9)), 0, r));
}

TEST(Setup, EdgesWithHeightInOrder) {
  const Stage setup;
  const auto edges_of = [&](const Triangle& t) {
    std::vector<std::int64_t> out;
    const model::Edges e = model::setup_edges(setup.stage, setup(t));
    for (int i = 0; i < e.count; ++i) {
      out.push_back(e.edge[static_cast<std::size_t>(i)].edge);
    }
    return out;
  };
  using List = std::vector<std::int64_t>;
  EXPECT_EQ(edges_of(triangle(vertex(0, 0), vertex(8, 4), vertex(0, 8))), (List{0, 1, 2}));
  EXPECT_EQ(edges_of(triangle(vertex(0, 0), vertex(8, 0), vertex(0, 8))), (List{0, 2}));
  EXPECT_EQ(edges_of(triangle(vertex(0, 0), vertex(8, 8), vertex(0, 8))), (List{0, 1}));
}

TEST(Setup, SlopesWorked) {
  Config c = plain_config();
  c.edge_walk = EdgeWalk::dda;
  const Stage setup(c);
  EXPECT_EQ(setup.stage.divides_per_edge, 8);
  Triangle t = triangle(vertex(0, 0, 2, 10), vertex(8, 0, 2, 10), vertex(4, 8, 1, 30));
  t.v[2].c = {0.5, 1, 0.25, 1};
  const model::Edges e = model::setup_edges(setup.stage, setup(t));
  ASSERT_EQ(e.count, 2);
  const EdgeRecord& first = e.edge[0];
  EXPECT_EQ(first.recip_m, 0);
  EXPECT_EQ(setup.value(first.x_step, FormatId::edge_x_step), 0.5);
  EXPECT_EQ(setup.value(first.h_step, FormatId::edge_h_step), 65535.0 / 8);
  // (30 - 10)(65535 + 65535)
  EXPECT_EQ(setup.value(first.fu_diff, FormatId::edge_f_diff), 20.0 * 131070);
  EXPECT_EQ(setup.value(first.fu_step, FormatId::edge_f_step), 20.0 * 131070 / 8);
  EXPECT_EQ(setup.value(first.r_step, FormatId::edge_shade_step), -1.0 / 16);
  EXPECT_EQ(first.g_step, 0);
  EXPECT_EQ(setup.value(first.b_step, FormatId::edge_shade_step), -0.75 / 8);
  EXPECT_EQ(setup.value(e.edge[1].x_step, FormatId::edge_x_step), -0.5);
}

TEST(Setup, AffineLeavesOutTheDivisor) {
  Config c = plain_config();
  c.perspective = Perspective::affine;
  const Stage setup(c);
  const model::Edges e = model::setup_edges(
      setup.stage, setup(triangle(vertex(0, 0, 2, 10), vertex(8, 0), vertex(4, 8, 1, 30))));
  EXPECT_EQ(setup.value(e.edge[0].fu_diff, FormatId::edge_f_diff), 20.0);
  EXPECT_EQ(setup.value(e.edge[0].fu_step, FormatId::edge_f_step), 2.5);
  EXPECT_EQ(e.edge[0].x_step, 0);  // exact walk
  EXPECT_EQ(setup.stage.divides_per_edge, 7);
}

// dy = 3: 1/1.5 to 4 fraction bits is 11/16 rounded half up, so a slope of 6 is 6 (11/16) / 2.
TEST(Setup, SlopeByAReciprocal) {
  Config c = plain_config();
  c.edge_slope = SlopeForm::reciprocal;
  c.edge_reciprocal.output = {5, 1, false, Rounding::rnd, Overflow::sat, false};
  const Stage setup(c);
  EXPECT_EQ(setup.stage.divides_per_edge, 1);
  Triangle t = triangle(vertex(0, 0), vertex(8, 0), vertex(4, 3));
  for (int i = 0; i < 2; ++i) {
    t.v[static_cast<std::size_t>(i)].c[0] = 0;
  }
  const model::Edges e = model::setup_edges(setup.stage, setup(t));
  EXPECT_EQ(e.edge[0].recip_m, 11);
  EXPECT_EQ(e.edge[0].recip_e, 1);
  EXPECT_EQ(setup.value(e.edge[0].r_step, FormatId::edge_shade_step), 11.0 / 32);
}

}  // namespace
}  // namespace bitspan
