// SPDX-License-Identifier: Apache-2.0
// The frames of the benchmark: its scenes, Mesa's pictures of them, and the arithmetic of its tables.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "bench/likeness.hpp"
#include "bench/measure.hpp"
#include "bench/mesa.hpp"
#include "bench/mesa_process.hpp"
#include "bench/scenes.hpp"
#include "model/engine_model.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::bench {
namespace {

std::vector<std::uint8_t> by_model(const Config& config, const Scene& scene) {
  const auto engine = make_model(config);
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  return engine->frame().color;
}

Scene few_triangles() {
  Scene scene = empty_scene("few", 320, 240);
  CloudStream stream(9, scene, 3000);
  for (int i = 0; i < 60; ++i) {
    scene.triangles.push_back(stream.next());
  }
  return scene;
}

Config with_levels(Config config) {
  config.filter = TextureFilter::bilinear;
  config.mip = MipMode::linear;
  config.lod = LodMode::gradient;
  return config;
}

bool operator_equal(const Triangle& a, const Triangle& b) { return std::memcmp(&a.v, &b.v, sizeof a.v) == 0; }

TEST(Scenes, CloudsHaveTheirSize) {
  for (const Cloud& cloud : clouds()) {
    EXPECT_DOUBLE_EQ(static_cast<double>(cloud.triangles) * cloud.pixels, 8e6) << cloud.name;
  }
  const Scene medium = frame_scene("medium");
  ASSERT_EQ(medium.triangles.size(), 20000U);
  for (const Triangle& t : medium.triangles) {
    const auto& [a, b, c] = t.v;
    const double area = std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2;
    ASSERT_NEAR(area, 400, 1e-6);
    for (const Vertex& v : t.v) {
      ASSERT_TRUE(v.x >= 0 && v.x <= medium.width && v.y >= 0 && v.y <= medium.height);
      ASSERT_TRUE(v.s >= medium.s_min && v.s <= medium.s_max);
    }
    ASSERT_NE(a.s, b.s);
  }
}

TEST(Scenes, SameTwice) {
  const Scene a = frame_scene("big");
  const Scene b = frame_scene("big");
  ASSERT_EQ(a.triangles.size(), 200U);
  EXPECT_TRUE(std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), operator_equal));
  EXPECT_EQ(a.textures[0].rgba, b.textures[0].rgba);
}

TEST(Scenes, BackGoesFromFarToNear) {
  const Scene scene = frame_scene("big-back");
  const auto distance = [](const Triangle& t) { return t.v[0].s + t.v[1].s + t.v[2].s; };
  for (std::size_t i = 1; i < scene.triangles.size(); ++i) {
    ASSERT_GE(distance(scene.triangles[i - 1]), distance(scene.triangles[i]));
  }
}

TEST(Scenes, LevelsAndBlendsAreOfTheSameTriangles) {
  const Scene plain = frame_scene("big");
  const Scene mip = frame_scene("big-mip");
  ASSERT_EQ(mip.triangles.size(), plain.triangles.size());
  for (std::size_t i = 0; i < mip.triangles.size(); ++i) {
    for (std::size_t v = 0; v < 3; ++v) {
      ASSERT_EQ(mip.triangles[i].v[v].x, plain.triangles[i].v[v].x);
      ASSERT_DOUBLE_EQ(mip.triangles[i].v[v].u, 4 * plain.triangles[i].v[v].u);
    }
  }
  const Scene back = frame_scene("big-back");
  const Scene blend = frame_scene("big-blend");
  ASSERT_EQ(blend.triangles.size(), back.triangles.size());
  for (std::size_t i = 0; i < blend.triangles.size(); ++i) {
    for (std::size_t v = 0; v < 3; ++v) {
      ASSERT_EQ(blend.triangles[i].v[v].x, back.triangles[i].v[v].x);
      ASSERT_TRUE(blend.triangles[i].v[v].c[3] > 0.2 && blend.triangles[i].v[v].c[3] < 0.8);
    }
  }
}

// With many texels per pixel, pictures with levels are not like those without.
TEST(Mesa, DrawsTheModelsLevels) {
  Scene scene = few_triangles();
  scene.textures = frame_scene("big-mip").textures;
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) {
      v.u *= 4;
      v.v *= 4;
    }
  }
  const Config trilinear = with_levels(shipped_config("depth16"));
  Config bilinear = shipped_config("depth16");
  bilinear.filter = TextureFilter::bilinear;
  Mesa mesa(scene, TextureFilter::bilinear, 16, MipMode::linear);
  mesa.draw();
  const Likeness with = compare(by_model(trilinear, scene), mesa.picture(), scene);
  EXPECT_TRUE(alike(with)) << "PSNR " << with.psnr << ", drawn " << with.drawn;
  const Likeness without = compare(by_model(bilinear, scene), mesa.picture(), scene);
  EXPECT_FALSE(alike(without)) << "PSNR " << without.psnr;
  EXPECT_GT(with.psnr, without.psnr + 10);
}

// A side that does not blend shows.
TEST(Mesa, DrawsTheModelsBlend) {
  Scene scene = few_triangles();
  const Scene opaque = scene;
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.c[3] = 0.4;
  }
  Config config = shipped_config("depth16");
  config.filter = TextureFilter::bilinear;
  Mesa mesa(scene, TextureFilter::bilinear, 16);
  mesa.draw();
  const Likeness with = compare(by_model(config, scene), mesa.picture(), scene);
  EXPECT_TRUE(alike(with)) << "PSNR " << with.psnr << ", drawn " << with.drawn;
  const Likeness without = compare(by_model(config, opaque), mesa.picture(), scene);
  EXPECT_FALSE(alike(without)) << "PSNR " << without.psnr;
}

TEST(Mesa, DrawsTheModelsPicture) {
  const Scene scene = few_triangles();
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    Config config = shipped_config("depth16");
    config.filter = filter;
    Mesa mesa(scene, filter, 16);
    mesa.draw();
    const std::vector<std::uint8_t> picture = mesa.picture();
    const Likeness l = compare(by_model(config, scene), picture, scene);
    EXPECT_TRUE(alike(l)) << "PSNR " << l.psnr << ", drawn " << l.drawn << ", outside " << l.outside;
    EXPECT_GT(l.drawn, 0.3);
    mesa.draw();
    EXPECT_EQ(mesa.picture(), picture);
  }
}

// The comparison above sees what would make the benchmark unfair: no fog, no texture, no depth test.
TEST(Mesa, LikenessSeesMissingWork) {
  const Scene scene = few_triangles();
  Mesa mesa(scene, TextureFilter::nearest, 16);
  mesa.draw();
  const auto differs = [&](const Scene& other) {
    const Likeness l = compare(by_model(shipped_config("depth16"), other), mesa.picture(), scene);
    return !alike(l);
  };
  EXPECT_FALSE(differs(scene));
  Scene changed = scene;
  changed.fog.reset();
  EXPECT_TRUE(differs(changed));
  changed = scene;
  for (Triangle& t : changed.triangles) {
    t.texture = -1;
  }
  EXPECT_TRUE(differs(changed));
  changed = scene;
  for (Triangle& t : changed.triangles) {  // the last triangle drawn wins nearly everywhere
    const auto place = static_cast<double>(&t - changed.triangles.data());
    for (Vertex& v : t.v) {
      v.s = 19 - place / 4;
    }
  }
  EXPECT_TRUE(differs(changed));
  changed = scene;
  changed.triangles.clear();
  EXPECT_TRUE(differs(changed));
}

TEST(MesaProcess, DrawsInTurnWithAnother) {
  MesaProcess one("big", "", {"llvmpipe", 0, TextureFilter::nearest, 16});
  MesaProcess other("big", "", {"softpipe", 0, TextureFilter::nearest, 16});
  EXPECT_TRUE(one.renderer().starts_with("llvmpipe")) << one.renderer();
  EXPECT_TRUE(other.renderer().starts_with("softpipe")) << other.renderer();
  EXPECT_GT(one.draw(), 0);
  EXPECT_GT(other.draw(), 0);
  EXPECT_GT(one.draw(), 0);
  // The child takes the levels that it is told.
  MesaProcess levels("big-mip", "", {"llvmpipe", 0, TextureFilter::bilinear, 16, MipMode::linear});
  MesaProcess no_levels("big-mip", "", {"llvmpipe", 0, TextureFilter::bilinear, 16});
  levels.draw();
  no_levels.draw();
  EXPECT_NE(levels.picture(), no_levels.picture());
  const Scene scene = empty_scene("big", 1024, 768);
  const Likeness l = compare(one.picture(), other.picture(), scene);
  EXPECT_TRUE(alike(l)) << "PSNR " << l.psnr;
  EXPECT_GT(l.drawn, 0.7);
}

TEST(MesaProcess, TellsWhyItCannot) {
  expect_refusal([] { MesaProcess("no such mesh.obj", "", {}); }, "no such mesh.obj");
}

TEST(Measure, SummaryAndRatios) {
  const Summary s = summarise({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.low, 1);
  EXPECT_DOUBLE_EQ(s.high, 4);
  EXPECT_EQ(summarise({}).samples, 0);
  // The second round is slow for both: round by round the ratio is 2 throughout.
  const Series a{"a", "", 10, {1.0, 4.0, std::nullopt}, ""};
  const Series b{"b", "", 10, {2.0, 8.0, 100.0}, ""};
  const Summary r = ratio(a, b);
  EXPECT_EQ(r.samples, 2);
  EXPECT_DOUBLE_EQ(r.low, 2);
  EXPECT_DOUBLE_EQ(r.high, 2);
  const Series later{"c", "", 10, {std::nullopt, std::nullopt, 5.0}, ""};
  EXPECT_DOUBLE_EQ(ratio(a, later).median, (10 / 1.0 + 10 / 4.0) / 2 / 2);
  const Series none{"d", "", 10, {}, "its reason"};
  EXPECT_EQ(ratio(a, none).samples, 0);
  const std::vector<Goal> goals{
      {"work", "other", &a, &b, 2.0}, {"work", "more", &a, &b, 2.1}, {"x", "y", &a, &none, 1}};
  const std::string table = goal_table(goals, true, false);
  EXPECT_NE(table.find("yes"), std::string::npos) << table;
  EXPECT_NE(table.find("no\n"), std::string::npos) << table;
  EXPECT_NE(table.find("its reason"), std::string::npos) << table;
  EXPECT_EQ(goal_table(goals, false, false), "");
}

}  // namespace
}  // namespace bitspan::bench

extern "C" int sc_main(int /*argc*/, char** /*argv*/) { return 0; }

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], bitspan::bench::mesa_child_flag) == 0) {
    return bitspan::bench::mesa_child(argc, argv);
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
