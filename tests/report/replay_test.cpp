// SPDX-License-Identifier: Apache-2.0
// A replay file holds the whole case, and a bad one is refused with a line.
#include "report/replay.hpp"

#include <gtest/gtest.h>

#include <set>

#include "scene/random.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Replay sample() {
  Replay r;
  r.engines = {"golden", "model"};
  r.stall_seed = 42;
  r.designs = {{"rtl", "0123456789abcdef"}, {"dut:acme", "fedcba9876543210"}};
  r.found = "bitspan fuzz";
  r.config = shipped_config("narrow");
  RandomOptions options;
  options.fog_probability = 1;
  options.triangles = 9;
  for (std::uint64_t seed = 0; r.scene.textures.empty(); ++seed) {
    r.scene = random_scene(seed, options);
  }
  Random given(3);
  draw_given_attributes(given, r.scene, 0.5);
  draw_light(given, r.scene, {.point = true, .lunar = true, .fall = true});
  r.scene.projector = Projector{0.1, 1 / 3.0};
  for (double Attributes::*const member :
       {&Attributes::project_x, &Attributes::project_y, &Attributes::project_w}) {
    for (Vertex& v : r.scene.triangles[1].v) v.*member = given.uniform(-9, 9);
  }
  return r;
}

TEST(Replay, ComesBackBitForBit) {
  const Replay a = sample();
  const Replay b = parse_replay(replay_json(a), "file");
  EXPECT_EQ(b.engines, a.engines);
  EXPECT_EQ(b.stall_seed, a.stall_seed);
  EXPECT_EQ(b.designs, a.designs);
  EXPECT_EQ(config_hash(b.config), config_hash(a.config));
  EXPECT_EQ(replay_json(b), replay_json(a));
  ASSERT_EQ(b.scene.triangles.size(), a.scene.triangles.size());
  for (std::size_t i = 0; i < a.scene.triangles.size(); ++i) {
    EXPECT_EQ(b.scene.triangles[i].texture, a.scene.triangles[i].texture);
    for (std::size_t v = 0; v < 3; ++v) {
      const Vertex& x = a.scene.triangles[i].v[v];
      const Vertex& y = b.scene.triangles[i].v[v];
      EXPECT_TRUE(x.x == y.x && x.y == y.y && x.s == y.s && x.u == y.u && x.v == y.v && x.c == y.c &&
                  x.fog == y.fog);
      EXPECT_TRUE(x.project_x == y.project_x && x.project_y == y.project_y && x.project_w == y.project_w);
      EXPECT_TRUE(x.nx == y.nx && x.ny == y.ny && x.nz == y.nz);
    }
  }
  EXPECT_EQ(b.scene.projector, a.scene.projector);
  EXPECT_EQ(b.scene.light, a.scene.light);
  ASSERT_EQ(b.scene.textures.size(), a.scene.textures.size());
  EXPECT_EQ(b.scene.textures[0].rgba, a.scene.textures[0].rgba);
}

TEST(Replay, KeepsTexelFormats) {
  Replay a = sample();
  Random random(1);
  a.scene.textures.resize(40, a.scene.textures[0]);
  draw_texel_formats(random, a.scene, 0.8);
  const Replay b = parse_replay(replay_json(a), "file");
  EXPECT_EQ(replay_json(b), replay_json(a));
  ASSERT_EQ(b.scene.textures.size(), 40U);
  std::set<TexelFormat> formats;
  for (std::size_t i = 0; i < 40; ++i) {
    const Texture& x = a.scene.textures[i];
    const Texture& y = b.scene.textures[i];
    EXPECT_TRUE(x.format == y.format && x.rgba == y.rgba && x.raw == y.raw && x.table == y.table);
    formats.insert(x.format);
  }
  EXPECT_GT(formats.size(), 10U);
  std::string bad = replay_json(a);
  const std::size_t at = bad.find("\"raw\":");
  bad.erase(bad.find('"', at + 6) + 1, 2);
  EXPECT_NE(input_error([&] { parse_replay(bad, "file"); }).find("raw do not agree"), std::string::npos);
}

TEST(Replay, WithoutAnRtlNoHashIsWritten) {
  Replay a = sample();
  a.designs.clear();
  EXPECT_EQ(replay_json(a).find("\"rtl\""), std::string::npos);
  EXPECT_TRUE(parse_replay(replay_json(a), "file").designs.empty());
}

TEST(Replay, BadFilesAreRefusedInOneLine) {
  const std::string good = replay_json(sample());
  const auto refused = [](const std::string& text) {
    return input_error([&text] { static_cast<void>(parse_replay(text, "bad.json")); })
        .starts_with("bad.json");
  };
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("[]"));
  EXPECT_TRUE(refused("{}"));
  EXPECT_TRUE(refused(good.substr(0, good.size() / 2)));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_TRUE(refused(with("\"bitspan_replay\": 1", "\"bitspan_replay\": 2")));
  EXPECT_TRUE(refused(with("\"rgba\": \"", "\"rgba\": \"zz")));
  EXPECT_TRUE(refused(with("[raster]", "[raster]\\nnonsense = 1")));
  EXPECT_TRUE(refused(with("\"s_max\": ", "\"s_max\": -")));
  EXPECT_THROW(static_cast<void>(read_replay("/nonexistent/replay.json")), InputError);
}

}  // namespace
}  // namespace bitspan
