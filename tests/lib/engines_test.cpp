// SPDX-License-Identifier: Apache-2.0
// What the C interface delivers against the engines behind it: every record, plane, counter and format.
#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "engine/registry.hpp"
#include "lib/stages.hpp"
#include "model/engine_model.hpp"
#include "report/describe.hpp"
#include "report/position.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using capi::stage_types;

Scene small_random(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 25;
  options.size_max = 60;
  return random_scene(seed, options);
}

void expect_same_records(const Trace& trace, bs_model* model) {
  for (bs_stage stage = 0; stage < record_types; ++stage) {
    const RecordView expected = view_of(trace, stage_types[static_cast<std::size_t>(stage)]);
    const bs_view view = records_view(model, stage);
    EXPECT_EQ(view.columns, expected.fields.size());
    EXPECT_EQ(view.stride, view.columns * sizeof(std::int64_t));
    EXPECT_EQ(view.element, BS_I64);
    ASSERT_EQ(view.rows, expected.records) << bs_stage_name(stage);
    const std::vector<std::int64_t> values(expected.values,
                                           expected.values + expected.records * expected.fields.size());
    EXPECT_TRUE(records(model, stage) == values) << bs_stage_name(stage);
  }
}

void expect_same_frame(const Frame& frame, bs_model* model) {
  EXPECT_EQ(plane<std::uint8_t>(model, BS_PLANE_COLOR), frame.color);
  EXPECT_EQ(plane<std::uint32_t>(model, BS_PLANE_DEPTH), frame.depth);
  EXPECT_EQ(plane<std::int32_t>(model, BS_PLANE_TRIANGLE), frame.triangle);
  EXPECT_TRUE(same_bits(plane<double>(model, BS_PLANE_U), frame.u));
  EXPECT_TRUE(same_bits(plane<double>(model, BS_PLANE_V), frame.v));
}

void expect_same_counters(const Counters& counters, bs_model* model) {
  int i = 0;
  for_each_counter([&](const CounterInfo& info, auto member) {
    EXPECT_STREQ(bs_counter_name(i++), std::string(info.name).c_str());
    std::int64_t value = -1;
    EXPECT_EQ(bs_counter(model, std::string(info.name).c_str(), &value), BS_OK) << bs_last_error();
    EXPECT_EQ(value, static_cast<std::int64_t>(counters.*member)) << info.name;
  });
  EXPECT_EQ(bs_counter_name(i), nullptr);
}

// Draws by the interface, at once or triangle by triangle, and by the engine itself.
void compare(const Scene& scene, const std::string& name, const std::string& mode, const std::string& engine,
             bool one_by_one) {
  SCOPED_TRACE(scene.name + ", " + name + " " + mode + ", " + engine + (one_by_one ? ", one by one" : ""));
  const ConfigHandle handle = config_handle(name, mode);
  Config config = shipped_config(name);
  for (const Perspective p : all_perspectives) {
    if (to_string(p) == mode) config.perspective = p;
  }
  EXPECT_EQ(bs_config_hash(handle.get()), config_hash(config));
  const ModelHandle model = open_model(handle.get(), engine);
  const Described described(scene);
  ASSERT_EQ(bs_begin(model.get(), &described.desc), BS_OK) << bs_last_error();
  const auto own = make_engine(engine, config);
  Trace trace;
  own->begin(scene);
  if (one_by_one) {
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      ASSERT_EQ(bs_triangle(model.get(), &described.vertices[3 * i], described.texture_of[i], 0, i), BS_OK)
          << bs_last_error();
      own->draw(std::span(scene.triangles).subspan(i, 1), static_cast<std::int64_t>(i), &trace);
    }
  } else {
    draw(model.get(), described);
    own->draw(scene.triangles, 0, &trace);
  }
  if (find_engine(engine).compared) {
    EXPECT_GT(trace.fragment.size(), 100U);
    expect_same_records(trace, model.get());
  }
  expect_same_frame(own->frame(), model.get());
  EXPECT_TRUE(same_bits(plane<double>(model.get(), BS_PLANE_POSITION),
                        positions_of(config, scene, own->frame()).points));
  expect_same_counters(own->counters(), model.get());
}

TEST(LibEngines, AreThoseOfTheRegistryAndOfPlugins) {
  std::size_t i = 0;
  for (const std::string_view name : engine_names()) EXPECT_EQ(bs_engine_name(static_cast<int>(i++)), name);
  EXPECT_EQ(i, 4U);
  EXPECT_STREQ(bs_engine_name(4), "systemc");
  EXPECT_STREQ(bs_engine_name(5), "rtl");
  EXPECT_EQ(bs_engine_name(6), nullptr);
  EXPECT_EQ(bs_engine_name(-1), nullptr);
}

TEST(LibEngines, DemoIsTheEnginesOwn) {
  const Scene scene = demo_scene(160, 120);
  for (const std::string name : {"depth16", "depth20"}) {
    for (const std::string_view engine : engine_names()) compare(scene, name, "", std::string(engine), false);
  }
}

TEST(LibEngines, RandomScenesAreTheEnginesOwnInEveryMode) {
  std::uint64_t seed = 1;
  for (const Perspective mode : all_perspectives) {
    const Scene scene = small_random(seed++);
    for (const std::string_view engine : engine_names()) {
      compare(scene, "depth16", std::string(to_string(mode)), std::string(engine), seed % 2 == 0);
      compare(scene, "depth16", std::string(to_string(mode)), std::string(engine), seed % 2 == 1);
    }
  }
}

TEST(LibEngines, TimedCountsCycles) {
  const Scene scene = small_random(3);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "timed");
  draw(model.get(), described);
  std::int64_t cycles = 0;
  EXPECT_EQ(bs_counter(model.get(), "cycles", &cycles), BS_OK);
  EXPECT_GT(cycles, 1000);
}

TEST(LibEngines, FieldsAreThoseOfTheRecords) {
  int integers = 0;
  for (const std::string name : {"depth16", "depth20"}) {
    for (const Perspective mode : all_perspectives) {
      const ConfigHandle handle = config_handle(name, std::string(to_string(mode)));
      Config config = shipped_config(name);
      config.perspective = mode;
      for (bs_stage stage = 0; stage < record_types; ++stage) {
        const RecordType type = stage_types[static_cast<std::size_t>(stage)];
        EXPECT_EQ(bs_stage_name(stage), stage_of(type));
        int i = 0;
        for (const Field& field : fields_of(type)) {
          bs_field_info info{};
          info.size = sizeof info;
          ASSERT_EQ(bs_field(handle.get(), stage, i++, &info), BS_OK) << bs_last_error();
          EXPECT_EQ(info.name, field.name);
          EXPECT_EQ(info.unit, unit_of(field, config));
          const auto format = format_of(field, config).value_or(Format{0, 0, false, {}, {}, false});
          EXPECT_EQ(info.word, format.word) << field.name;
          EXPECT_EQ(info.fraction, format.fraction()) << field.name;
          EXPECT_EQ(info.is_signed, format.is_signed ? 1 : 0) << field.name;
          integers += info.word == 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(integers, 100);
  EXPECT_EQ(bs_stage_name(record_types), nullptr);
  EXPECT_EQ(bs_stage_name(-1), nullptr);
}

TEST(LibEngines, RecordsComeInTheMemoryOfTheTrace) {
  const Scene scene = small_random(5);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth16");
  const ModelHandle model = open_model(config.get(), "model");
  draw(model.get(), described);
  EXPECT_EQ(records_view(model.get(), BS_STAGE_SPAN).base, records_view(model.get(), BS_STAGE_SPAN).base);
  ASSERT_EQ(bs_clear_records(model.get()), BS_OK);
  EXPECT_EQ(records_view(model.get(), BS_STAGE_SPAN).rows, 0U);
  EXPECT_EQ(records_view(model.get(), BS_STAGE_SPAN).base, nullptr);
}

TEST(LibEngines, TracingOffChangesNoPicture) {
  const Scene scene = small_random(6);
  const Described described(scene);
  const ConfigHandle config = config_handle("depth20");
  const ModelHandle traced = open_model(config.get(), "model");
  const ModelHandle plain = open_model(config.get(), "model");
  ASSERT_EQ(bs_trace(plain.get(), 0), BS_OK);
  draw(traced.get(), described);
  draw(plain.get(), described);
  EXPECT_EQ(plane<std::uint8_t>(plain.get(), BS_PLANE_COLOR),
            plane<std::uint8_t>(traced.get(), BS_PLANE_COLOR));
  bs_view view{};
  view.size = sizeof view;
  EXPECT_EQ(bs_records(plain.get(), BS_STAGE_SPAN, &view), BS_BAD_ORDER);
  ASSERT_EQ(bs_trace(plain.get(), 1), BS_OK);
  EXPECT_EQ(bs_records(plain.get(), BS_STAGE_SPAN, &view), BS_BAD_ORDER);
  draw(plain.get(), described);
  EXPECT_TRUE(records(plain.get(), BS_STAGE_SPAN) == records(traced.get(), BS_STAGE_SPAN));
}

TEST(LibScenes, StreamsAndMeshesAreRead) {
  bs_scene* scene = nullptr;
  const std::string spot = source_path("tests/data/spot.obj");
  ASSERT_EQ(bs_scene_load(spot.c_str(), 160, 120, &scene), BS_OK) << bs_last_error();
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  EXPECT_EQ(bs_scene_get(scene, &desc), BS_OK);
  EXPECT_EQ(desc.width, 160);
  const bs_vertex* vertices = nullptr;
  const std::int32_t* textures = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(bs_scene_triangles(scene, &vertices, &textures, &count), BS_OK);
  EXPECT_GT(count, 1000U);
  bs_scene_free(scene);
}

TEST(LibScenes, WhatAMeshLeavesOutIsTold) {
  const TemporaryFolder folder;
  const std::string corners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\nf 3 2 1\n";
  for (const bool has_point : {false, true}) {
    bs_scene* scene = nullptr;
    const std::string path = folder.write("a.obj", corners + (has_point ? "p 1\n" : ""));
    ASSERT_EQ(bs_scene_load(path.c_str(), 160, 120, &scene), BS_OK) << bs_last_error();
    const std::string notes = bs_scene_notes(scene);
    EXPECT_EQ(notes.empty(), !has_point) << notes;
    EXPECT_EQ(std::count(notes.begin(), notes.end(), '\n'), has_point ? 1 : 0) << notes;
    bs_scene_free(scene);
  }
}

TEST(LibScenes, AFrameOfDynamicTextures) {
  const std::string sea = source_path("tests/data/sea.tri");
  const ConfigHandle config = config_handle("depth16");
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int frame = 0; frame < 3; ++frame) {
    bs_scene* loaded = nullptr;
    ASSERT_EQ(bs_scene_load_frame(sea.c_str(), 0, 0, frame, &loaded), BS_OK) << bs_last_error();
    const std::unique_ptr<bs_scene, CloseHandle> scene(loaded);
    const Scene same = read_tri(sea, frame);
    const auto engine = make_model(shipped_config("depth16"));
    engine->begin(same);
    draw_scene(*engine, same, 0, same.triangles.size(), nullptr);
    bs_scene_desc desc = BS_SCENE_DESC_INIT;
    ASSERT_EQ(bs_scene_get(scene.get(), &desc), BS_OK);
    const ModelHandle model = open_model(config.get(), "model");
    ASSERT_EQ(bs_begin(model.get(), &desc), BS_OK) << bs_last_error();
    ASSERT_EQ(bs_draw_scene(model.get(), scene.get(), 0, same.triangles.size(), 0, 0), BS_OK);
    expect_same_frame(engine->frame(), model.get());
    pictures.push_back(engine->frame().color);
  }
  EXPECT_NE(pictures[0], pictures[2]);
}

// A triangle under a light, per pixel: the records of light, and the colours of what they say.
TEST(LibScenes, LightOnATriangle) {
  const ConfigHandle config = config_handle("depth16");
  ASSERT_EQ(bs_config_set(config.get(), "light.at", "pixel"), BS_OK) << bs_last_error();
  ASSERT_EQ(bs_config_set(config.get(), "light.source", "point"), BS_OK) << bs_last_error();
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  desc.width = desc.height = 32;
  desc.light_kind = 2;
  desc.light[0] = 0.25;
  desc.light[2] = 1;
  desc.light_specular = 0.5;
  std::vector<bs_vertex> vertices(3, bs_vertex BS_VERTEX_INIT);
  vertices[1].x = vertices[2].y = 30;
  for (bs_vertex& v : vertices) {
    v.s = 4;
    v.nz = -1;
  }
  std::vector<std::vector<std::int64_t>> all;
  for (const char* engine : {"model", "golden"}) {
    const ModelHandle model = open_model(config.get(), engine);
    ASSERT_EQ(bs_begin(model.get(), &desc), BS_OK) << bs_last_error();
    ASSERT_EQ(bs_draw(model.get(), vertices.data(), nullptr, 1, 0, 0), BS_OK) << bs_last_error();
    all.push_back(records(model.get(), BS_STAGE_LIGHT));
    EXPECT_GT(plane<std::uint8_t>(model.get(), BS_PLANE_COLOR)[0], 200);
  }
  EXPECT_GT(all[0].size(), 4000U);
  EXPECT_EQ(all[0], all[1]);
  EXPECT_EQ(std::string(bs_stage_name(BS_STAGE_LIGHT)), "light");
}

// The demo with shadows, from the library's own plan and from bs_scene_load_with.
TEST(LibScenes, ShadowsOfAScene) {
  const ConfigHandle config = config_handle("depth16");
  ASSERT_EQ(bs_config_set(config.get(), "project.unit", "reciprocal"), BS_OK) << bs_last_error();
  bs_shadow shadow = BS_SHADOW_INIT;
  shadow.light[0] = 30;
  shadow.light[1] = 60;
  shadow.map_size = 64;
  bs_scene_options options = BS_SCENE_OPTIONS_INIT;
  options.width = 96;
  options.height = 72;
  const auto loaded = [&](const char* name) {
    bs_scene* out = nullptr;
    EXPECT_EQ(bs_scene_load_with(name, &options, &out), BS_OK) << bs_last_error();
    return std::unique_ptr<bs_scene, CloseHandle>(out);
  };
  const auto drawn = [&](bs_model* model, bs_scene* scene) {
    bs_scene_desc desc = BS_SCENE_DESC_INIT;
    EXPECT_EQ(bs_scene_get(scene, &desc), BS_OK);
    EXPECT_EQ(desc.has_projector, options.shadow == nullptr ? 0 : 1);
    const bs_vertex* vertices = nullptr;
    const std::int32_t* textures = nullptr;
    std::size_t count = 0;
    EXPECT_EQ(bs_scene_triangles(scene, &vertices, &textures, &count), BS_OK);
    EXPECT_EQ(vertices[3 * count - 1].project_w != 0, options.shadow != nullptr);
    EXPECT_EQ(bs_begin(model, &desc), BS_OK) << bs_last_error();
    EXPECT_EQ(bs_draw_scene(model, scene, 0, count, 0, 0), BS_OK) << bs_last_error();
    return plane<std::uint8_t>(model, BS_PLANE_COLOR);
  };
  const ModelHandle model = open_model(config.get(), "model"), golden = open_model(config.get(), "golden");
  const auto plain = drawn(model.get(), loaded("demo").get());
  EXPECT_TRUE(records(model.get(), BS_STAGE_PROJECT).empty());
  options.shadow = &shadow;
  const auto lit = loaded("demo");
  const auto picture = drawn(model.get(), lit.get());
  EXPECT_NE(picture, plain);
  EXPECT_EQ(drawn(golden.get(), lit.get()), picture);
  const auto projected = records(model.get(), BS_STAGE_PROJECT);
  EXPECT_GT(projected.size(), 1000U);
  EXPECT_EQ(records(golden.get(), BS_STAGE_PROJECT), projected);
  EXPECT_EQ(std::string(bs_stage_name(BS_STAGE_PROJECT)), "project");

  Config full = shipped_config("depth16");
  full.project = ProjectUnit::reciprocal;
  const Scene same = demo_scene(96, 72, ShadowOptions{.light = {30, 60, 0}, .size = 64});
  const auto engine = make_model(full);
  engine->begin(same);
  draw_scene(*engine, same, 0, same.triangles.size(), nullptr);
  expect_same_frame(engine->frame(), model.get());

  // A shorter struct of an older caller has the other defaults.
  shadow.size = offsetof(bs_shadow, at);
  shadow.map_size = -1;  // not read
  EXPECT_EQ(drawn(model.get(), loaded("demo").get()).size(), picture.size());
  options.size = offsetof(bs_scene_options, frame);
  EXPECT_EQ(bs_scene_load_with("demo", &options, nullptr), BS_BAD_INPUT);
  options.shadow = nullptr;
  EXPECT_EQ(drawn(model.get(), loaded("demo").get()), plain);
  options.size = sizeof options;
  // NULL for all defaults, and other scenes.
  bs_scene* all = nullptr;
  ASSERT_EQ(bs_scene_load_with("demo", nullptr, &all), BS_OK) << bs_last_error();
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  EXPECT_EQ(bs_scene_get(all, &desc), BS_OK);
  EXPECT_EQ(desc.width, 640);
  bs_scene_free(all);
  shadow = BS_SHADOW_INIT;
  shadow.map_size = 64;
  shadow.light[1] = -20;
  options.shadow = &shadow;
  EXPECT_EQ(drawn(model.get(), loaded("demo@2").get()), drawn(golden.get(), loaded("demo@2").get()));
  const std::string spot = source_path("tests/data/spot.obj");
  shadow.light[1] = 5;
  EXPECT_EQ(drawn(model.get(), loaded(spot.c_str()).get()), drawn(golden.get(), loaded(spot.c_str()).get()));
}

// What a caller describes is what a scene of the library has.
TEST(LibScenes, ProjectorsAreDescribed) {
  const ConfigHandle config = config_handle("depth16");
  ASSERT_EQ(bs_config_set(config.get(), "project.unit", "reciprocal"), BS_OK);
  Scene scene;
  for (std::uint64_t seed = 5; scene.textures.empty(); ++seed) scene = small_random(seed);
  scene.commands.clear();
  scene.projector = Projector{2, 40};
  Random random(1);
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) {
      v.project_w = random.uniform(1, 60);
      v.project_x = v.project_w * random.uniform(-2, 9);
      v.project_y = v.project_w * random.uniform(-2, 9);
    }
  }
  Config full = shipped_config("depth16");
  full.project = ProjectUnit::reciprocal;
  const auto engine = make_model(full);
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  const Described described(scene);
  const ModelHandle model = open_model(config.get(), "model");
  draw(model.get(), described);
  expect_same_frame(engine->frame(), model.get());
  // Records of the channels are there because of the projector.
  EXPECT_FALSE(records(model.get(), BS_STAGE_SETUP_CHANNEL).empty());
  ASSERT_EQ(bs_begin(model.get(), &described.desc), BS_OK);
  ASSERT_EQ(bs_command(model.get(), R"({"state": {"texture1": 0, "texture1.coordinates": "project"}})"),
            BS_OK)
      << bs_last_error();
  ASSERT_EQ(bs_draw(model.get(), described.vertices.data(), described.texture_of.data(),
                    described.texture_of.size(), 0, 0),
            BS_OK);
  EXPECT_FALSE(records(model.get(), BS_STAGE_PROJECT).empty());
}

TEST(LibScenes, ABinaryStreamByItsContents) {
  const TemporaryFolder folder;
  const Scene scene = small_random(5);
  write_tri_file(folder.path("a.trib"), scene);
  write_tri_file(folder.path("b.tri"), read_tri(folder.path("a.trib")));
  std::filesystem::copy_file(folder.path("a.trib"), folder.path("c.bin"));
  const ConfigHandle config = config_handle("depth16");
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const char* const name : {"a.trib", "b.tri", "c.bin"}) {
    bs_scene* loaded = nullptr;
    ASSERT_EQ(bs_scene_load(folder.path(name).c_str(), 0, 0, &loaded), BS_OK) << bs_last_error();
    const std::unique_ptr<bs_scene, CloseHandle> handle(loaded);
    bs_scene_desc desc = BS_SCENE_DESC_INIT;
    ASSERT_EQ(bs_scene_get(handle.get(), &desc), BS_OK);
    const ModelHandle model = open_model(config.get(), "model");
    ASSERT_EQ(bs_begin(model.get(), &desc), BS_OK) << bs_last_error();
    ASSERT_EQ(bs_draw_scene(model.get(), handle.get(), 0, scene.triangles.size(), 0, 0), BS_OK);
    pictures.push_back(plane<std::uint8_t>(model.get(), BS_PLANE_COLOR));
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
  const std::string bytes = folder.read("a.trib");
  const std::string cut = folder.write("cut.trib", bytes.substr(0, bytes.size() / 2));
  bs_scene* none = nullptr;
  EXPECT_EQ(bs_scene_load(cut.c_str(), 0, 0, &none), BS_BAD_INPUT);
  EXPECT_NE(
      std::string(bs_last_error()).find(": byte " + std::to_string(bytes.size() / 2) + ": the file ends"),
      std::string::npos)
      << bs_last_error();
}

TEST(LibConfig, SetChangesWhatTheFileWouldSay) {
  const ConfigHandle config = config_handle("depth16");
  ASSERT_EQ(bs_config_set(config.get(), "formats.span.uv.word", "23"), BS_OK) << bs_last_error();
  ASSERT_EQ(bs_config_set(config.get(), "start_offset.edge_x", "0.5"), BS_OK) << bs_last_error();
  Config expected = shipped_config("depth16");
  expected.format(FormatId::span_uv).word = 23;
  expected.start_offset.edge_x = {false, 0.5};
  EXPECT_EQ(bs_config_text(config.get()), to_toml(expected));
  bs_config* again = nullptr;
  ASSERT_EQ(bs_config_parse(bs_config_text(config.get()), &again), BS_OK) << bs_last_error();
  EXPECT_STREQ(bs_config_hash(again), bs_config_hash(config.get()));
  bs_config_free(again);
}

}  // namespace
}  // namespace bitspan
