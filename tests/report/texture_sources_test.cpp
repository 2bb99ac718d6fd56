// SPDX-License-Identifier: Apache-2.0
// Textures that are computed or change from frame to frame, against the same texels stored: every record of
// every engine is equal.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "model/stages/texel.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/procedural.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/files.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

struct Maker {
  std::string name;
  std::function<std::unique_ptr<Engine>(const Config&)> make;
};
std::vector<Maker> makers() {
  const auto form = [](ModelForm f) {
    return [f](const Config& c) {
      ModelOptions options;
      options.form = f;
      return make_model(c, options);
    };
  };
  return {{"golden", [](const Config& c) { return make_golden(c); }},
          {"model", form(ModelForm::scalar)},
          {"lanes", form(ModelForm::automatic)},
          {"systemc", [](const Config& c) -> std::unique_ptr<Engine> { return make_systemc(c); }}};
}

// The same in every record and in the picture. Returns how many records of texture there were.
std::size_t expect_same_drawing(const Config& config, const Scene& a, const Scene& b) {
  std::size_t texels = 0;
  for (const Maker& maker : makers()) {
    Trace of_a, of_b;
    const auto first = maker.make(config);
    first->begin(a);
    draw_scene(*first, a, 0, a.triangles.size(), &of_a);
    const auto second = maker.make(config);
    second->begin(b);
    draw_scene(*second, b, 0, b.triangles.size(), &of_b);
#define SAME(Record, LIST, stage, member) \
  EXPECT_TRUE(of_a.member == of_b.member) << maker.name << " " << stage;
    BITSPAN_RECORDS(SAME)
#undef SAME
    expect_same_frame(first->frame(), second->frame());
    texels = of_a.texture.size();
  }
  return texels;
}

std::vector<Config> configs() {
  std::vector<Config> out;
  for (Config c : shipped_configs()) {
    out.push_back(c);
    c.filter = c.filter == TextureFilter::nearest ? TextureFilter::bilinear : TextureFilter::nearest;
    c.mip = MipMode::linear;
    c.lod = LodMode::zone_s;
    out.push_back(c);
  }
  return out;
}

RandomOptions small_scenes() {
  RandomOptions options;
  options.width = 96;
  options.height = 64;
  options.triangles = 20;
  options.size_min = 16;
  options.depth_ratio_max = 16;
  options.uv_limit = 64;
  options.mip_chains = true;
  return options;
}

TEST(TextureSources, AProceduralTextureEqualsTheSameStoredAsAPng) {
  const TemporaryFolder folder;
  std::size_t texels = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    Scene computed = random_scene(seed, small_scenes());
    computed.textures.clear();
    for (const TexelFormat format : {TexelFormat::checker, TexelFormat::brick, TexelFormat::noise}) {
      computed.textures.push_back(random_procedural(random, format, 32, 16));
    }
    for (std::size_t i = 0; i < computed.triangles.size(); ++i)
      computed.triangles[i].texture = static_cast<int>(i % 3);
    Scene stored = computed;
    for (Texture& t : stored.textures) {
      Texture plain;
      plain.width = t.width;
      plain.height = t.height;
      for (int j = 0; j < t.height; ++j) {
        for (int i = 0; i < t.width; ++i) {
          const model::TexelCodes c = model::texel_of(t, i, j);
          plain.rgba.insert(plain.rgba.end(), c.begin(), c.end());
        }
      }
      t = plain;
    }
    write_tri_file(folder.path("stored.tri"), stored);
    write_tri_file(folder.path("computed.tri"), computed);
    const Scene a = read_tri(folder.path("computed.tri"));
    const Scene b = read_tri(folder.path("stored.tri"));
    EXPECT_TRUE(is_procedural(a.textures[0].format));
    EXPECT_FALSE(is_procedural(b.textures[0].format));
    for (const Config& config : configs()) {
      SCOPED_TRACE(config.name + " seed " + std::to_string(seed));
      texels += expect_same_drawing(config, a, b);
    }
  }
  EXPECT_GT(texels, 20000U);
}

// The timed model reads nothing from memory for texels that it computes.
TEST(TextureSources, AProceduralTextureAsksTheMemoryForNothing) {
  Random random(1);
  Scene scene = random_scene(1, small_scenes());
  for (Triangle& t : scene.triangles) t.texture = 0;
  const auto misses = [&](const Texture& texture) {
    scene.textures = {texture};
    const auto engine = make_systemc(shipped_config("depth16"));
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    EXPECT_GT(engine->counters().depth_passed, 1000);
    return engine->report().cache_misses;
  };
  const Texture noise = random_procedural(random, TexelFormat::noise, 64, 64);
  Texture plain;
  plain.width = plain.height = 64;
  plain.rgba.assign(std::size_t{64} * 64 * 4, 9);
  EXPECT_EQ(misses(noise), 0U);
  EXPECT_GT(misses(plain), 0U);
}

// Frame k of a list against a stream that has that texture alone.
TEST(TextureSources, FrameKOfAListEqualsThatTextureAlone) {
  const TemporaryFolder folder;
  Scene scene = random_scene(7, small_scenes());
  scene.textures.clear();
  std::vector<std::string> entries;
  Random random(8);
  for (int k = 0; k < 4; ++k) {
    scene.textures = {
        random_procedural(random, k % 2 == 0 ? TexelFormat::noise : TexelFormat::brick, 32, 32)};
    for (Triangle& t : scene.triangles) t.texture = 0;
    const std::string name = "alone" + std::to_string(k) + ".tri";
    write_tri_file(folder.path(name), scene);
    const std::string text = folder.read(name);
    const std::size_t first = text.find("\"textures\":[") + 12;
    entries.push_back(text.substr(first, text.find("}]", first) + 1 - first));
  }
  const std::string last = folder.read("alone3.tri");
  std::string list = last;
  const std::size_t at = list.find(entries[3]);
  ASSERT_NE(at, std::string::npos);
  list.replace(at, entries[3].size(),
               "{\"frames\":[" + entries[0] + "," + entries[1] + "," + entries[2] + "," + entries[3] + "]}");
  folder.write("list.tri", list);
  const Config config = shipped_config("depth20");
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int k = 0; k < 4; ++k) {
    const Scene alone = read_tri(folder.path("alone" + std::to_string(k) + ".tri"));
    const Scene framed = read_tri(folder.path("list.tri"), k);
    EXPECT_GT(expect_same_drawing(config, framed, alone), 1000U);
    const auto engine = make_model(config);
    engine->begin(framed);
    engine->draw(framed.triangles, 0, nullptr);
    for (const auto& other : pictures) EXPECT_NE(engine->frame().color, other);
    pictures.push_back(engine->frame().color);
  }
}

}  // namespace
}  // namespace bitspan
