// SPDX-License-Identifier: Apache-2.0
#include "model/stages/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "model/pipeline.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Drawn {
  Trace trace;
  Counters counters;
  Frame frame;
};

Drawn drawn(const Config& config, const Scene& scene) {
  Drawn out;
  const model::Pipeline pipeline = model::make_pipeline(config, scene);
  out.frame = model::cleared_frame(pipeline, scene);
  model::DrawBuffers buffers;
  model::draw_triangles(pipeline, scene, scene.triangles, 0, false, buffers, out.frame, out.counters,
                        &out.trace);
  return out;
}

Scene random_fog() {
  RandomOptions options;
  options.width = 60;
  options.height = 44;
  options.triangles = 40;
  options.size_max = 50;
  options.fog_probability = 1;
  return random_scene(7, options);
}

// fog.mode = vertex, with the registers of red for those of the channel, which takes no start offset.
Config as_red(const std::string& name) {
  Config c = shipped_config(name);
  c.fog = FogMode::vertex;
  c.start_offset.edge_shade = c.start_offset.span_shade = {};
  const auto same = [&](FormatId to, FormatId from) { c.format(to) = c.format(from); };
  same(FormatId::fog_vertex, FormatId::setup_shade);
  same(FormatId::fog_grad, FormatId::plane_shade_grad);
  same(FormatId::fog_step, FormatId::span_shade_step);
  same(FormatId::fog_acc, FormatId::span_shade_acc);
  same(FormatId::edge_shade_step, FormatId::span_shade_step);
  same(FormatId::edge_shade_acc, FormatId::span_shade_acc);
  same(FormatId::edge_shade, FormatId::span_shade_acc);
  same(FormatId::fog_factor, FormatId::span_shade);
  return c;
}

struct Way {
  Perspective perspective;
  SlopeForm edge;
  RowSlope row;
};
std::vector<Way> all_ways() {
  std::vector<Way> out;
  for (const Perspective p : all_perspectives) {
    for (const SlopeForm edge : {SlopeForm::divide, SlopeForm::reciprocal}) {
      for (const RowSlope row : {RowSlope::divide, RowSlope::reciprocal, RowSlope::plane}) {
        if (has_plane_rows(p) && row == RowSlope::plane) continue;
        out.push_back({p, edge, row});
      }
    }
  }
  return out;
}

// The shades are walked by code of their own, so they are a second way to the same numbers.
TEST(Channel, GoesAsAShadeOfTheSameValuesInEveryMode) {
  Scene scene = random_fog();
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.fog = v.c[0];
  }
  for (const Way& way : all_ways()) {
    Config config = as_red("depth20");
    config.perspective = way.perspective;
    config.edge_slope = way.edge;
    config.row_slope = way.row;
    const Drawn d = drawn(config, scene);
    const Trace& t = d.trace;
    const std::string name = std::string(to_string(way.perspective)) + " " +
                             std::string(to_string(way.edge)) + " " + std::string(to_string(way.row));
    ASSERT_EQ(t.setup_channel.size(), t.setup.size()) << name;
    ASSERT_EQ(t.span_channel.size(), t.span.size()) << name;
    ASSERT_EQ(t.fragment_channel.size(), t.fragment.size()) << name;
    const bool has_ends = !has_plane_rows(way.perspective) && way.row != RowSlope::plane;
    ASSERT_EQ(t.row_channel.size(), has_ends ? t.row.size() : 0) << name;
    ASSERT_GT(t.fragment.size(), 1000U) << name;
    int differences = 0;
    for (std::size_t i = 0; i < t.setup.size(); ++i) {
      const SetupChannelRecord& c = t.setup_channel[i];
      differences += c.w0 != t.setup[i].r0 || c.w1 != t.setup[i].r1 || c.w2 != t.setup[i].r2;
      EXPECT_EQ(c.triangle, t.setup[i].triangle);
      EXPECT_TRUE(c.f0 == 0 && c.f1 == 0 && c.f2 == 0);
      if (has_plane_rows(way.perspective)) {
        differences += c.w_x != t.plane[i].r_x || c.w_y != t.plane[i].r_y;
      } else if (!has_ends) {
        differences += c.w_x != t.setup_plane[i].r_x || c.w_y != t.setup_plane[i].r_y;
      }
    }
    for (std::size_t i = 0; i < t.row_channel.size(); ++i) {
      const RowChannelRecord& c = t.row_channel[i];
      differences += c.l_acc != t.row[i].l_r_acc || c.l != t.row[i].l_r || c.r_acc != t.row[i].r_r_acc ||
                     c.r != t.row[i].r_r || c.y != t.row[i].y;
    }
    for (std::size_t i = 0; i < t.span.size(); ++i) {
      const SpanChannelRecord& c = t.span_channel[i];
      differences += c.w != t.span[i].r || c.w_step0 != t.span[i].r_step0 || c.w_step1 != t.span[i].r_step1;
    }
    for (std::size_t i = 0; i < t.fragment.size(); ++i) {
      differences += t.fragment_channel[i].w != t.fragment[i].r;
    }
    auto at = t.fragment.begin();  // of the fog's record: both come in one order
    for (const FogRecord& fog : t.fog) {
      while (at->triangle != fog.triangle || at->x != fog.x || at->y != fog.y) ++at;
      differences += fog.factor != at->r || fog.index != -1;
      ++at;
    }
    EXPECT_EQ(differences, 0) << name;
  }
}

// Of each slope one divide more, and nothing else.
TEST(Channel, CountsItsDivides) {
  const Scene scene = random_fog();
  for (const Way& way : all_ways()) {
    Config config = as_red("depth16");
    config.perspective = way.perspective;
    config.edge_slope = way.edge;
    config.row_slope = way.row;
    const Drawn with = drawn(config, scene);
    config.fog = FogMode::none;
    const Drawn without = drawn(config, scene);
    EXPECT_TRUE(without.trace.setup_channel.empty() && without.trace.fragment_channel.empty());
    const bool planes = has_plane_rows(way.perspective) || way.row == RowSlope::plane;
    const bool divides = has_plane_rows(way.perspective) || way.edge == SlopeForm::divide;
    const std::uint64_t edges = !divides ? 0 : planes ? 2 * with.trace.setup.size() : with.trace.edge.size();
    EXPECT_EQ(with.counters.divides_edge - without.counters.divides_edge, edges);
    std::uint64_t rows = 0;
    if (!planes && way.row == RowSlope::divide) {
      for (const RowRecord& row : with.trace.row) rows += row.r_x > row.l_x ? 1 : 0;
    }
    EXPECT_EQ(with.counters.divides_row - without.counters.divides_row, rows);
    EXPECT_EQ(with.counters.divides_pixel, without.counters.divides_pixel);
    EXPECT_EQ(with.trace.span, without.trace.span);
    EXPECT_EQ(with.trace.fragment, without.trace.fragment);
    EXPECT_EQ(with.trace.depth, without.trace.depth);
  }
}

// Without a factor of the stream, and where a triangle gives one.
TEST(Channel, OfAVertexIsExpOfItsDistanceOrWhatIsGiven) {
  Config config = plain_config();
  config.fog = FogMode::vertex;
  config.format(FormatId::fog_vertex) = {22, 2, true, Rounding::rnd, Overflow::sat, false};
  Scene scene = worked_scene();
  scene.fog = Fog{{200, 100, 0}, 1.5};
  scene.triangles = {triangle(vertex(40, 3, 1.25), vertex(5, 30, 2), vertex(50, 40, 1))};
  Triangle& t = scene.triangles[0];
  const auto values = [&] {
    const Drawn d = drawn(config, scene);
    const SetupChannelRecord& r = d.trace.setup_channel.at(0);
    return std::array{r.w0, r.w1, r.w2};
  };
  // In the order of (y, x).
  std::array<Vertex, 3> sorted = t.v;
  std::ranges::sort(sorted, {}, [](const Vertex& v) { return std::pair(v.y, v.x); });
  const auto computed = values();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(computed[i], std::llround(std::ldexp(std::exp(-sorted[i].s / 1.5), 20))) << i;
  }
  t.v[0].fog = 0.25;
  t.v[1].fog = 1;
  t.v[2].fog = 0;
  const auto given = values();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto* const at =
        std::ranges::find_if(t.v, [&](const Vertex& v) { return v.x == sorted[i].x && v.y == sorted[i].y; });
    EXPECT_EQ(given[i], std::llround(std::ldexp(at->fog, 20))) << i;
  }
  t.v[2].fog = -1;
  EXPECT_THROW(drawn(config, scene), InputError);
}

TEST(Channel, IsInUseOnlyInASceneWithFogInItsMode) {
  Scene scene = random_fog();
  Config config = shipped_config("depth16");
  EXPECT_TRUE(drawn(config, scene).trace.fragment_channel.empty());
  config.fog = FogMode::vertex;
  EXPECT_FALSE(drawn(config, scene).trace.fragment_channel.empty());
  scene.fog.reset();
  const Drawn clear = drawn(config, scene);
  EXPECT_TRUE(clear.trace.fragment_channel.empty());
  EXPECT_EQ(clear.trace.fog.at(0).factor, std::int64_t{1} << config.format(FormatId::fog_factor).fraction());
}

}  // namespace
}  // namespace bitspan
