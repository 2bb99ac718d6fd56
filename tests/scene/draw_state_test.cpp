// SPDX-License-Identifier: Apache-2.0
// Draw state: the table of registers, and the commands of a stream.
#include "scene/draw_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "config/check.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

const std::string header =
    R"({"bitspan": 2, "width": 64, "height": 48, "s_min": 1, "s_max": 9, "focal": 50, "background": [0, 0, 0]})";
const std::string triangle =
    "\n"
    R"({"v": [[1, 1, 2, 0, 0], [60, 1, 2, 0, 0], [1, 40, 2, 0, 0]]})";

Scene parsed(const std::string& lines) { return parse_tri(header + lines, "s.tri"); }
std::string refused(const std::string& line) {
  return error_of([&] { parsed("\n" + line + triangle); });
}

TEST(DrawState, FirstValuesAreLegalAndTheConfigurations) {
  Config config;
  config.depth_func = DepthFunc::gequal;
  const DrawState state = first_state(config);
  EXPECT_EQ(state.depth_func, DepthFunc::gequal);
  const std::vector<std::int64_t> values = state_values(state);
  ASSERT_EQ(values.size(), state_registers().size());
  std::set<std::string_view> keys;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const StateRegister& r = state_registers()[i];
    EXPECT_TRUE(values[i] >= r.low && values[i] <= r.high) << r.key;
    EXPECT_TRUE(keys.insert(r.key).second) << r.key;
    EXPECT_EQ(find_state_register(r.key), i);
    // Each setting changes its register and no other.
    const std::int64_t other = values[i] == r.low ? r.low + 1 : r.low;
    StateChange change{false, {{i, other}}};
    if (r.key == "stencil.test") change.settings.push_back({*find_state_register("depth.when"), 1});
    const std::vector<std::int64_t> after = state_values(changed_state(state, change, config));
    EXPECT_EQ(after[i], other) << r.key;
    for (std::size_t j = 0; j < values.size(); ++j) {
      const bool other_too = change.settings.size() > 1;  // depth.when
      EXPECT_TRUE(j == i || other_too || after[j] == values[j]) << r.key;
    }
    change.settings.clear();
    change.reset = true;
    EXPECT_EQ(changed_state(changed_state(state, {false, {{0, 0}}}, config), change, config), state);
  }
}

// The ends of the bias are the configuration's key's; a filter that magnifies is checked as any filter.
TEST(DrawState, RegistersOfLevels) {
  Config config;
  config.lod_bias = 7;
  const DrawState first = first_state(config);
  EXPECT_EQ(first.texture_lod_bias, 7);
  EXPECT_EQ(first.texture1_lod_bias, 7);
  EXPECT_EQ(first_levels(first), (LevelRange{0, 15}));
  EXPECT_EQ(second_levels(first), (LevelRange{0, 15}));
  EXPECT_EQ(first_magnified(first), first_lookup(first));
  EXPECT_EQ(second_magnified(first), second_lookup(first));
  const Scene scene = parsed(R"(
{"state": {"texture.lod.bias": -31, "texture1.lod.bias": 32, "texture.level.least": 3}}
{"state": {"texture1.level.greatest": 2, "texture1.magnify": "bilinear"}})" +
                             triangle);
  const DrawState s = states_of(config, scene.commands).at(1);
  EXPECT_EQ(s.texture_lod_bias, -31);
  EXPECT_EQ(s.texture1_lod_bias, 32);
  EXPECT_EQ(first_levels(s), (LevelRange{3, 15}));
  EXPECT_EQ(second_levels(s), (LevelRange{0, 2}));
  EXPECT_EQ(first_magnified(s), first_lookup(s));
  EXPECT_EQ(second_magnified(s).filter, TextureFilter::bilinear);
  EXPECT_EQ(second_lookup(s).filter, TextureFilter::nearest);
  EXPECT_EQ(refused(R"({"state": {"texture.lod.bias": 33}})"),
            "s.tri:2: state.texture.lod.bias: 33 is not legal; expected a whole number -31..32");
  EXPECT_EQ(refused(R"({"state": {"texture1.level.least": 16}})"),
            "s.tri:2: state.texture1.level.least: 16 is not legal; expected a whole number 0..15");
  EXPECT_EQ(refused(R"({"state": {"texture.magnify": "linear"}})"),
            "s.tri:2: state.texture.magnify: \"linear\" is not legal; expected same, nearest, bilinear");
}

TEST(DrawState, StencilNeedsLateTests) {
  const Scene scene = parsed(R"(
{"state": {"stencil.test": true, "depth.when": "late"}})" +
                             triangle);
  ASSERT_EQ(scene.commands.size(), 1U);
  EXPECT_NE(refused(R"({"state": {"stencil.test": true}})").find("s.tri:2: state.depth.when"),
            std::string::npos);
}

TEST(DrawState, CommandsStandBetweenTriangles) {
  const Scene scene = parsed(R"(
{"state": {"depth.func": "lequal", "depth.write": false, "depth.bias": -3}})" +
                             triangle + R"(
{"clear": {"color": [1, 0.5, 0], "depth": true, "stencil": 7}}
{"state": {}, "reset": true})" +
                             triangle + R"(
{"clear": {"alpha": 0}})");
  ASSERT_EQ(scene.triangles.size(), 2U);
  ASSERT_EQ(scene.commands.size(), 4U);
  EXPECT_EQ(scene.commands[0].before, 0U);
  const DrawState first = changed_state(first_state({}), std::get<StateChange>(scene.commands[0].what), {});
  EXPECT_EQ(first.depth_func, DepthFunc::lequal);
  EXPECT_FALSE(first.depth_write);
  EXPECT_EQ(first.depth_bias, -3);
  EXPECT_EQ(scene.commands[1].before, 1U);
  const auto& clear = std::get<Clear>(scene.commands[1].what);
  EXPECT_EQ(clear.color, (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_TRUE(clear.depth);
  EXPECT_EQ(clear.stencil, 7);
  EXPECT_FALSE(clear.masked);
  EXPECT_TRUE(std::get<StateChange>(scene.commands[2].what).reset);
  EXPECT_EQ(scene.commands[3].before, 2U);
  const Config config;
  const std::vector<DrawState> after = states_of(config, scene.commands);
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(after[0].depth_bias, -3);
  EXPECT_EQ(after[1], first_state(config));
  EXPECT_EQ(all_states_of(config, scene.commands),
            (std::vector<DrawState>{first_state(config), after[0], after[1]}));
  EXPECT_EQ(all_states_of(config, {}), std::vector<DrawState>{first_state(config)});
}

TEST(DrawState, WhatIsRefused) {
  EXPECT_EQ(
      refused(R"({"state": {"depth.func": "lesser"}})"),
      "s.tri:2: state.depth.func: \"lesser\" is not legal; expected never, less, equal, lequal, greater, "
      "notequal, gequal, always");
  EXPECT_NE(
      refused(R"({"state": {"depth.fun": "less"}})").find("state.depth.fun: unknown register; expected"),
      std::string::npos);
  EXPECT_EQ(refused(R"({"state": {"alpha.ref": 256}})"),
            "s.tri:2: state.alpha.ref: 256 is not legal; expected a whole number 0..255");
  EXPECT_EQ(refused(R"({"state": {"depth.write": 1}})"),
            "s.tri:2: state.depth.write: 1 is not legal; expected true or false");
  EXPECT_NE(refused(R"({"state": 3})").find("state: 3 is not an object"), std::string::npos);
  EXPECT_NE(refused(R"({"state": {}, "v": []})").find("unknown key"), std::string::npos);
  EXPECT_NE(refused(R"({"clear": {}})").find("clear: no plane"), std::string::npos);
  EXPECT_NE(refused(R"({"clear": {"masked": true}})").find("clear: no plane"), std::string::npos);
  EXPECT_NE(refused(R"({"clear": {"depth": true, "masked": 1}})").find("clear.masked: 1 is not legal"),
            std::string::npos);
  EXPECT_NE(refused(R"({"clear": {"depth": 1}})").find("clear.depth: 1 is not legal"), std::string::npos);
  EXPECT_NE(refused(R"({"clear": {"stencil": 256}})").find("clear.stencil"), std::string::npos);
  std::string first = header;
  first.replace(first.find('2'), 1, "1");
  EXPECT_NE(error_of([&] {
              parse_tri(first + "\n{\"state\": {}}", "s.tri");
            }).find("s.tri:2: bitspan: a stream of version 1"),
            std::string::npos);
}

TEST(DrawState, ViewsOfAStream) {
  const std::string far =
      "\n"
      R"({"v": [[1, 1, 20, 0, 0], [60, 1, 20, 0, 0], [1, 40, 20, 0, 0]]})";
  const Scene scene = parsed(
      R"(
{"view": {"s_max": 90, "fog": {"color": [1, 0, 0], "distance": 7}}}
{"target": 2})" +
      far + R"(
{"view": {"width": 32, "height": 16, "s_min": 2, "focal": 9, "background": [0, 0, 1], "fog": null}})" +
      far + "\n{\"target\": 0}" + far);
  ASSERT_EQ(scene.commands.size(), 4U);
  EXPECT_EQ(view_at(scene, 0).s_max, 90);
  EXPECT_EQ(view_at(scene, 0).fog, (Fog{{255, 0, 0}, 7}));
  EXPECT_EQ(view_at(scene, 1), (View{32, 16, 2, 90, 9, {0, 0, 255}, {}}));
  EXPECT_EQ(view_at(scene, 2), view_at(scene, 0));  // each target has its own
  EXPECT_TRUE(changes_scene(scene.commands));
  std::ostringstream out;
  write_tri(out, scene);
  EXPECT_TRUE(parse_tri(out.str(), "back.tri").commands == scene.commands);
  EXPECT_EQ(error_of([&] { check_scene(scene, "s"); }), "");

  EXPECT_EQ(refused(R"({"view": {}})"),
            "s.tri:2: view: no key; expected width, height, s_min, s_max, focal, background, fog, projector "
            "or light");
  EXPECT_EQ(refused(R"({"view": {"width": 0}})"),
            "s.tri:2: view.width: 0 is not legal; expected a whole number 1..32768");
  EXPECT_EQ(refused(R"({"view": {"s_max": 1}})"),
            "s.tri:2: view.s_min: 1 to s_max = 1 is not legal; expected 0 < s_min < s_max");
  EXPECT_NE(refused(R"({"view": {"s_max": 1.5}})").find("s.tri:3: v[0][2]: s = 2 is out of range"),
            std::string::npos);
  EXPECT_NE(refused(R"({"view": {"zoom": 1}})").find("unknown key"), std::string::npos);
  EXPECT_NE(refused(R"({"view": {"fog": {"color": [0, 0, 0]}}})").find("view.fog.distance: key is missing"),
            std::string::npos);
}

TEST(DrawState, ViewsHaveProjectors) {
  const Scene scene = parsed(triangle +
                             R"(
{"view": {"projector": {"s_min": 0.5, "s_max": 8}}})" +
                             triangle + R"(
{"target": 1})" + triangle + R"(
{"view": {"projector": null}})" +
                             triangle + "\n{\"target\": 0}" + triangle);
  EXPECT_EQ(view_at(scene, 0).projector, std::nullopt);
  EXPECT_EQ(view_at(scene, 1).projector, (Projector{0.5, 8}));
  EXPECT_EQ(view_at(scene, 2).projector, (Projector{0.5, 8}));  // as the view in force had it
  EXPECT_EQ(view_at(scene, 3).projector, std::nullopt);
  EXPECT_EQ(view_at(scene, 4).projector, (Projector{0.5, 8}));
  EXPECT_NE(view_at(scene, 0), view_at(scene, 1));
  std::ostringstream out;
  write_tri(out, scene);
  EXPECT_NE(out.str().find(R"({"view":{"projector":{"s_min":0.5,"s_max":8.0}}})"), std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find(R"({"view":{"projector":null}})"), std::string::npos);
  EXPECT_TRUE(parse_tri(out.str(), "back.tri").commands == scene.commands);

  EXPECT_EQ(refused(R"({"view": {"projector": 1}})"),
            "s.tri:2: view.projector: 1 is not an object; expected {\"s_min\": a, \"s_max\": b}");
  EXPECT_EQ(refused(R"({"view": {"projector": {"s_min": 1}}})"),
            "s.tri:2: view.projector.s_max: key is missing; expected a distance above 0");
  EXPECT_EQ(refused(R"({"view": {"projector": {"s_min": 3, "s_max": 2}}})"),
            "s.tri:2: view.projector.s_min: 3 is not below s_max = 2; expected 0 < s_min < s_max");
  EXPECT_NE(refused(R"({"view": {"projector": {"s_min": 1, "s_max": 2, "x": 0}}})").find("unknown key"),
            std::string::npos);
  const auto changed = [](double s_min, double s_max) {
    return error_of([&] { changed_view({}, {.projector = Projector{s_min, s_max}}); });
  };
  EXPECT_EQ(changed(1, 2), "");
  for (const auto& [s_min, s_max] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {1.0, HUGE_VAL}, {std::nan(""), 1.0}}) {
    EXPECT_EQ(changed(s_min, s_max).find("projector.s_min: "), 0U) << changed(s_min, s_max);
  }
}

// A configuration says whether it can divide.
TEST(DrawState, ProjectedCoordinatesNeedTheUnit) {
  const StateChange change{false, {{*find_state_register("texture1.coordinates"), 1}}};
  Config config = shipped_config("depth16");
  ASSERT_FALSE(first_violation(config));
  ASSERT_EQ(config.project, ProjectUnit::none);
  const auto refused_by = [&](const Config& c) {
    return error_of([&] { changed_state(first_state(c), change, c, 0); });
  };
  EXPECT_EQ(
      refused_by(config),
      "texture1.coordinates: is project, and the configuration has project.unit = none; expected uv, or "
      "project.unit = reciprocal");
  Scene scene;
  scene.commands = {{0, change}};
  EXPECT_NE(error_of([&] { check_commands(config, scene); }), "");
  config.project = ProjectUnit::reciprocal;
  ASSERT_FALSE(first_violation(config));
  EXPECT_EQ(refused_by(config), "");
  EXPECT_EQ(error_of([&] { check_commands(config, scene); }), "");
  // A stream is read without a configuration.
  const Scene read = parsed(
      "\n"
      R"({"state": {"texture1.coordinates": "project", "texture1.outside": "dark", "texture1.compare": true, "texture1.func": "less", "texture1.bias": -5}})");
  EXPECT_EQ(read.commands.size(), 1U);
}

TEST(DrawState, CopiesOfAStream) {
  const std::string with_texture =
      R"({"bitspan": 2, "width": 64, "height": 48, "s_min": 1, "s_max": 9, "focal": 50, "background": [0, 0, 0], "textures": [{"procedural": {"kind": "checker", "width": 64, "height": 48, "colors": [[0, 0, 0, 0], [0, 0, 0, 0]], "cell_width": 1, "cell_height": 1}}]})";
  const auto read = [&](const std::string& lines) { return parse_tri(with_texture + lines, "s.tri"); };
  const std::string copy =
      "\n"
      R"({"copy": {"target": 0, "plane": "depth", "texture": 0}})";
  const Scene scene = read(triangle + copy + triangle);
  ASSERT_EQ(scene.commands.size(), 1U);
  EXPECT_EQ(std::get<Copy>(scene.commands[0].what), (Copy{0, CopyPlane::depth, 0}));
  EXPECT_EQ(parse_command(command_text(scene.commands[0]), "back").what, scene.commands[0].what);
  const auto fault = [&](const std::string& lines) { return error_of([&] { read("\n" + lines); }); };
  EXPECT_EQ(fault(R"({"copy": {"target": 1, "plane": "color", "texture": 0}})"),
            "s.tri:2: copy.target: 1 has not been drawn on; expected a line {\"target\": 1} in front");
  EXPECT_EQ(fault(R"({"copy": {"target": 0, "plane": "color", "texture": 1}})"),
            "s.tri:2: copy.texture: texture 1 does not exist, the header has 1; expected an index below");
  EXPECT_EQ(fault(R"({"copy": {"target": 0, "plane": "stencil", "texture": 0}})"),
            "s.tri:2: copy.plane: \"stencil\" is not legal; expected color or depth");
  EXPECT_NE(fault(R"({"copy": {"target": 0, "plane": "color"}})").find("copy.texture: key is missing"),
            std::string::npos);
  EXPECT_EQ(fault("{\"view\": {\"width\": 32}}\n"
                  R"({"copy": {"target": 0, "plane": "color", "texture": 0}})"),
            "s.tri:3: copy: texture 0 has 64x48 texels, target 0 has 32x48 pixels; expected the same size");
}

TEST(DrawState, TargetsOfAStream) {
  const std::string lines =
      "\n{\"target\": 7}" + triangle + "\n{\"target\": 2}" + triangle + triangle + "\n{\"target\": 7}";
  const Scene scene = parsed(lines);
  ASSERT_EQ(scene.commands.size(), 3U);
  EXPECT_EQ(std::get<Target>(scene.commands[0].what).k, 7);
  EXPECT_EQ(targets_of(scene.commands), (std::vector<int>{0, 2, 7}));
  EXPECT_EQ(target_at(scene.commands, 0), 7);
  EXPECT_EQ(target_at(scene.commands, 1), 2);
  EXPECT_EQ(target_at(scene.commands, 2), 2);
  EXPECT_EQ(target_at(scene.commands, 3), 7);
  EXPECT_EQ(targets_of({}), std::vector<int>{0});
  EXPECT_TRUE(states_of({}, scene.commands).empty());
  std::ostringstream out;
  write_tri(out, scene);
  EXPECT_TRUE(parse_tri(out.str(), "back.tri").commands == scene.commands);
  for (const char* value : {"8", "-1", "1.5", "\"a\"", "null"}) {
    EXPECT_NE(
        refused(R"({"target": )" + std::string(value) + "}")
            .find("s.tri:2: target: " + std::string(value) + " is not legal; expected a whole number 0..7"),
        std::string::npos)
        << refused(R"({"target": )" + std::string(value) + "}");
  }
  EXPECT_NE(refused(R"({"target": 1, "state": {}})").find("unknown key"), std::string::npos);
}

// A texture beyond the scene's is refused by reader and table.
TEST(DrawState, TheSecondTextureIsOneOfTheScene) {
  EXPECT_EQ(refused(R"({"state": {"texture1": 0}})"),
            "s.tri:2: state.texture1: texture 0 does not exist, the header has 0; expected -1 to -1");
  EXPECT_EQ(refused(R"({"state": {"texture1": -2}})"),
            "s.tri:2: state.texture1: -2 is not legal; expected a whole number -1..65535");
  EXPECT_EQ(
      refused(R"({"state": {"texture1.op": "mix"}})"),
      "s.tri:2: state.texture1.op: \"mix\" is not legal; expected replace, modulate, decal, blend, add, "
      "modulate_scaled, relief, shadow");
  const Scene scene = parsed(
      "\n"
      R"({"state": {"texture1": -1, "texture1.scale": 2}})" +
      triangle);
  EXPECT_EQ(scene.commands.size(), 1U);
  const StateChange change{false, {{*find_state_register("texture1"), 2}}};
  EXPECT_EQ(changed_state(first_state({}), change, {}, 3).texture1, 2);
  EXPECT_EQ(error_of([&] { changed_state(first_state({}), change, {}, 2); }),
            "texture1: texture 2 does not exist, the scene has 2; expected -1 to 1");
  // Commands are seen by the same rule.
  Scene own;
  own.commands = {{0, change}};
  own.textures.resize(2);
  EXPECT_NE(error_of([&] { check_commands({}, own); }), "");
  own.textures.resize(3);
  EXPECT_EQ(error_of([&] { check_commands({}, own); }), "");
}

TEST(DrawState, RandomCommandsReadBack) {
  RandomOptions options;
  options.command_probability = 0.5;
  options.second_texture = false;  // the textures are not written
  for (std::uint64_t seed = 1; seed < 30; ++seed) {
    const Scene scene = random_scene(seed, options);
    ASSERT_FALSE(scene.commands.empty());
    std::ostringstream out;
    Scene bare = scene;
    bare.textures.clear();
    for (Triangle& t : bare.triangles) t.texture = -1;
    write_tri(out, bare);
    EXPECT_TRUE(parse_tri(out.str(), "back.tri").commands == scene.commands) << "seed " << seed;
    options.command_probability = 0;
    EXPECT_EQ(random_scene(seed, options).triangles.front().v[0].x, scene.triangles.front().v[0].x);
    options.command_probability = 0.5;
  }
}

TEST(DrawState, TrianglesTakenOutLeaveTheCommands) {
  Scene scene;
  scene.triangles.resize(10);
  for (const std::size_t before : {0, 3, 4, 5, 9, 10}) {
    scene.commands.emplace_back().before = before;
  }
  erase_triangles(scene, 3, 4);
  ASSERT_EQ(scene.triangles.size(), 6U);
  std::vector<std::size_t> places;
  for (const DrawCommand& c : scene.commands) places.push_back(c.before);
  EXPECT_EQ(places, (std::vector<std::size_t>{0, 3, 3, 3, 5, 6}));
}

// The table of docs/formats.md; BITSPAN_UPDATE_DOCS=1 writes it anew.
TEST(DrawState, ThePageHasEveryRegister) {
  const std::vector<std::int64_t> first = state_values(first_state({}));
  Config other;
  other.depth_func = DepthFunc::never;
  other.filter = TextureFilter::bilinear;
  other.wrap = TextureWrap::border;
  other.lod_bias = 1;
  const std::vector<std::int64_t> configured = state_values(first_state(other));
  std::vector<std::string> rows{"| register | values | at first | what |", "|---|---|---|---|"};
  for (std::size_t i = 0; i < first.size(); ++i) {
    const StateRegister& r = state_registers()[i];
    const auto value = [&](std::int64_t v) {
      return "`" + (r.names.empty() ? std::to_string(v) : std::string(r.names[static_cast<std::size_t>(v)])) +
             "`";
    };
    std::string values;
    if (r.names.empty()) {
      values = std::to_string(r.low) + ".." + std::to_string(r.high);
    } else {
      for (const std::string_view name : r.names)
        values += (values.empty() ? "`" : ", `") + std::string(name) + "`";
    }
    const std::string at_first = first[i] == configured[i] ? value(first[i]) : "the configuration's";
    rows.push_back("| `" + std::string(r.key) + "` | " + values + " | " + at_first + " | " +
                   std::string(r.meaning) + " |");
  }
  const std::string path = source_path("docs/formats.md");
  std::ifstream in(path);
  std::vector<std::string> page;
  for (std::string line; std::getline(in, line);) page.push_back(line);
  const auto begin = std::ranges::find(page, "<!-- draw state -->");
  const auto end = std::ranges::find(page, "<!-- end of draw state -->");
  ASSERT_TRUE(begin != page.end() && end != page.end());
  if (std::getenv("BITSPAN_UPDATE_DOCS") != nullptr) {
    std::vector<std::string> written(page.begin(), begin + 1);
    written.insert(written.end(), rows.begin(), rows.end());
    written.insert(written.end(), end, page.end());
    std::ofstream out(path);
    for (const std::string& line : written) out << line << "\n";
    return;
  }
  EXPECT_EQ(std::vector<std::string>(begin + 1, end), rows) << "BITSPAN_UPDATE_DOCS=1 writes it anew";
}

}  // namespace
}  // namespace bitspan
