// SPDX-License-Identifier: Apache-2.0
// The stages together, as the engine runs them.
#include "model/pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/engine_model.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

Scene random_scene_of(int triangles, std::uint64_t seed) {
  Scene s = worked_scene();
  s.background = {1, 2, 3};
  s.fog = Fog{{200, 200, 200}, 3};
  Texture image;
  image.name = "noise";
  image.width = 17;
  image.height = 5;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 4 * 17 * 5; ++i) {
    image.rgba.push_back(static_cast<std::uint8_t>(random()));
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 32) {
    image.rgba[i] = 0;  // each eighth texel is a hole
  }
  s.textures.push_back(image);
  for (int i = 0; i < triangles; ++i) {
    Triangle t = random_triangle(random, s.width, s.height, 40);
    t.texture = i % 3 == 0 ? -1 : 0;
    t.v[0].c[3] = i % 4 == 0 ? 0.5 : 1;
    s.triangles.push_back(t);
  }
  return s;
}

TEST(Pipeline, CountersMatchRecordsAndFrame) {
  const Scene scene = random_scene_of(200, 1);
  for (const Perspective mode : all_perspectives) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    c.edge_slope = SlopeForm::reciprocal;
    const auto engine = make_model(c);
    EXPECT_EQ(engine->name(), "model");
    engine->begin(scene);
    Trace trace;
    engine->draw(scene.triangles, 0, &trace);
    const Counters& k = engine->counters();
    EXPECT_EQ(trace.constants.size(), 1U);
    EXPECT_EQ(k.triangles, 200U);
    EXPECT_EQ(k.triangles - k.degenerate, trace.setup.size());
    EXPECT_EQ(k.rows, trace.row.size() + trace.plane_row.size());
    EXPECT_EQ(k.rows, trace.span.size());
    EXPECT_EQ(k.fragments, trace.fragment.size());
    EXPECT_EQ(k.covered, trace.depth.size());
    EXPECT_EQ(k.depth_passed, trace.texture.size());
    EXPECT_EQ(k.depth_passed - k.killed, trace.fog.size());
    EXPECT_EQ(k.written, trace.merge.size());
    EXPECT_GT(k.written, 1000U);
    EXPECT_GT(k.killed, 0U);
    const bool planes = mode == Perspective::const_depth_rows;
    if (planes) {
      EXPECT_EQ(k.divides_edge, 15 * trace.plane.size());
      EXPECT_EQ(k.divides_row, k.rows);
      EXPECT_EQ(k.divides_saved, static_cast<std::int64_t>(k.covered) - static_cast<std::int64_t>(k.rows));
    } else {
      EXPECT_EQ(k.divides_edge, trace.edge.size() + (mode == Perspective::affine ? 0 : 2) * trace.row.size());
      EXPECT_EQ(k.divides_saved, 0);
      EXPECT_EQ(k.fragments, k.covered);
    }
    EXPECT_EQ(k.divides_pixel, mode == Perspective::delta_f      ? k.fragments
                               : mode == Perspective::hyperbolic ? 2 * k.fragments
                                                                 : 0);
    // The frame holds what was merged last at each pixel.
    const Frame& f = engine->frame();
    std::vector<std::int64_t> last(f.triangle.size(), -1);
    for (const MergeRecord& m : trace.merge) {
      last[static_cast<std::size_t>(m.y * f.width + m.x)] = m.triangle;
    }
    for (std::size_t i = 0; i < last.size(); ++i) {
      ASSERT_EQ(f.triangle[i], last[i]);
      ASSERT_EQ(std::isnan(f.u[i]), last[i] < 0);
      ASSERT_EQ(f.color[4 * i + 3], 255);
      if (last[i] < 0) {
        ASSERT_EQ(f.color[4 * i], 1);
        ASSERT_EQ(f.depth[i], 0U);
      }
    }
  }
}

// Batches of any size, with a trace or without, again after begin: the same.
TEST(Pipeline, BatchesDoNotMatter) {
  const Scene scene = random_scene_of(60, 2);
  for (const Perspective mode : all_perspectives) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    const auto engine = make_model(c);
    engine->begin(scene);
    Trace whole;
    engine->draw(scene.triangles, 0, &whole);
    const auto color = engine->frame().color;
    const Counters counters = engine->counters();
    engine->begin(scene);
    Trace parts;
    engine->draw({}, 0, &parts);
    EXPECT_EQ(parts.constants.size(), 1U);
    const std::span<const Triangle> all(scene.triangles);
    engine->draw(all.first(7), 0, &parts);
    engine->draw(all.subspan(7), 7, &parts);
    EXPECT_EQ(parts.constants, whole.constants);
    EXPECT_EQ(parts.fragment, whole.fragment);
    EXPECT_EQ(parts.merge, whole.merge);
    EXPECT_EQ(engine->frame().color, color);
    EXPECT_EQ(engine->counters(), counters);
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    EXPECT_EQ(engine->frame().color, color);
    EXPECT_EQ(engine->counters(), counters);
  }
}

TEST(Pipeline, ObserversChangeNothingAndSeeEverything) {
  const Scene scene = random_scene_of(60, 3);
  for (const Perspective mode : all_perspectives) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    const auto plain = make_model(c);
    const auto observed = make_observed_model(c);
    plain->begin(scene);
    observed->begin(scene);
    Trace a;
    Trace b;
    plain->draw(scene.triangles, 0, &a);
    observed->draw(scene.triangles, 0, &b);
    EXPECT_EQ(a.fragment, b.fragment);
    EXPECT_EQ(a.merge, b.merge);
    EXPECT_EQ(plain->frame().color, observed->frame().color);
    const model::Statistics& s = observed->statistics();
    EXPECT_EQ(s.of(FormatId::setup_h).count, 180U);
    EXPECT_EQ(s.of(model::RegisterId::coordinate).count, 360U);
    EXPECT_EQ(s.of(FormatId::span_uv).count, 2 * a.fragment.size());
    EXPECT_EQ(s.of(model::RegisterId::depth_z).count, a.depth.size());
    EXPECT_EQ(s.of(FormatId::merge_color).count, 3 * a.merge.size());
    EXPECT_EQ(s.of(FormatId::fog_factor).count, 1024U);
    // The range is that of the records where nothing overflowed.
    const auto& uv = s.of(FormatId::span_uv);
    ASSERT_EQ(uv.saturations, 0U);
    std::int64_t low = INT64_MAX;
    std::int64_t high = INT64_MIN;
    for (const FragmentRecord& f : a.fragment) {
      low = std::min({low, f.u, f.v});
      high = std::max({high, f.u, f.v});
    }
    EXPECT_EQ(uv.min, low);
    EXPECT_EQ(uv.max, high);
    observed->begin(scene);
    EXPECT_EQ(observed->statistics().of(FormatId::span_uv).count, 0U);
  }
}

TEST(Pipeline, RefusesBadTriangles) {
  Scene scene = random_scene_of(1, 4);
  const auto engine = make_model(shipped_config("depth16"));
  const auto expect_refused = [&](auto spoil) {
    Scene bad = scene;
    spoil(bad.triangles[0]);
    engine->begin(bad);
    EXPECT_THROW(engine->draw(bad.triangles, 0, nullptr), InputError);
  };
  const double nan = std::nan("");
  expect_refused([&](Triangle& t) { t.v[0].x = nan; });
  expect_refused([&](Triangle& t) { t.v[1].y = INFINITY; });
  expect_refused([&](Triangle& t) { t.v[2].u = -INFINITY; });
  expect_refused([&](Triangle& t) { t.v[2].v = nan; });
  expect_refused([&](Triangle& t) { t.v[0].s = 0.99; });
  expect_refused([&](Triangle& t) { t.v[0].s = 2.01; });
  expect_refused([&](Triangle& t) { t.v[0].s = nan; });
  expect_refused([&](Triangle& t) { t.v[0].c[2] = 1.01; });
  expect_refused([&](Triangle& t) { t.v[0].c[3] = nan; });
  expect_refused([&](Triangle& t) { t.texture = 1; });
}

TEST(Pipeline, RefusesBadScenes) {
  const auto engine = make_model(shipped_config("depth16"));
  Scene scene = random_scene_of(1, 5);
  scene.width = 0;
  EXPECT_THROW(engine->begin(scene), InputError);
  scene = random_scene_of(1, 5);
  scene.textures[0].rgba.pop_back();
  EXPECT_THROW(engine->begin(scene), InputError);
  scene = random_scene_of(1, 5);
  scene.textures[0].height = 0;
  EXPECT_THROW(engine->begin(scene), InputError);
}

// The three steps by hand, as an engine with its own span unit takes them, give the model's frame.
TEST(Pipeline, StepsCanBeTakenApart) {
  const Scene scene = random_scene_of(40, 6);
  for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    const auto engine = make_model(c);
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);

    const model::Pipeline pipeline = model::make_pipeline(c, scene);
    Frame frame = model::cleared_frame(pipeline, scene);
    Counters counters;
    model::PlaneWalkState walk;
    model::Rows rows;  // of all triangles at once
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      model::triangle_to_rows(pipeline, scene.triangles[i], static_cast<std::int64_t>(i), walk, rows,
                              counters, nullptr);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const SpanRecord span = model::row_to_span(pipeline, rows, i, counters);
      std::vector<FragmentRecord> fragments;
      model::span_to_fragments(pipeline, span, model::geometry_of(rows, i), fragments, counters);
      const Triangle& t = scene.triangles[static_cast<std::size_t>(span.triangle)];
      model::fragments_to_frame(pipeline, scene, fragments, {.texture = t.texture}, nullptr, frame, counters,
                                nullptr);
    }
    EXPECT_EQ(frame.color, engine->frame().color);
    EXPECT_EQ(frame.depth, engine->frame().depth);
    EXPECT_EQ(counters, engine->counters());
  }
}

}  // namespace
}  // namespace bitspan
