// SPDX-License-Identifier: Apache-2.0
// Computes what the program makes of many configurations and scenes, and compares it with digests/.
//
// A failure names the quantities that differ. A build of before has their values in quantities/NAME.txt
// beside its program; compare that with the quantities/NAME.differs.txt of this one.
//
// Where results are meant to change, write the digests anew, and look at what changed before it is committed:
//
//   BITSPAN_FREEZE=1 build/release/tests/frozen/frozen_test && git diff --stat tests/frozen/digests
//
// With --gtest_filter only the files of those tests are written. BITSPAN_FREEZE=configs also draws the random
// configurations of random_configs.jsonl anew.
#include <gtest/gtest.h>

#include <array>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/records.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/frozen/cases.hpp"
#include "tests/frozen/digest_lines.hpp"
#include "tests/frozen/quantities.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::frozen {
namespace {

enum class What { all, values, clocks };

void check_config_section(DigestLines& file, const Config& config) {
  file.check("configuration " + config.name, config_quantities(config));
}

void check_scene_section(DigestLines& file, const Scene& scene) {
  file.check("scene " + scene.name, scene_quantities(scene));
}

void check_case(DigestLines& file, const Config& config, const Scene& scene, ClockedBy by,
                What what = What::all) {
  Computed computed;
  try {
    if (what != What::clocks) computed = value_quantities(config, scene);
    const Computed clocks = what == What::values ? Computed{} : clock_quantities(config, scene, by);
    computed.groups.insert(computed.groups.end(), clocks.groups.begin(), clocks.groups.end());
    computed.disagreements.insert(computed.disagreements.end(), clocks.disagreements.begin(),
                                  clocks.disagreements.end());
  } catch (const std::exception& error) {
    computed.disagreements.push_back(std::string("an engine threw: ") + error.what());
  }
  file.check(config.name + " on " + scene.name, computed);
}

// Each configuration on each scene.
void check_all(const std::string& file_name, const std::vector<Config>& configs,
               const std::vector<Scene>& scenes, What what = What::all, ClockedBy by = ClockedBy::both) {
  DigestLines file(file_name);
  for (const Scene& scene : scenes) check_scene_section(file, scene);
  for (const Config& config : configs) {
    check_config_section(file, config);
    for (const Scene& scene : scenes) check_case(file, config, scene, by, what);
  }
  file.finish();
}

// On pictures of the usual size.
void check_shipped(const std::string& file_name, const std::vector<Scene>& scenes) {
  check_all(file_name, shipped_configs(), scenes, What::all, ClockedBy::span);
}

// Variants of depth16.
void check_variants(const std::string& file_name, const std::vector<Config>& variants,
                    What what = What::all) {
  check_all(file_name, variants, {demo_scene(96, 72), small_extreme_scene(), spot_scene(96, 72)}, what);
}

// Random changes of draw state, in early tests, on one target of the first format, by one texture unit.
RandomOptions random_states(double command_probability) {
  RandomOptions options;
  options.width = 96;
  options.height = 72;
  options.command_probability = command_probability;
  options.late_tests = false;
  options.second_texture = false;
  options.targets = false;
  options.later_registers = false;
  options.several_targets = false;
  return options;
}

void check_random(const std::string& file_name, int first, int last) {
  DigestLines file(file_name);
  const std::vector<std::string> lines = random_config_lines();
  for (int number = first; number <= last; ++number) {
    const Config config = config_of(lines.at(static_cast<std::size_t>(number)));
    check_config_section(file, config);
    const Scene scene = random_stream(config, number);
    file.check("stream of " + config.name, scene_quantities(scene));
    check_case(file, config, scene, ClockedBy::both);
  }
  file.finish();
}

TEST(Frozen, ShippedOnDemo) { check_shipped("shipped_demo", {demo_scene(640, 480)}); }
TEST(Frozen, ShippedOnExtreme) { check_shipped("shipped_extreme", extreme_scenes()); }
TEST(Frozen, ShippedOnSpot) { check_shipped("shipped_spot", {spot_scene(640, 480)}); }

TEST(Frozen, Coverage) { check_variants("coverage", coverage_variants()); }
TEST(Frozen, Offset) { check_variants("offset", offset_variants()); }
TEST(Frozen, Slope) { check_variants("slope", slope_variants()); }
TEST(Frozen, EdgeReciprocal) { check_variants("edge_reciprocal", edge_reciprocal_variants()); }
TEST(Frozen, RowReciprocal) { check_variants("row_reciprocal", row_reciprocal_variants()); }
TEST(Frozen, PixelReciprocal) { check_variants("pixel_reciprocal", pixel_reciprocal_variants()); }
TEST(Frozen, Depth) { check_variants("depth", depth_variants()); }
TEST(Frozen, DepthRounding) { check_variants("depth_rounding", depth_rounding_variants()); }
// The code float_dz, with early and with late tests.
TEST(Frozen, DepthDz) {
  RandomOptions options = random_states(0.4);
  options.late_tests = true;
  options.mip_chains = true;
  check_all("depth_dz", depth_dz_variants(),
            {spot_scene(96, 72), floor_scene(96, 72), random_scene(72, options)});
}
TEST(Frozen, Shading) { check_variants("shading", shading_variants()); }
// Rows from the triangle's plane.
TEST(Frozen, Plane) { check_variants("plane", plane_variants()); }
// On textures with chains.
TEST(Frozen, Mip) { check_all("mip", mip_variants(), {floor_scene(96, 72), spot_scene(96, 72)}); }
// True distances, and fog by them.
TEST(Frozen, Distance) {
  Scene foggy = floor_scene(96, 72);
  foggy.fog = Fog{{200, 210, 220}, foggy.s_max / 8};
  check_all("distance", distance_variants(), {foggy, spot_scene(96, 72)});
}
// Values beside the fixed lines, given and computed at the vertices.
TEST(Frozen, Channel) {
  Scene given = random_scene(74);
  given.fog = Fog{{200, 210, 220}, given.s_max / 3};
  Random random(74);
  draw_given_attributes(random, given, 0.5);
  check_all("channel", channel_variants(), {given});
}
// Two passes, with a view and a copy.
TEST(Frozen, Passes) { check_all("passes", shipped_configs(), {mirror_scene(96, 72)}); }

TEST(Frozen, Project) {
  std::vector<Config> configs = shipped_configs();
  for (Config& c : configs) c.project = ProjectUnit::reciprocal;
  const ShadowOptions lamp{
      .light = {-12, 16, -2}, .at = Vec3{0, 2, -26}, .degrees = 60, .size = 128, .bias = 2};
  check_all("project", configs, {demo_scene(96, 72, lamp)});
}
// Under a light: a brightness per face, per vertex and per pixel, of lights far away and at a point.
TEST(Frozen, Light) {
  std::vector<Config> configs;
  for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
    for (const LightSource source : {LightSource::parallel, LightSource::point}) {
      Config c = shipped_config("depth16");
      c.light = at;
      c.light_source = source;
      c.name += " light " + std::string(to_string(at)) + " " + std::string(to_string(source));
      configs.push_back(c);
    }
  }
  Scene scene = random_scene(75);
  Random random(75);
  draw_light(random, scene, {});
  check_all("light", configs, {scene});
}
// Candidates that pixels hold, and resolves.
TEST(Frozen, Translucency) {
  Scene scene = random_scene(76);
  Random random(76);
  draw_translucency(random, scene);
  check_all("translucency", shipped_configs(), {scene});
}
// Lines among triangles, by both walks.
TEST(Frozen, Lines) {
  std::vector<Config> configs;
  for (const LineForm walk : {LineForm::exact, LineForm::dda}) {
    Config c = shipped_config("depth16");
    c.line_walk = walk;
    c.name += " line " + std::string(to_string(walk));
    configs.push_back(std::move(c));
  }
  Scene scene = random_scene(77);
  Random random(77);
  draw_lines(random, scene, 0.5);
  check_all("lines", configs, {scene});
}
// Changes of draw state.
TEST(Frozen, State) { check_all("state", shipped_configs(), {random_scene(71, random_states(0.4))}); }
// Late depth and stencil tests.
TEST(Frozen, Late) {
  RandomOptions options = random_states(0.4);
  options.late_tests = true;
  check_all("late", shipped_configs(), {random_scene(72, options), random_scene(73, options)});
}
// Targets with dither, and chroma ranges.
TEST(Frozen, Target) {
  RandomOptions options = random_states(0.5);
  options.targets = true;
  check_all("target", shipped_configs(), {random_scene(73, options)});
}
// The second texture unit, on textures without and with chains.
TEST(Frozen, SecondTexture) {
  RandomOptions options = random_states(0.5);
  options.targets = true;
  options.mip_chains = true;
  Scene scene = random_scene(75, options);
  // Every function on every texture.
  std::int64_t n = 0;
  for (DrawCommand& command : scene.commands) {
    if (std::holds_alternative<Clear>(command.what)) continue;
    const auto textures = static_cast<std::int64_t>(scene.textures.size());
    const std::array<std::pair<const char*, std::int64_t>, 4> values{{{"texture1", n % (textures + 1) - 1},
                                                                      {"texture1.op", n % 6},
                                                                      {"texture1.scale", n % 3},
                                                                      {"texture1.red", 200}}};
    if (auto* change = std::get_if<StateChange>(&command.what)) {
      for (const auto& [key, value] : values) change->settings.push_back({*find_state_register(key), value});
    }
    ++n;
  }
  std::vector<Config> configs = shipped_configs();
  for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
    Config& config = configs.emplace_back(shipped_config("depth16"));
    config.name = "depth16-" + std::string(to_string(mip));
    config.mip = mip;
    config.lod = LodMode::gradient;
    config.filter = TextureFilter::bilinear;
  }
  check_all("second_texture", configs, {scene});
}
// Computed and dynamic textures.
TEST(Frozen, Textures) {
  std::vector<Scene> scenes;
  for (int frame = 0; frame < 3; ++frame) {
    scenes.push_back(read_tri(source_path("tests/data/sea.tri"), frame));
    scenes.back().name = "sea " + std::to_string(frame);
  }
  check_all("textures", shipped_configs(), scenes);
}
// The counters of caches, written out.
TEST(Frozen, Caches) {
  check_all("caches", cache_variants(), {demo_scene(96, 72), spot_scene(96, 72)}, What::clocks);
}
TEST(Frozen, Formats) { check_variants("formats", format_variants()); }
TEST(Frozen, Timing) { check_variants("timing", timing_variants(), What::clocks); }

// Each line holds what differs from the defaults and no more, and stands for a legal configuration.
TEST(Frozen, RandomConfigurations) {
  if (drawing_configs()) draw_random_configs();
  const std::vector<std::string> lines = random_config_lines();
  EXPECT_EQ(lines.size(), 200U);
  for (const std::string& line : lines) EXPECT_EQ(line_of(config_of(line)), line);
}

TEST(Frozen, Random000To099) { check_random("random_000", 0, 99); }
TEST(Frozen, Random100To199) { check_random("random_100", 100, 199); }

// A file frozen by a program that draws nothing would be equal to itself.
TEST(Frozen, FilesHaveEveryRecordAndCounter) {
  std::string seen = ", ";
  for (const auto& entry : std::filesystem::directory_iterator(digest_folder())) {
    if (entry.path().extension() == ".jsonl")
      seen += read_lines(entry.path()).at(seen_title).at("quantities") + ", ";
  }
  const auto expect_seen = [&](const std::string& name) {
    EXPECT_NE(seen.find(", " + name + ", "), std::string::npos) << name;
  };
#define BITSPAN_SEEN(Record, LIST, stage, member) expect_seen(std::string("record ") + stage);
  BITSPAN_RECORDS(BITSPAN_SEEN)
#undef BITSPAN_SEEN
  for (const auto& [name, value] : counter_quantities({})) expect_seen(name);
}

}  // namespace
}  // namespace bitspan::frozen
