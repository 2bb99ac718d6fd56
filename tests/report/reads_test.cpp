// SPDX-License-Identifier: Apache-2.0
// What the report of a divergence says that its stage read: draw state, the pixel as it stood, texels.
#include "report/reads.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "report/describe.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// A divergence at record i of a trace, as the comparator makes it.
Divergence at_record(const Trace& trace, RecordType type, std::size_t i, const Config& config,
                     const Scene& scene) {
  Trace other = trace;
  const RecordView view = view_of(other, type);
  const int last = static_cast<int>(view.fields.size()) - 1;
  const_cast<std::int64_t*>(view.record(i).data())[last] ^= 1;
  Comparison pair;
  pair.reference = "golden";
  pair.other = "model";
  compare_records(trace, other, type, pair);
  add_reads(*pair.first, config, scene, *make_golden(config));
  return *pair.first;
}

std::string value_read(const Divergence& d, std::string_view name) {
  const auto found = std::ranges::find(d.read, name, &Read::name);
  return found == d.read.end() ? "" : found->value;
}

Trace trace_of(Engine& engine, const Scene& scene) {
  Trace trace;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &trace);
  return trace;
}

TEST(Reads, EveryRegisterOfTheDrawStateIsReadByAStage) {
  for (const StateRegister& r : state_registers()) {
    bool is_read = false;
    for (int t = 0; t < record_types; ++t)
      is_read = is_read || reads_register(static_cast<RecordType>(t), r.key);
    EXPECT_TRUE(is_read) << r.key << ": report/reads.cpp names no stage that reads it";
  }
}

// The colours that merge found are those that the records of before it left.
TEST(Reads, MergeNamesItsStateAndTheStoredColor) {
  RandomOptions options{.width = 12,
                        .height = 9,
                        .triangles = 40,
                        .size_min = 4,
                        .size_max = 16,
                        .depth_ratio_max = 4,
                        .uv_limit = 16};
  options.stacked_probability = 0.5;
  const Config config = shipped_config("depth16");
  Scene scene = random_scene(5, options);
  const auto setting = [](std::string_view key, std::int64_t value) {
    return StateSetting{*find_state_register(key), value};
  };
  const StateChange change{false,
                           {setting("depth.func", static_cast<int>(DepthFunc::always)),
                            setting("blend.dst", static_cast<int>(BlendFactor::one_minus_dst_color))}};
  scene.commands.push_back({10, change});
  const auto golden = make_golden(config);
  const Trace trace = trace_of(*golden, scene);
  std::vector<std::string> stored(static_cast<std::size_t>(scene.width * scene.height),
                                  std::to_string(scene.background[0]) + " " +
                                      std::to_string(scene.background[1]) + " " +
                                      std::to_string(scene.background[2]) + " 255");
  int drawn_before = 0;
  for (std::size_t i = 0; i < trace.merge.size(); ++i) {
    const MergeRecord& r = trace.merge[i];
    std::string& color = stored[static_cast<std::size_t>(r.y * scene.width + r.x)];
    if (i % 4 == 3) {
      const Divergence d = at_record(trace, RecordType::merge, i, config, scene);
      EXPECT_EQ(value_read(d, "stored color"), color) << i;
      EXPECT_EQ(value_read(d, "blend.dst"), r.triangle < 10 ? "one_minus_src_alpha" : "one_minus_dst_color");
      EXPECT_NE(value_read(d, "logic.op"), "");
      EXPECT_EQ(value_read(d, "stencil.func"), "");  // merge reads none of the stencil's
      drawn_before += !color.ends_with(" 255") || r.triangle > 0 ? 1 : 0;
    }
    color = std::to_string(r.r) + " " + std::to_string(r.g) + " " + std::to_string(r.b) + " 255";
  }
  EXPECT_GT(drawn_before, 5);
}

// Each texel that is named is one of the texture's, the first one is the record's, and the nearest one alone
// makes the record's texel.
TEST(Reads, TextureNamesItsTexels) {
  RandomOptions options{.width = 24,
                        .height = 16,
                        .triangles = 20,
                        .size_min = 4,
                        .size_max = 24,
                        .depth_ratio_max = 4,
                        .uv_limit = 16};
  int levels = 0, quads = 0, nearest = 0;
  for (const char* name : {"depth16", "depth20"}) {
    for (const MipMode mip : {MipMode::none, MipMode::linear}) {
      Config config = shipped_config(name);
      config.transparent = std::nullopt;
      config.mip = mip;
      config.lod = LodMode::gradient;
      options.mip_chains = has_lod(config);
      const Scene scene = random_scene(6, options);
      ASSERT_FALSE(scene.textures.empty());
      const Trace trace = trace_of(*make_model(config), scene);
      for (std::size_t i = 0; i < trace.texture.size(); i += 2) {
        const TextureRecord& r = trace.texture[i];
        const int texture = scene.triangles[static_cast<std::size_t>(r.triangle)].texture;
        if (texture < 0) continue;
        const Divergence d = at_record(trace, RecordType::texture, i, config, scene);
        std::vector<Read> texels;
        for (const Read& read : d.read) {
          if (read.name.starts_with("texel (")) texels.push_back(read);
        }
        const bool weighs = weighs_texels(config.filter);
        const bool mixes = has_lod(config) && trace.lod[i].f != 0;
        ASSERT_EQ(texels.size(), (weighs ? 4U : 1U) * (mixes ? 2U : 1U));
        levels += mixes;
        quads += weighs;
        const std::string first = "texel (" + std::to_string(r.i) + ", " + std::to_string(r.j) + ")";
        EXPECT_TRUE(texels[0].name.starts_with(first)) << texels[0].name << ", expected " << first;
        EXPECT_EQ(value_read(d, "texture").substr(0, 1), std::to_string(texture));
        if (weighs || mixes || has_lod(config)) continue;
        const Texture& image = scene.textures[static_cast<std::size_t>(texture)];
        const std::uint8_t* p = image.rgba.data() + 4 * (r.j * image.width + r.i);
        EXPECT_EQ(texels[0].value, std::to_string(p[0]) + " " + std::to_string(p[1]) + " " +
                                       std::to_string(p[2]) + " " + std::to_string(p[3]));
        EXPECT_EQ(decoded(r.texel_r, config.format(FormatId::texture_mix)), p[0]);
        ++nearest;
      }
    }
  }
  EXPECT_GT(levels, 5);
  EXPECT_GT(quads, 5);
  EXPECT_GT(nearest, 5);
}

// The second unit's texels are those of the projector's coordinates, a shadow map's with what it compares.
TEST(Reads, AProjectedTextureNamesItsTexels) {
  Config config = plain_config();
  config.project = ProjectUnit::reciprocal;
  Scene scene;
  scene.width = scene.height = 16;
  scene.s_min = 1;
  scene.s_max = 2;
  scene.projector = Projector{1, 2};
  Triangle t;
  t.v[0] = {{0, 0, 1}, {.c = {1, 1, 1, 1}, .project_w = 1}};
  t.v[1] = {{16, 0, 1}, {.c = {1, 1, 1, 1}, .project_x = 4, .project_w = 1}};
  t.v[2] = {{0, 16, 1}, {.c = {1, 1, 1, 1}, .project_y = 4, .project_w = 1}};
  scene.triangles = {t};
  Texture map{.name = "map", .width = 2, .height = 4, .rgba = {}, .format = TexelFormat::depth};
  for (int i = 0; i < 8; ++i) map.raw.insert(map.raw.end(), {static_cast<std::uint8_t>(i), 2, 3, 4});
  scene.textures = {map};
  const StateChange change{
      false, {{*find_state_register("texture1"), 0}, {*find_state_register("texture1.coordinates"), 1}}};
  scene.commands.push_back({0, change});
  const Trace trace = trace_of(*make_golden(config), scene);
  ASSERT_EQ(trace.project.size(), trace.texture_second.size());
  int inside = 0;
  for (std::size_t i = 0; i < trace.project.size(); ++i) {
    const Divergence project = at_record(trace, RecordType::project, i, config, scene);
    EXPECT_EQ(value_read(project, "texture"), "0 map, 2x4");
    EXPECT_EQ(value_read(project, "texture1.coordinates"), "project");
    const Divergence second = at_record(trace, RecordType::texture_second, i, config, scene);
    const TextureSecondRecord& r = trace.texture_second[i];
    const auto texel = static_cast<int>(2 * r.j + r.i);
    const std::string name = fmt::format("texel ({}, {}) of level 0", r.i, r.j);
    EXPECT_EQ(value_read(second, name),
              trace.project[i].inside != 0 ? fmt::format("4 4 4 255, word 0x040302{:02x}", texel) : "");
    inside += static_cast<int>(trace.project[i].inside);
  }
  EXPECT_GT(inside, 20);
  EXPECT_LT(static_cast<std::size_t>(inside), trace.project.size());
}

TEST(Reads, TheReportNamesThem) {
  const Config config = shipped_config("depth16");
  const Scene scene =
      random_scene(5, {.width = 12, .height = 9, .triangles = 6, .size_min = 4, .size_max = 16});
  const Trace trace = trace_of(*make_golden(config), scene);
  const std::string merge =
      describe(at_record(trace, RecordType::merge, 0, config, scene), config, {"s", "c"});
  EXPECT_NE(merge.find("read by merge:\n"), std::string::npos) << merge;
  EXPECT_NE(merge.find("    blend.src            src_alpha\n"), std::string::npos) << merge;
  EXPECT_NE(merge.find("    stored color         "), std::string::npos) << merge;
  const std::string setup =
      describe(at_record(trace, RecordType::setup, 0, config, scene), config, {"s", "c"});
  EXPECT_NE(setup.find("    vertex x y s u v, r g b a "), std::string::npos) << setup;
}

}  // namespace
}  // namespace bitspan
