// SPDX-License-Identifier: Apache-2.0
// Shadow maps judged by rays from the light, from the stream alone: shadows that hold, and planted faults
// that do not. [SH2, V2]
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "golden/shadow_rays.hpp"
#include "report/shadow_plan.hpp"
#include "scene/demo.hpp"
#include "scene/plan.hpp"
#include "scene/shadow.hpp"
#include "scene/tri_stream.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using golden::Caster;
using golden::Lit;
using golden::Receiver;
using golden::ShadowRays;

// A triangle of the light's picture at one q.
Caster caster(std::array<double, 3> x, std::array<double, 3> y, double q) { return {x, y, {q, q, q}}; }
std::vector<Caster> quad(double low, double high, double q) {
  return {caster({low, high, high}, {low, low, high}, q), caster({low, high, low}, {low, high, high}, q)};
}
// A plane that faces the light at this q.
Receiver facing(double x, double y, double q) { return {x, y, 0, 0, q}; }

TEST(ShadowRaysAt, TellLitDarkAndOpen) {
  const std::vector<Caster> cover = quad(10, 30, 0.5);
  const ShadowRays rays(cover);
  EXPECT_EQ(rays.at(facing(20, 20, 0.4), 1.5, 0.01), Lit::dark);    // over the inner side of both
  EXPECT_EQ(rays.at(facing(20, 20, 0.6), 1.5, 0.01), Lit::lit);     // in front
  EXPECT_EQ(rays.at(facing(20, 20, 0.5), 1.5, 0.01), Lit::lit);     // on it
  EXPECT_EQ(rays.at(facing(20, 20, 0.495), 1.5, 0.01), Lit::open);  // nearer than the margin tells
  EXPECT_EQ(rays.at(facing(11.4, 20, 0.4), 1.5, 0.01), Lit::open);  // its edge is in reach
  EXPECT_EQ(rays.at(facing(8.6, 20, 0.4), 1.5, 0.01), Lit::open);
  EXPECT_EQ(rays.at(facing(11.6, 20, 0.4), 1.5, 0.01), Lit::dark);
  EXPECT_EQ(rays.at(facing(8.4, 20, 0.4), 1.5, 0.01), Lit::lit);
  // A plane that cuts the cover within reach, and one that passes behind it there.
  EXPECT_EQ(rays.at({20, 20, 0.1, 0, -1.6}, 1.5, 0.01), Lit::open);
  EXPECT_EQ(rays.at({20, 20, 0.1, 0, -1.8}, 1.5, 0.01), Lit::dark);
}

// What rises above a surface in reach is open, also where a bias has the surface nearer than that.
TEST(ShadowRaysAt, SeeTheSurfaceBehindItsBias) {
  std::vector<Caster> casters = quad(10, 30, 0.5);
  casters.push_back({{19, 21, 20}, {21, 21, 23}, {0.5, 0.5, 0.52}});  // stands on the first ones
  const Receiver biased = facing(20, 20, 0.55);
  EXPECT_EQ(ShadowRays(casters).at(biased, 1.5, 0.01), Lit::open);
  EXPECT_EQ(ShadowRays(casters).at(biased, 0.5, 0.01), Lit::lit);
  Receiver shifted = facing(20, 20, 0.5);
  shifted.shift = 0.05;
  EXPECT_EQ(ShadowRays(casters).at(shifted, 1.5, 0.01), Lit::open);
  EXPECT_EQ(ShadowRays(casters).at(shifted, 0.5, 0.01), Lit::lit);
  // The other way it is dark by itself.
  shifted.shift = -0.05;
  EXPECT_EQ(ShadowRays(casters).at(shifted, 0.5, 0.01), Lit::dark);
  EXPECT_EQ(ShadowRays(casters).at(facing(20, 20, 0.45), 0.5, 0.01), Lit::dark);
}

TEST(ShadowRaysAt, FindASlit) {
  // Two halves that are a hundredth of a texel apart, where no sample of a grid would find it.
  std::vector<Caster> halves = quad(0, 10, 0.5);
  for (Caster c : quad(10, 20, 0.5)) {
    for (double& x : c.x) x += 0.01;
    for (double& y : c.y) y -= 10;
    halves.push_back(c);
  }
  EXPECT_EQ(ShadowRays(halves).at(facing(9.3, 5, 0.4), 1.5, 0.01), Lit::open);
  EXPECT_EQ(ShadowRays(halves).at(facing(8.4, 5, 0.4), 1.5, 0.01), Lit::dark);
  const Receiver tilted{8.4, 5, 0.01, 0, 0.516};  // in front of the halves
  EXPECT_EQ(ShadowRays(halves).at(tilted, 1.5, 0.01), Lit::lit);
  // One that may be stored nearer than it is.
  halves.front().excess = 0.2;
  EXPECT_EQ(ShadowRays(halves).at(tilted, 1.5, 0.01), Lit::open);
  halves.front().excess = 0;
  halves.front().vanishes = true;
  EXPECT_EQ(ShadowRays(halves).at(facing(8.4, 5, 0.4), 1.5, 0.01), Lit::unknown);
  EXPECT_EQ(ShadowRays(halves).at(tilted, 1.5, 0.01), Lit::lit);
}

Config with_projector(Config config) {
  config.project = ProjectUnit::reciprocal;
  return config;
}

VisibilityReport judged(const Config& config, const Scene& scene,
                        const std::function<void(Scene&)>& fault = {}) {
  const auto plan = shadow_plan_of(config, scene);
  if (!plan) throw std::invalid_argument("no plan");
  const Oracle& ray = test::oracle_named("ray");
  const Visibility visibility(config, plan->picture, stored_depth_bounds(config, plan->picture));
  const std::vector<Visible> picture = visibility.picture(ray);
  const Frame frame = frame_of_picture(*plan, test::drawn_by("model", config, scene));
  const VisibilityReport seen = visibility.compare(ray, picture, frame, "model");
  EXPECT_EQ(seen.unexplained, 0U) << seen.first;
  Scene mask = plan->mask;
  if (fault) fault(mask);
  return shadow_report(seen, shadow_findings(config, *plan, stored_depth_bounds(config, map_scene(*plan)),
                                             picture, seen, test::drawn_by("model", config, mask)));
}

Scene lit_box(const Config& config, std::optional<double> bias = {}) {
  const std::vector<Face> faces = box_above_floor();
  return shadowed(seen_scene(faces), faces,
                  {.light = {-7, -9, 8},
                   .size = 256,
                   .bias = bias,
                   .depth_bits = config.depth_bits,
                   .depth_code = config.depth_code});
}

TEST(RayShadows, HoldInEveryConfiguration) {
  for (const Config& base : shipped_configs()) {
    for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
      Config config = with_projector(base);
      config.depth_code = code;
      const VisibilityReport report = judged(config, lit_box(config));
      EXPECT_EQ(report.unexplained, 0U) << base.name << ": " << report.first;
      EXPECT_GT(report.equal, 5000U) << base.name;
      EXPECT_GT(report.edges, 50U) << base.name;
      EXPECT_EQ(report.ties, 0U);
    }
  }
}

TEST(RayShadows, HoldInAStreamOfTheDemo) {
  const Config config = with_projector(shipped_config("depth16"));
  const Scene scene =
      demo_scene(160, 120, ShadowOptions{.light = {-12, 16, -2}, .at = Vec3{0, 2, -26}, .degrees = 60});
  const TemporaryFolder folder;
  write_tri_file(folder.path("demo.tri"), scene);
  const VisibilityReport report = judged(config, read_tri(folder.path("demo.tri")));
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 8000U);
  EXPECT_GT(report.left_out, 0U);  // behind the grille
  std::printf("%s\n", visibility_text(report).c_str());
}

// The floor goes on beyond the map, whose filter must not take texels of its other side.
TEST(RayShadows, HoldAtTheBorderOfTheMap) {
  const Config config = with_projector(shipped_config("depth20"));
  ASSERT_EQ(config.filter, TextureFilter::bilinear);
  const Scene scene = demo_scene(
      160, 120,
      ShadowOptions{
          .light = {-12, 16, -2}, .at = Vec3{0, 2, -26}, .degrees = 60, .size = 512, .depth_bits = 20});
  const VisibilityReport report = judged(config, scene);
  EXPECT_EQ(report.unexplained, 0U) << report.first;
}

// What an engine would draw that has these faults.
TEST(RayShadows, PlantedFaultsTurnThemRed) {
  const Config config = with_projector(shipped_config("depth16"));
  EXPECT_GT(judged(config, lit_box(config, 0)).unexplained, 300U);  // surfaces that shade themselves
  const Scene scene = lit_box(config);
  const auto each_vertex = [](const std::function<void(Vertex&)>& change) {
    return [change](Scene& mask) {
      for (Triangle& t : mask.triangles) {
        for (Vertex& v : t.v) change(v);
      }
    };
  };
  const auto set = [](std::string_view key, std::int64_t value) {
    return [key, value](Scene& mask) {
      for (DrawCommand& c : mask.commands) {
        if (auto* change = std::get_if<StateChange>(&c.what))
          change->settings.push_back(state_setting(key, value));
      }
    };
  };
  const std::pair<const char*, std::function<void(Scene&)>> faults[] = {
      {"the map three texels to the left", each_vertex([](Vertex& v) { v.project_x += 3 * v.project_w; })},
      {"and down", each_vertex([](Vertex& v) { v.project_y -= 3 * v.project_w; })},
      {"rows and columns exchanged", each_vertex([](Vertex& v) { std::swap(v.project_x, v.project_y); })},
      {"a W that is larger", each_vertex([](Vertex& v) { v.project_w *= 1.02; })},
      {"the comparison turned round", set("texture1.func", static_cast<int>(DepthFunc::gequal))},
      {"none of it", set("texture1.func", static_cast<int>(DepthFunc::always))},
      {"a bias of -40 codes", set("texture1.bias", -40)},
  };
  for (const auto& [name, fault] : faults) EXPECT_GT(judged(config, scene, fault).unexplained, 20U) << name;
}

TEST(RayShadows, OtherPlansAreNone) {
  const Config config = with_projector(shipped_config("depth16"));
  const Scene good = lit_box(config);
  EXPECT_TRUE(shadow_plan_of(config, good));
  EXPECT_FALSE(shadow_plan_of(shipped_config("depth16"), good));
  Scene plain = good;
  plain.commands.clear();
  EXPECT_FALSE(shadow_plan_of(config, plain));
  const auto with = [&](const DrawCommand& command) {
    Scene scene = good;
    const auto at =
        std::ranges::find_if(scene.commands, [&](const DrawCommand& c) { return c.before > command.before; });
    scene.commands.insert(at, command);
    return shadow_plan_of(config, scene).has_value();
  };
  const std::size_t last = good.triangles.size();
  EXPECT_TRUE(with({last, StateChange{.settings = {state_setting("texture1.red", 9)}}}));
  EXPECT_FALSE(with({last - 1, StateChange{.settings = {state_setting("texture1.func", DepthFunc::less)}}}));
  EXPECT_FALSE(with({last - 1, Clear{}}));
  EXPECT_FALSE(with({last, Target{1}}));
  EXPECT_FALSE(with({last - 1, StateChange{.settings = {state_setting("color.write", 0)}}}));
  EXPECT_FALSE(with(
      {last - 1, StateChange{.settings = {state_setting("texture1", -1), state_setting("color.write", 0)}}}));
  EXPECT_FALSE(with({last - 1, ViewChange{.focal = 9.0}}));
  EXPECT_FALSE(with({1, StateChange{.settings = {state_setting("depth.bias", 3)}}}));
}

}  // namespace
}  // namespace bitspan
