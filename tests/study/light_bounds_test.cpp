// SPDX-License-Identifier: Apache-2.0
// The proved bounds of light against what the model does: every lit fragment of random scenes, with the
// shipped registers and with random ones. docs/bounds.md, "Light".
#include "study/bounds/light_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "config/modes.hpp"
#include "engine/drawn_scene.hpp"
#include "golden/mip_chain.hpp"
#include "model/engine_model.hpp"
#include "model/numeric/root.hpp"
#include "report/error.hpp"
#include "report/random_config.hpp"
#include "scene/mesh.hpp"
#include "scene/random.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/root_error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr std::array quantities{"normal", "direction", "cosine", "mirrored", "specular", "value", "colour"};

// What was observed of all lit fragments.
struct Tally {
  std::uint64_t fragments = 0, dark = 0;
  std::uint64_t above = 0;                        // errors above their bound
  std::uint64_t other_side = 0;                   // of the terminator than the truth's
  std::uint64_t unexplained = 0;                  // of these, the ones whose cosine is larger than its bound
  std::uint64_t finite = 0;                       // fragments whose brightness has a bound below 1/16
  std::array<double, quantities.size()> ratio{};  // the largest observed / bound
  std::string first;                              // that is above its bound

  void note(std::size_t quantity, double measured, double ideal, double bound, const std::string& where) {
    const double error = std::fabs(measured - ideal);
    if (error == 0) return;
    if (std::isfinite(bound)) ratio[quantity] = std::max(ratio[quantity], error / bound);
    if (error <= bound) return;
    ++above;
    if (first.empty()) {
      first = where + ": " + quantities[quantity] + " " + std::to_string(measured) + ", ideal " +
              std::to_string(ideal) + ", error " + std::to_string(error) + ", bound " + std::to_string(bound);
    }
  }
  double tightest() const { return *std::ranges::max_element(ratio); }
};

// bounds: of the same scene, and of any configuration.
void observe(const Config& config, const Scene& scene, const LightBounds& bounds, Tally& out) {
  const auto model = make_model(config);
  model->begin(scene);
  Trace trace;
  draw_scene(*model, scene, 0, scene.triangles.size(), &trace);
  const golden::SceneLevels levels = golden::scene_levels(config, scene);
  const auto value = [&](std::int64_t raw, FormatId id) { return decoded(raw, config.format(id)); };
  std::size_t texture = 0;
  for (const LightRecord& r : trace.light) {
    while (trace.texture[texture].triangle != r.triangle || trace.texture[texture].x != r.x ||
           trace.texture[texture].y != r.y) {
      ++texture;
    }
    const TextureRecord& t = trace.texture[texture];
    const std::array rgb{value(t.r, FormatId::texture_color), value(t.g, FormatId::texture_color),
                         value(t.b, FormatId::texture_color)};
    const auto index = static_cast<std::size_t>(r.triangle);
    const auto shape = ideal_triangle(config, scene.triangles[index]);
    const IdealFragment f = ideal_at(config, scene, *shape, r.x, r.y, &levels);
    const LightBound bound = bounds.at(index, f.point, rgb);
    const std::string where = config.name + ", " + scene.name + ", triangle " + std::to_string(r.triangle) +
                              ", pixel " + std::to_string(r.x) + " " + std::to_string(r.y);
    const auto note = [&](std::size_t quantity, std::int64_t raw, FormatId id, double ideal, double most) {
      out.note(quantity, value(raw, id), ideal, most, where);
    };
    if (lights_pixels(config.light)) {
      const IdealLight& l = f.light;
      const std::array n{r.nx, r.ny, r.nz}, d{r.lx, r.ly, r.lz};
      for (std::size_t i = 0; i < 3; ++i) {
        note(0, n[i], FormatId::light_normal, l.normal[i], bound.normal);
        note(1, d[i], FormatId::light_direction, l.direction[i], bound.direction);
      }
      note(2, r.cosine, FormatId::light_cosine, l.cosine, bound.cosine);
      note(3, r.mirrored, FormatId::light_cosine, l.mirrored, bound.mirrored);
      note(4, r.specular, FormatId::light_specular, l.specular, bound.specular);
      if ((r.cosine > 0) != (l.cosine > 0)) {
        ++out.other_side;
        out.unexplained += static_cast<std::uint64_t>(std::fabs(l.cosine) > bound.cosine);
      }
      out.dark += static_cast<std::uint64_t>(l.cosine <= 0);
    }
    note(5, r.value, FormatId::light_value, f.light.value, bound.value);
    const std::array lit{r.r, r.g, r.b};
    for (std::size_t c = 0; c < 3; ++c) {
      note(6, lit[c], FormatId::texture_color, rgb[c] * f.light.value, bound.color[c]);
    }
    ++out.fragments;
    out.finite += static_cast<std::uint64_t>(bound.value < 1.0 / 16);
  }
}

Config lit_config(const std::string& name, LightAt at) {
  Config config = shipped_config(name);
  config.light = at;
  config.light_source = LightSource::point;
  config.light_law = LightLaw::lunar;
  config.light_fall = LightFall::second;
  return config;
}

Scene lit_scene(std::uint64_t seed, const Config& config, int triangles = 10) {
  RandomOptions options;
  options.triangles = triangles;
  options.width = 80;
  options.height = 60;
  options.size_max = 60;
  options.depth_ratio_max = 100;
  Scene scene = random_scene(seed, options);
  Random random(seed);
  draw_light(random, scene, light_taken(config));
  return scene;
}

void expect_held(const Tally& tally, const char* what) {
  EXPECT_EQ(tally.above, 0U) << tally.first;
  EXPECT_EQ(tally.unexplained, 0U);
  std::string ratios;
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    ratios += std::string(" ") + quantities[i] + " " + std::to_string(tally.ratio[i]).substr(0, 5);
  }
  std::printf(
      "%s: %llu fragments, %llu dark, %llu on the other side of the terminator; observed / bound:%s\n", what,
      static_cast<unsigned long long>(tally.fragments), static_cast<unsigned long long>(tally.dark),
      static_cast<unsigned long long>(tally.other_side), ratios.c_str());
}

// ---------------------------------------------------------------- the shipped registers

class LightBoundsAt : public testing::TestWithParam<LightAt> {};

TEST_P(LightBoundsAt, HoldOnRandomScenes) {
  const std::uint64_t seeds = is_long_run() ? 200 : 12;
  Tally all;
  for (const std::string& name : shipped_names) {
    const Config config = lit_config(name, GetParam());
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const Scene scene = lit_scene(seed, config);
      observe(config, scene, LightBounds(config, scene), all);
    }
  }
  expect_held(all, (std::string(to_string(GetParam())) + ", seeds 1.." + std::to_string(seeds)).c_str());
  EXPECT_GT(all.fragments, 5000U);
  EXPECT_GT(all.finite, all.fragments / 4) << "bounds that say nothing";
  EXPECT_GT(all.tightest(), 0.5) << "loose bounds";
}

INSTANTIATE_TEST_SUITE_P(Places, LightBoundsAt,
                         testing::Values(LightAt::face, LightAt::vertex, LightAt::pixel),
                         [](const auto& info) { return std::string(to_string(info.param)); });

// ---------------------------------------------------------------- the terminator

// Spot with a light at its side: a register on the other side of the terminator than the truth has a cosine
// within its bound, however coarse the registers are.
TEST(LightBounds, ExplainTheTerminatorOfSpot) {
  MeshOptions options;
  options.width = is_long_run() ? 640 : 160;
  options.height = options.width * 3 / 4;
  options.light = LightOptions{.light = {.is_point = true, .place = {5, 1, 0.5}}, .by_unit = true};
  ProjectReport report;
  const Scene scene = mesh_scene(read_mesh(source_path("tests/data/spot.obj")), options, report);
  for (const int fraction : {18, 14, 10, 8, 6}) {
    if (!is_long_run() && fraction != 18 && fraction != 6) continue;
    Config config = shipped_config("depth16");
    config.light = LightAt::pixel;
    config.light_source = LightSource::point;
    for (const FormatId id : {FormatId::light_normal, FormatId::light_direction, FormatId::light_cosine}) {
      config.format(id).word = config.format(id).integer + fraction;
    }
    Tally tally;
    observe(config, scene, LightBounds(config, scene), tally);
    expect_held(tally, ("Spot, " + std::to_string(fraction) + " fraction bits").c_str());
    EXPECT_GT(tally.dark, tally.fragments / 8);
    if (fraction <= 8) {
      EXPECT_GT(tally.other_side, 0U);
    }
  }
}

// ---------------------------------------------------------------- random registers

// Widths, roundings, overflow modes, tables and steps at random: registers wrap and saturate.
TEST(LightBounds, HoldForRandomLegalConfigurations) {
  std::vector<Config> bases;
  for (const LightAt at : {LightAt::pixel, LightAt::vertex, LightAt::face}) {
    for (const std::string& name : shipped_names) bases.push_back(lit_config(name, at));
  }
  RandomConfigOptions options;
  options.check = [](const Config& c) {
    if (!has_bounds(c) || !has_light(c.light) || !unbounded_light(c).empty()) throw InputError("no bound");
  };
  const std::uint64_t seeds = is_long_run() ? 4000 : 80;
  Tally all;
  int drawn = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Config config = random_config(seed, bases, options);
    const Scene scene = lit_scene(seed, config, 6);
    try {
      make_model(config)->begin(scene);
    } catch (const InputError&) {
      continue;  // too coarse for the scene's s range
    }
    const std::uint64_t above = all.above;
    observe(config, scene, LightBounds(config, scene), all);
    EXPECT_EQ(all.above, above) << "seed " << seed << ": " << all.first;
    ++drawn;
  }
  expect_held(all, ("random configurations, seeds 0.." + std::to_string(seeds - 1)).c_str());
  EXPECT_GT(drawn, static_cast<int>(seeds / 4));
  EXPECT_GT(all.finite, all.fragments / 10) << "bounds that say nothing";
  EXPECT_GT(all.other_side, 0U);
}

// ---------------------------------------------------------------- planted errors

Scene one_triangle(const std::array<std::array<double, 3>, 3>& normals, const Light& light) {
  Scene scene;
  scene.name = "one";
  scene.width = 32;
  scene.height = 32;
  scene.s_min = 1;
  scene.s_max = 4;
  scene.focal = 32;
  scene.light = light;
  Triangle t;
  t.texture = -1;
  const std::array<std::array<double, 2>, 3> at{{{1, 1}, {30, 2}, {4, 29}}};
  for (std::size_t i = 0; i < 3; ++i) {
    t.v[i].x = at[i][0];
    t.v[i].y = at[i][1];
    t.v[i].s = 2;
    t.v[i].nx = normals[i][0];
    t.v[i].ny = normals[i][1];
    t.v[i].nz = normals[i][2];
  }
  scene.triangles = {t};
  return scene;
}

// The bounds of one configuration do not hold for another, whose register or table has a bit less.
TEST(LightBounds, DoNotHoldWithABitLess) {
  const Config config = lit_config("depth16", LightAt::pixel);
  const auto above = [&](const Config& planted, int exponent) {
    const Scene scene =
        one_triangle({{{0.11, 0.02, -1}, {-0.13, 0.07, -0.9}, {0.03, -0.12, -1.1}}},
                     {.place = {0.05, 0.03, -1}, .ambient = 0.125, .specular = 0.5, .exponent = exponent});
    Tally tally;
    observe(planted, scene, LightBounds(config, scene), tally);
    EXPECT_GT(tally.fragments, 300U);
    return tally.above;
  };
  EXPECT_EQ(above(config, 2), 0U);
  EXPECT_EQ(above(config, 150), 0U);
  const auto loses = [&](FormatId id, int bits) {
    Config planted = config;
    planted.format(id).word -= bits;
    planted.format(id).rounding = Rounding::trn;
    return above(planted, 2);
  };
  EXPECT_GT(loses(FormatId::light_normal, 1), 0U);
  EXPECT_GT(loses(FormatId::light_direction, 1), 0U);
  EXPECT_GT(loses(FormatId::light_cosine, 2), 0U);
  EXPECT_GT(loses(FormatId::light_value, 1), 0U);
  Config planted = config;
  --planted.light_index_bits;
  EXPECT_GT(above(planted, 150), 0U) << "the highlight's table";
  planted = config;
  --planted.light_root.steps;
  EXPECT_GT(above(planted, 2), 0U) << "the root's steps";
}

// ---------------------------------------------------------------- what the bounds are made of

// 1 / sqrt(d) over all operands of a few bits.
TEST(RootError, HoldsForEveryOperand) {
  struct Shape {
    RootUnit unit;
    Format output;
  };
  const Format wide{22, 1, false, Rounding::rnd, Overflow::sat, false};
  const Format coarse{9, 1, false, Rounding::trn, Overflow::sat, false};
  const Format small{12, 0, false, Rounding::rnd, Overflow::sat, false};  // 1 does not fit
  const auto unit = [](int operand, int index, int table, int internal, int steps) {
    RootUnit out;
    out.operand_bits = operand;
    out.index_bits = index;
    out.table_bits = table;
    out.internal_bits = internal;
    out.steps = steps;
    return out;
  };
  for (const Shape& shape : {Shape{unit(12, 4, 8, 16, 1), wide}, Shape{unit(12, 5, 10, 20, 2), wide},
                             Shape{unit(12, 6, 9, 14, 0), wide}, Shape{unit(12, 5, 10, 20, 1), coarse},
                             Shape{unit(12, 5, 10, 20, 1), small}, Shape{unit(8, 3, 6, 10, 1), wide}}) {
    Config config = shipped_config("depth16");
    config.light = LightAt::pixel;
    config.light_root = shape.unit;
    config.format(FormatId::light_root) = shape.output;
    const bounds::UnitError bound = bounds::root_error(config);
    ASSERT_FALSE(bound.any);
    const model::ReciprocalRoot root(config);
    Interval seen(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (std::int64_t raw = std::int64_t{1} << 15; raw < std::int64_t{1} << 17; ++raw) {
      const model::Root r = model::reciprocal_root(root, model::Exact{raw, 15}, model::NoObserve{});
      const double y = std::ldexp(decoded(r.m, shape.output), -r.e);
      const double relative = y * std::sqrt(std::ldexp(static_cast<double>(raw), -15)) - 1;
      seen = {std::min(seen.lo, relative), std::max(seen.hi, relative)};
    }
    EXPECT_GE(seen.lo, bound.relative.lo - 1e-15);
    EXPECT_LE(seen.hi, bound.relative.hi + 1e-15);
    EXPECT_GT(std::max(-seen.lo, seen.hi), 0.7 * bound.relative.mag()) << "loose";
  }
}

// Behind the terminator there is the ambient light alone, and the rounding of that one number.
TEST(LightBounds, InTheDarkTheShareOfAmbientLightIsRounded) {
  Config config = shipped_config("depth16");
  config.light = LightAt::pixel;
  const Format& value = config.format(FormatId::light_value);
  const double ulp = std::ldexp(1.0, -value.fraction());
  const double ambient = 0.25 + ulp / 4;
  const Scene scene =
      one_triangle({{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}}, {.place = {0, 0, -1}, .ambient = ambient});
  const LightBounds bounds(config, scene);
  const auto shape = ideal_triangle(config, scene.triangles[0]);
  const IdealPoint p = ideal_at(config, scene, *shape, 8, 8).point;
  const LightBound bound = bounds.at(0, p, {});
  EXPECT_NEAR(bound.value, ulp / 4, 1e-11);
  // A normal along an axis, and a light along it, turn by nothing: the root's error, and a rounding per part.
  const double half = std::ldexp(0.5, -config.format(FormatId::light_normal).fraction());
  EXPECT_NEAR(bound.normal, half + bounds::root_error(config).relative.mag(), 1e-11);
}

// The study's bounds are the largest of a fragment's.
TEST(LightBounds, OfASceneAreTheLargestOfItsPixels) {
  const Config config = lit_config("depth16", LightAt::pixel);
  const Scene scene = lit_scene(7, config, 4);
  const LightBounds bounds(config, scene);
  double cosine = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const auto shape = ideal_triangle(config, scene.triangles[i]);
    for (std::int64_t y = 0; y < scene.height; ++y) {
      for (std::int64_t x = 0; x < scene.width; ++x) {
        if (!ideal_covers(config, *shape, x, y)) continue;
        cosine = std::max(cosine, bounds.at(i, ideal_at(config, scene, *shape, x, y).point, {}).cosine);
      }
    }
  }
  bool found = false;
  for (const Bound& b : error_bounds(config, scene)) {
    if (b.place != "light.cosine") continue;
    found = true;
    EXPECT_NEAR(b.bound, cosine, 1e-9);
    EXPECT_FALSE(b.terms.empty());
  }
  EXPECT_TRUE(found);
}

// ---------------------------------------------------------------- refusals

TEST(LightBounds, RefuseModesWithoutOne) {
  Config config = lit_config("depth16", LightAt::pixel);
  const Scene scene = lit_scene(1, config);
  Config relief = config;
  relief.light_normal = LightNormal::map;
  relief.second_coordinates = SecondCoordinates::own;
  expect_refusal([&] { LightBounds(relief, scene); }, "light.normal: no bound is known for map");
  Config shadow = config;
  shadow.light_shadow = LightShadow::map;
  expect_refusal([&] { LightBounds(shadow, scene); }, "light.shadow: no bound is known for map");
  Config affine = config;
  affine.perspective = Perspective::affine;
  expect_refusal([&] { LightBounds(affine, scene); }, "perspective.mode");
  Scene unlit = scene;
  unlit.light.reset();
  expect_refusal([&] { LightBounds(config, unlit); }, "has no light");
  // The other places keep their bounds.
  for (const Bound& b : error_bounds(relief, scene)) EXPECT_NE(b.stage, "light");
}

}  // namespace
}  // namespace bitspan
