// SPDX-License-Identifier: Apache-2.0
// Every call with bad arguments, bad handles and in a bad order: a status, a text of one line, and no crash.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "scene/random.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

struct Call {
  const char* name;
  std::function<bs_status()> run;
  bs_status status;
};

// Each with its status and a text of its own call.
void expect_failures(const std::vector<Call>& calls) {
  for (const Call& c : calls) {
    bs_config* none = nullptr;
    EXPECT_EQ(bs_config_load("a text to be overwritten", &none), BS_BAD_INPUT);
    const std::string before = bs_last_error();
    EXPECT_EQ(c.run(), c.status) << c.name;
    const std::string text = bs_last_error();
    EXPECT_FALSE(text.empty()) << c.name;
    EXPECT_NE(text, before) << c.name;
    EXPECT_EQ(text.find('\n'), std::string::npos) << c.name;
  }
}

Scene small_scene() {
  RandomOptions options;
  options.triangles = 5;
  options.size_max = 30;
  options.width = 64;
  options.height = 48;
  return random_scene(1, options);
}

bs_scene* demo_handle() {
  static bs_scene* const scene = [] {
    bs_scene* out = nullptr;
    EXPECT_EQ(bs_scene_load("demo", 64, 48, &out), BS_OK);
    return out;
  }();
  return scene;
}

// Every function that takes a model, with this one.
std::vector<Call> calls_with(bs_model* m, bs_status status, const Described& scene) {
  static bs_view view;
  static std::int64_t number;
  view.size = sizeof view;
  const auto* const row = &number;
  return {
      {"bs_trace", [=] { return bs_trace(m, 1); }, status},
      {"bs_begin", [=, &scene] { return bs_begin(m, &scene.desc); }, status},
      {"bs_triangle", [=, &scene] { return bs_triangle(m, scene.vertices.data(), -1, 0, 0); }, status},
      {"bs_draw", [=, &scene] { return bs_draw(m, scene.vertices.data(), nullptr, 1, 0, 0); }, status},
      {"bs_draw_scene", [=] { return bs_draw_scene(m, demo_handle(), 0, 1, 0, 0); }, status},
      {"bs_command", [=] { return bs_command(m, R"({"clear": {"depth": true}})"); }, status},
      {"bs_row", [=] { return bs_row(m, BS_STAGE_EDGE_WALK, row, 1, -1); }, status},
      {"bs_records", [=] { return bs_records(m, BS_STAGE_SPAN, &view); }, status},
      {"bs_clear_records", [=] { return bs_clear_records(m); }, status},
      {"bs_frame_view", [=] { return bs_frame_view(m, BS_PLANE_COLOR, &view); }, status},
      {"bs_counter", [=] { return bs_counter(m, "rows", &number); }, status},
      {"bs_check", [=] { return bs_check(m, BS_STAGE_SPAN, row, 0, nullptr); }, status},
      {"bs_stage_override", [=] { return bs_stage_override(m, BS_STAGE_SPAN, nullptr, nullptr); }, status},
      {"bs_run_text", [=] { return bs_run_text(m) == nullptr ? status : BS_OK; }, status},
      {"bs_matched", [=] { return bs_matched(m) == 0 ? status : BS_OK; }, status},
      {"bs_nontrivial", [=] { return bs_nontrivial(m) == 0 ? status : BS_OK; }, status},
      {"bs_unchecked", [=] { return bs_unchecked(m, BS_STAGE_SPAN) == 0 ? status : BS_OK; }, status},
  };
}

TEST(LibMisuse, BadHandles) {
  const Scene scene = small_scene();
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  bs_model* closed = open_model(config.get(), "model").release();
  bs_close(closed);
  bs_close(closed);
  bs_close(nullptr);
  auto* const other_kind = reinterpret_cast<bs_model*>(config.get());
  int on_the_stack = 0;
  auto* const no_handle = reinterpret_cast<bs_model*>(&on_the_stack);
  for (bs_model* const bad : {static_cast<bs_model*>(nullptr), closed, other_kind, no_handle}) {
    expect_failures(calls_with(bad, BS_BAD_HANDLE, described));
    bs_close(bad);
  }
  // The configuration lives on.
  EXPECT_NE(bs_config_hash(config.get()), nullptr);

  bs_config* gone = config_handle("depth16").release();
  bs_config_free(gone);
  bs_config_free(gone);
  bs_config_free(nullptr);
  bs_scene_free(nullptr);
  bs_field_info info{};
  info.size = sizeof info;
  bs_model* model = nullptr;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* v = nullptr;
  const std::int32_t* t = nullptr;
  std::size_t n = 0;
  auto* const no_scene = reinterpret_cast<bs_scene*>(gone);
  for (bs_config* const bad :
       {static_cast<bs_config*>(nullptr), gone, reinterpret_cast<bs_config*>(closed)}) {
    expect_failures({
        {"bs_config_set", [=] { return bs_config_set(bad, "depth.bits", "16"); }, BS_BAD_HANDLE},
        {"bs_config_hash", [=] { return bs_config_hash(bad) == nullptr ? BS_BAD_HANDLE : BS_OK; },
         BS_BAD_HANDLE},
        {"bs_config_text", [=] { return bs_config_text(bad) == nullptr ? BS_BAD_HANDLE : BS_OK; },
         BS_BAD_HANDLE},
        {"bs_field", [&, bad] { return bs_field(bad, BS_STAGE_SPAN, 0, &info); }, BS_BAD_HANDLE},
        {"bs_open", [&, bad] { return bs_open(bad, "model", &model); }, BS_BAD_HANDLE},
        {"bs_scene_get", [&] { return bs_scene_get(no_scene, &desc); }, BS_BAD_HANDLE},
        {"bs_scene_triangles", [&] { return bs_scene_triangles(no_scene, &v, &t, &n); }, BS_BAD_HANDLE},
        {"bs_scene_get", [&] { return bs_scene_get(nullptr, &desc); }, BS_BAD_HANDLE},
        {"bs_scene_notes", [&] { return bs_scene_notes(no_scene) == nullptr ? BS_BAD_HANDLE : BS_OK; },
         BS_BAD_HANDLE},
    });
  }
}

TEST(LibMisuse, BadOrder) {
  const Scene scene = small_scene();
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  for (int i = 0; bs_engine_name(i) != nullptr; ++i) {
    const ModelHandle model = open_model(config.get(), bs_engine_name(i));
    for (const Call& c : calls_with(model.get(), BS_BAD_ORDER, described)) {
      const std::set<std::string> need_begin{"bs_triangle",   "bs_draw",    "bs_draw_scene",
                                             "bs_command",    "bs_row",     "bs_records",
                                             "bs_frame_view", "bs_counter", "bs_check"};
      if (need_begin.contains(c.name)) expect_failures({c});
    }
  }
  const ModelHandle ideal = open_model(config.get(), "ideal");
  draw(ideal.get(), described);
  bs_view view{};
  view.size = sizeof view;
  expect_failures(
      {{"ideal's records", [&] { return bs_records(ideal.get(), BS_STAGE_SPAN, &view); }, BS_UNSUPPORTED},
       {"ideal's stage", [&] { return bs_stage_override(ideal.get(), BS_STAGE_SPAN, nullptr, nullptr); },
        BS_UNSUPPORTED}});
}

TEST(LibMisuse, BadArguments) {
  const Scene scene = small_scene();
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle handle = open_model(config.get(), "model");
  bs_model* const m = handle.get();
  draw(m, described);
  bs_config* c = nullptr;
  bs_model* other = nullptr;
  bs_scene* s = nullptr;
  bs_field_info info{};
  info.size = sizeof info;
  bs_view view{};
  view.size = sizeof view;
  std::int64_t number = 0;
  const std::string folder = source_path();
  const std::string readme = folder + "/README.md";
  const std::string sea = folder + "/tests/data/sea.tri";
  expect_failures({
      {"load NULL", [&] { return bs_config_load(nullptr, &c); }, BS_BAD_INPUT},
      {"load to NULL", [&] { return bs_config_load("depth16", nullptr); }, BS_BAD_INPUT},
      {"load nothing", [&] { return bs_config_load("", &c); }, BS_BAD_INPUT},
      {"load no file", [&] { return bs_config_load("no/such/file.toml", &c); }, BS_BAD_INPUT},
      {"load a folder", [&] { return bs_config_load(folder.c_str(), &c); }, BS_BAD_INPUT},
      {"load no TOML", [&] { return bs_config_load(readme.c_str(), &c); }, BS_BAD_INPUT},
      {"parse NULL", [&] { return bs_config_parse(nullptr, &c); }, BS_BAD_INPUT},
      {"parse to NULL", [&] { return bs_config_parse("a = 1", nullptr); }, BS_BAD_INPUT},
      {"parse nothing", [&] { return bs_config_parse("", &c); }, BS_BAD_INPUT},
      {"parse another", [&] { return bs_config_parse("a = 1", &c); }, BS_BAD_INPUT},
      {"set NULL", [&] { return bs_config_set(config.get(), nullptr, "1"); }, BS_BAD_INPUT},
      {"set to NULL", [&] { return bs_config_set(config.get(), "depth.bits", nullptr); }, BS_BAD_INPUT},
      {"set no key", [&] { return bs_config_set(config.get(), "depth.bit", "1"); }, BS_BAD_INPUT},
      {"set no value", [&] { return bs_config_set(config.get(), "depth.bits", "many"); }, BS_BAD_INPUT},
      {"set no name", [&] { return bs_config_set(config.get(), "depth.code", "nearest"); }, BS_BAD_INPUT},
      {"field of no stage", [&] { return bs_field(config.get(), BS_STAGE_LINE_WALK + 1, 0, &info); },
       BS_BAD_INPUT},
      {"field of stage -1", [&] { return bs_field(config.get(), -1, 0, &info); }, BS_BAD_INPUT},
      {"field -1", [&] { return bs_field(config.get(), 7, -1, &info); }, BS_BAD_INPUT},
      {"field behind the last", [&] { return bs_field(config.get(), 7, 16, &info); }, BS_BAD_INPUT},
      {"field to NULL", [&] { return bs_field(config.get(), 7, 0, nullptr); }, BS_BAD_INPUT},
      {"open NULL", [&] { return bs_open(config.get(), nullptr, &other); }, BS_BAD_INPUT},
      {"open no engine", [&] { return bs_open(config.get(), "no engine", &other); }, BS_BAD_INPUT},
      {"open to NULL", [&] { return bs_open(config.get(), "model", nullptr); }, BS_BAD_INPUT},
      {"scene NULL", [&] { return bs_scene_load(nullptr, 0, 0, &s); }, BS_BAD_INPUT},
      {"scene to NULL", [&] { return bs_scene_load("demo", 0, 0, nullptr); }, BS_BAD_INPUT},
      {"no scene", [&] { return bs_scene_load("no/such.tri", 0, 0, &s); }, BS_BAD_INPUT},
      {"no mesh", [&] { return bs_scene_load(readme.c_str(), 0, 0, &s); }, BS_BAD_INPUT},
      {"scene of no size", [&] { return bs_scene_load("demo", -1, 5, &s); }, BS_BAD_INPUT},
      {"scene too wide", [&] { return bs_scene_load("demo", 5000, 5, &s); }, BS_BAD_INPUT},
      {"frame of a demo", [&] { return bs_scene_load_frame("demo", 0, 0, 0, &s); }, BS_BAD_INPUT},
      {"frame behind the last", [&] { return bs_scene_load_frame(sea.c_str(), 0, 0, 3, &s); }, BS_BAD_INPUT},
      {"frame -1", [&] { return bs_scene_load_frame(sea.c_str(), 0, 0, -1, &s); }, BS_BAD_INPUT},
      {"trace 2", [&] { return bs_trace(m, 2); }, BS_BAD_INPUT},
      {"begin NULL", [&] { return bs_begin(m, nullptr); }, BS_BAD_INPUT},
      {"triangle NULL", [&] { return bs_triangle(m, nullptr, -1, 0, 0); }, BS_BAD_INPUT},
      {"texture -2", [&] { return bs_triangle(m, described.vertices.data(), -2, 0, 0); }, BS_BAD_INPUT},
      {"texture 99", [&] { return bs_triangle(m, described.vertices.data(), 99, 0, 0); }, BS_BAD_INPUT},
      {"draw NULL", [&] { return bs_draw(m, nullptr, nullptr, 1, 0, 0); }, BS_BAD_INPUT},
      {"draw too many", [&] { return bs_draw(m, described.vertices.data(), nullptr, SIZE_MAX, 0, 0); },
       BS_BAD_INPUT},
      {"row NULL", [&] { return bs_row(m, BS_STAGE_EDGE_WALK, nullptr, 1, -1); }, BS_BAD_INPUT},
      {"row of no stage", [&] { return bs_row(m, BS_STAGE_LINE_WALK + 1, &number, 1, -1); }, BS_BAD_INPUT},
      {"records of no stage", [&] { return bs_records(m, BS_STAGE_LINE_WALK + 1, &view); }, BS_BAD_INPUT},
      {"records to NULL", [&] { return bs_records(m, 7, nullptr); }, BS_BAD_INPUT},
      {"plane 7", [&] { return bs_frame_view(m, 7, &view); }, BS_BAD_INPUT},
      {"plane to NULL", [&] { return bs_frame_view(m, 0, nullptr); }, BS_BAD_INPUT},
      {"counter NULL", [&] { return bs_counter(m, nullptr, &number); }, BS_BAD_INPUT},
      {"no counter", [&] { return bs_counter(m, "bugs", &number); }, BS_BAD_INPUT},
      {"counter to NULL", [&] { return bs_counter(m, "rows", nullptr); }, BS_BAD_INPUT},
      {"check NULL", [&] { return bs_check(m, 7, nullptr, 1, nullptr); }, BS_BAD_INPUT},
      {"check no stage", [&] { return bs_check(m, BS_STAGE_LINE_WALK + 1, &number, 1, nullptr); },
       BS_BAD_INPUT},
      {"unchecked of no stage",
       [&] { return bs_unchecked(m, BS_STAGE_LINE_WALK + 1) == 0 ? BS_BAD_INPUT : BS_OK; }, BS_BAD_INPUT},
      {"override no stage", [&] { return bs_stage_override(m, BS_STAGE_LINE_WALK + 1, nullptr, nullptr); },
       BS_BAD_INPUT},
      {"override constants", [&] { return bs_stage_override(m, 0, nullptr, nullptr); }, BS_UNSUPPORTED},
  });
  EXPECT_EQ(c, nullptr);
  EXPECT_EQ(other, nullptr);
  EXPECT_EQ(s, nullptr);
  // The model draws on.
  EXPECT_EQ(bs_draw(m, described.vertices.data(), nullptr, 1, 0, 0), BS_OK) << bs_last_error();
}

TEST(LibMisuse, ErrorsNameFileLineAndKey) {
  bs_config* config = nullptr;
  const ConfigHandle good = config_handle("depth16");
  std::string text = bs_config_text(good.get());
  const std::size_t at = text.find("word = ");
  text.replace(at, 8, "word = 99");
  EXPECT_EQ(bs_config_parse(text.c_str(), &config), BS_BAD_INPUT);
  const std::string error = bs_last_error();
  EXPECT_EQ(error.rfind("text:", 0), 0U) << error;
  EXPECT_NE(error.find(".word: "), std::string::npos) << error;
  // Rules between keys are checked where the model is opened.
  ASSERT_EQ(bs_config_set(good.get(), "depth.bits", "64"), BS_OK);
  bs_model* model = nullptr;
  EXPECT_EQ(bs_open(good.get(), "model", &model), BS_BAD_INPUT);
  EXPECT_NE(std::string(bs_last_error()).find("depth16: depth.bits: "), std::string::npos) << bs_last_error();
}

TEST(LibMisuse, BadScenes) {
  const Scene scene = small_scene();
  const ConfigHandle config = config_handle("depth16");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const std::function<void(Described&)>& change, bs_status status = BS_BAD_INPUT) {
    for (int i = 0; bs_engine_name(i) != nullptr; ++i) {
      const ModelHandle model = open_model(config.get(), bs_engine_name(i));
      Described described(scene);
      change(described);
      EXPECT_EQ(bs_begin(model.get(), &described.desc), status) << bs_last_error();
      EXPECT_EQ(bs_draw(model.get(), described.vertices.data(), nullptr, 1, 0, 0), BS_BAD_ORDER);
    }
  };
  refused([](Described& d) { d.desc.width = 0; });
  refused([](Described& d) { d.desc.width = 40000; });
  refused([](Described& d) { d.desc.width = d.desc.height = 32000; });
  refused([](Described& d) { d.desc.s_min = -1; });
  refused([](Described& d) { d.desc.s_max = d.desc.s_min; });
  refused([&](Described& d) { d.desc.s_max = nan; });
  refused([&](Described& d) { d.desc.focal = nan; });
  refused([](Described& d) { d.desc.has_fog = 2; });
  refused([](Described& d) { d.desc.reserved = 1; });
  refused([&](Described& d) {
    d.desc.has_fog = 1;
    d.desc.fog_distance = nan;
  });
  refused([](Described& d) {
    d.desc.textures = nullptr;
    d.desc.texture_count = 1;
  });
  refused([](Described& d) { d.desc.texture_count = SIZE_MAX; });
  const auto texture_refused = [&](const std::function<void(bs_texture&)>& change) {
    refused([&](Described& d) {
      static const std::array<std::uint8_t, 16> texels{};
      bs_texture texture = BS_TEXTURE_INIT;
      texture.width = texture.height = 2;
      texture.rgba = texture.raw = texels.data();
      texture.raw_size = 8;
      d.textures.assign(1, texture);
      change(d.textures[0]);
      d.desc.textures = d.textures.data();
      d.desc.texture_count = 1;
    });
  };
  texture_refused([](bs_texture& t) { t.width = 0; });
  texture_refused([](bs_texture& t) { t.height = 16385; });
  texture_refused([](bs_texture& t) { t.rgba = nullptr; });
  texture_refused([](bs_texture& t) { t.stride = 7; });
  texture_refused([](bs_texture& t) { t.format = BS_TEXEL_RGBA8888 - 1; });
  texture_refused([](bs_texture& t) { t.format = BS_TEXEL_YUYV + 1; });
  texture_refused([](bs_texture& t) { t.format = BS_TEXEL_I8; });
  texture_refused([](bs_texture& t) {
    t.format = BS_TEXEL_RGB565;
    t.raw = nullptr;
  });
  texture_refused([](bs_texture& t) {
    t.format = BS_TEXEL_RGB565;
    t.reserved = 1;
  });
  static const std::vector<std::int16_t> palette(1024, 256);
  texture_refused([](bs_texture& t) {
    t.format = BS_TEXEL_AP88;
    t.table = palette.data();
    t.table_size = 1024;
  });
}

TEST(LibMisuse, BadProjectors) {
  const Scene scene = small_scene();
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  Described described(scene);
  bs_scene_desc& desc = described.desc;
  const auto begun = [&](double s_min, double s_max) {
    desc.projector_s_min = s_min;
    desc.projector_s_max = s_max;
    return bs_begin(model.get(), &desc);
  };
  EXPECT_EQ(begun(-1, 0), BS_OK);  // has_projector is 0
  desc.has_projector = 1;
  EXPECT_EQ(begun(1, 9), BS_OK) << bs_last_error();
  for (const auto& [s_min, s_max] : {std::pair{0.0, 1.0}, {2.0, 2.0}, {1.0, HUGE_VAL}, {std::nan(""), 1.0}}) {
    EXPECT_EQ(begun(s_min, s_max), BS_BAD_INPUT);
    EXPECT_TRUE(names(bs_last_error(), "projector.s_min: is not legal; expected 0 < s_min < s_max"))
        << bs_last_error();
  }
  for (const std::int32_t has : {-1, 2}) {
    desc.has_projector = has;
    EXPECT_EQ(begun(1, 9), BS_BAD_INPUT);
    EXPECT_TRUE(names(bs_last_error(), ".has_projector, .reserved_2: ")) << bs_last_error();
  }
  desc.has_projector = 1;
  desc.reserved_2 = 1;
  EXPECT_EQ(begun(1, 9), BS_BAD_INPUT);
}

TEST(LibMisuse, BadLights) {
  const ConfigHandle config = config_handle("depth16");
  ASSERT_EQ(bs_config_set(config.get(), "light.at", "pixel"), BS_OK) << bs_last_error();
  const ModelHandle model = open_model(config.get(), "model");
  const Scene scene = small_scene();
  Described described(scene);
  const bs_scene_desc good = described.desc;
  const auto refused = [&](const std::function<void(bs_scene_desc&)>& change, const char* line) {
    bs_scene_desc desc = good;
    desc.light_kind = 1;
    change(desc);
    EXPECT_EQ(bs_begin(model.get(), &desc), BS_BAD_INPUT) << line;
    EXPECT_TRUE(names(bs_last_error(), line)) << bs_last_error();
  };
  refused([](bs_scene_desc& d) { d.light_kind = 3; }, ".light_kind: 3; expected 0, 1 or 2");
  refused([](bs_scene_desc& d) { d.light_kind = -1; }, ".light_kind: -1; expected 0, 1 or 2");
  refused([](bs_scene_desc& d) { d.light[2] = 0; }, "light.direction: is not legal");
  refused([](bs_scene_desc& d) { d.light[1] = HUGE_VAL; }, "light.direction: is not legal");
  refused([](bs_scene_desc& d) { d.light_ambient = std::nan(""); }, "light.ambient: is not legal");
  refused([](bs_scene_desc& d) { d.light_specular = 0.9; }, "light.specular: is not legal");
  refused([](bs_scene_desc& d) { d.light_exponent = 0; }, "light.exponent: 0 is not legal");
  refused([](bs_scene_desc& d) { d.light_lunar = 17; }, "light.lunar: is not legal");
  refused([](bs_scene_desc& d) { d.light_reach = -1; }, "light.reach: is not legal");
  refused([](bs_scene_desc& d) { d.light_reach = 1e9; }, "light.reach: 1000000000 is not legal");
  refused([](bs_scene_desc& d) { d.light_offset = NAN; }, "light.offset: is not legal");
  refused([](bs_scene_desc& d) { d.light_kind = 2; }, "its light stands at a point");
  bs_scene_desc desc = good;
  desc.light_kind = 1;
  EXPECT_EQ(bs_begin(model.get(), &desc), BS_OK) << bs_last_error();
}

TEST(LibMisuse, BadOptionsOfAScene) {
  bs_scene* scene = nullptr;
  const auto refused = [&](const std::string& line,
                           const std::function<void(bs_scene_options&, bs_shadow&)>& change,
                           const char* name = "demo") {
    bs_shadow shadow = BS_SHADOW_INIT;
    shadow.light[1] = 60;
    bs_scene_options options = BS_SCENE_OPTIONS_INIT;
    options.width = 64;
    options.height = 48;
    options.shadow = &shadow;
    change(options, shadow);
    EXPECT_EQ(bs_scene_load_with(name, &options, &scene), BS_BAD_INPUT) << line;
    EXPECT_TRUE(names(bs_last_error(), line)) << bs_last_error();
  };
  const std::string shadow = "bs_scene_load_with: options.shadow";
  refused(shadow + ".light: nan is not legal", [](auto&, auto& s) { s.light[2] = std::nan(""); });
  refused(shadow + ".at: inf is not legal", [](auto&, auto& s) { s.has_at = 1, s.at[0] = HUGE_VAL; });
  refused(shadow + ".has_at: 2; expected 0 or 1", [](auto&, auto& s) { s.has_at = 2; });
  refused(shadow + ".map_size: 0 is not legal; expected 1..8192", [](auto&, auto& s) { s.map_size = 0; });
  refused(shadow + ".degrees: 160 is not legal", [](auto&, auto& s) { s.degrees = 160; });
  refused(shadow + ".bias: -2 is not legal; expected 0..64", [](auto&, auto& s) { s.bias = -2; });
  refused(shadow + ".dark: 2 is not legal; expected 0..1", [](auto&, auto& s) { s.dark = 2; });
  refused(shadow + ".size: 8 is not legal", [](auto&, auto& s) { s.size = 8; });
  refused("bs_scene_load_with: options.size: 8 is not legal", [](auto& o, auto&) { o.size = 8; });
  refused("options.reserved: 1; expected 0", [](auto& o, auto&) { o.reserved = 1; });
  refused("bs_scene_load_with: width, height: -1x48", [](auto& o, auto&) { o.width = -1; });
  refused("has no dynamic textures", [](auto& o, auto&) { o.frame = 0; });
  refused(
      "no/such.tri", [](auto&, auto&) {}, "no/such.tri");
  const std::string sea = source_path("tests/data/sea.tri");
  for (const int frame : {-2, 3}) {
    refused(
        "frame", [&](auto& o, auto&) { o = BS_SCENE_OPTIONS_INIT, o.frame = frame; }, sea.c_str());
  }
  bs_scene_options options = BS_SCENE_OPTIONS_INIT;
  EXPECT_EQ(bs_scene_load_with("demo", &options, nullptr), BS_BAD_INPUT);
  EXPECT_EQ(bs_scene_load_with(nullptr, &options, &scene), BS_BAD_INPUT);
}

TEST(LibMisuse, BadVerticesDrawNothing) {
  const Scene scene = small_scene();
  const ConfigHandle config = config_handle("depth16");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(bs_vertex&)>> changes{[&](bs_vertex& v) { v.x = nan; },
                                                             [](bs_vertex& v) { v.y = 32768; },
                                                             [](bs_vertex& v) { v.x = -1e300; },
                                                             [](bs_vertex& v) { v.s = 0; },
                                                             [&](bs_vertex& v) { v.s = nan; },
                                                             [](bs_vertex& v) { v.u = HUGE_VAL; },
                                                             [&](bs_vertex& v) { v.v = nan; },
                                                             [](bs_vertex& v) { v.r = 1.5; },
                                                             [](bs_vertex& v) { v.g = -0.5; },
                                                             [&](bs_vertex& v) { v.b = nan; },
                                                             [](bs_vertex& v) { v.a = 2; },
                                                             [](bs_vertex& v) { v.size = 8; },
                                                             [](bs_vertex& v) { v.size = ~0U; },
                                                             [](bs_vertex& v) { v.fog = 0.5; },
                                                             [&](bs_vertex& v) { v.project_x = nan; },
                                                             [](bs_vertex& v) { v.project_y = HUGE_VAL; },
                                                             [](bs_vertex& v) { v.project_w = -HUGE_VAL; }};
  for (int i = 0; bs_engine_name(i) != nullptr; ++i) {
    const ModelHandle model = open_model(config.get(), bs_engine_name(i));
    for (const auto& change : changes) {
      Described described(scene);
      ASSERT_EQ(bs_begin(model.get(), &described.desc), BS_OK);
      change(described.vertices[7]);
      EXPECT_EQ(bs_draw(model.get(), described.vertices.data(), nullptr, 3, 0, 0), BS_BAD_INPUT)
          << bs_engine_name(i);
      std::int64_t triangles = -1;
      EXPECT_EQ(bs_counter(model.get(), "triangles", &triangles), BS_OK);
      EXPECT_EQ(triangles, 0);
    }
  }
}

}  // namespace
}  // namespace bitspan
