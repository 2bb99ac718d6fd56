// SPDX-License-Identifier: Apache-2.0
// The engine `rtl` against the engine `model` over random triangles: every record and the frame.
#include "tb/engine_rtl.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/engine_model.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene random_scene(std::uint64_t seed, int triangles) {
  Random random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Scene scene;
  scene.width = 96;
  scene.height = 64;
  scene.s_min = 2;
  scene.s_max = 500;
  Texture texture;
  texture.name = "noise";
  texture.width = 16;
  texture.height = 8;
  for (int i = 0; i < 16 * 8 * 4; ++i) texture.rgba.push_back(static_cast<std::uint8_t>(random() % 256));
  scene.textures.push_back(texture);
  for (int i = 0; i < triangles; ++i) {
    Triangle t;
    t.texture = i % 3 == 0 ? -1 : 0;
    // From a pixel to more than the screen.
    const double size = std::exp2(unit(random) * 8);
    const double x = unit(random) * scene.width;
    const double y = unit(random) * scene.height;
    for (Vertex& v : t.v) {
      v.x = x + (unit(random) - 0.5) * size;
      v.y = y + (unit(random) - 0.5) * size;
      v.s = scene.s_min * std::pow(scene.s_max / scene.s_min, unit(random));
      v.u = (unit(random) - 0.5) * 200;
      v.v = (unit(random) - 0.5) * 200;
      for (double& c : v.c) c = unit(random);
    }
    scene.triangles.push_back(t);
  }
  return scene;
}

void compare(const Config& config, const Scene& scene) {
  const auto model = make_model(config);
  const auto rtl = make_rtl(config, {11, 0.2, 0.3});
  Trace expected;
  Trace got;
  model->begin(scene);
  model->draw(scene.triangles, 0, &expected);
  rtl->begin(scene);
  rtl->draw(scene.triangles, 0, &got);
#define BITSPAN_COMPARE(Record, LIST, stage, member)             \
  EXPECT_EQ(got.member.size(), expected.member.size()) << stage; \
  EXPECT_TRUE(got.member == expected.member) << stage;
  BITSPAN_RECORDS(BITSPAN_COMPARE)
#undef BITSPAN_COMPARE
  EXPECT_GT(expected.fragment.size(), 1000U);
  EXPECT_EQ(rtl->frame().color, model->frame().color);
  EXPECT_EQ(rtl->frame().depth, model->frame().depth);
  EXPECT_EQ(rtl->frame().triangle, model->frame().triangle);
  Counters counters = rtl->counters();
  EXPECT_GT(counters.cycles, counters.fragments);
  counters.cycles = model->counters().cycles;
  EXPECT_EQ(counters, model->counters());

  // In two draws, of a new run, it is the same.
  Trace again;
  rtl->begin(scene);
  const std::span<const Triangle> triangles(scene.triangles);
  rtl->draw(triangles.first(10), 0, &again);
  rtl->draw(triangles.subspan(10), 10, &again);
  EXPECT_TRUE(again.fragment == expected.fragment);
  EXPECT_TRUE(again.merge == expected.merge);
}

TEST(EngineRtl, EqualsTheModel) {
  for (const std::string& name : shipped_names) {
    for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
      SCOPED_TRACE(name + ", " + std::string(to_string(mode)));
      Config c = shipped_config(name);
      c.perspective = mode;
      compare(c, random_scene(3, 120));
    }
  }
}

TEST(EngineRtl, EqualsTheModelInRandomConfigurations) {
  Random random(77);
  int drawn = 0;
  while (drawn < 3) {
    const Config c = random_rtl_config(random);
    const Scene scene = random_scene(random(), 120);
    try {
      make_model(c)->begin(scene);
    } catch (const InputError&) {
      continue;  // a configuration that this scene does not fit
    }
    SCOPED_TRACE(to_toml(c));
    compare(c, scene);
    ++drawn;
  }
}

}  // namespace
}  // namespace bitspan
