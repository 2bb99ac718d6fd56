// SPDX-License-Identifier: Apache-2.0
// rtl/light.sv alone against the model's stage: shipped and random configurations, lights at points and far
// away, vectors of any length, gaps and stalls.
#include "model/stages/light.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_light_sv.hpp"
#include "tb/rtl_sources.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/rtl/unit_run.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "light",
          .package = emit_light_sv(c),
          .channels = {{ChannelKind::in, "in", {"x",  "y", "s",  "nx",     "ny",     "nz",  "r",
                                                "g",  "b", "vr", "vg",     "vb",     "px",  "py",
                                                "pz", "u", "v",  "shadow", "relief", "rest"}},
                       {ChannelKind::out,
                        "out",
                        {"nx", "ny", "nz", "lx", "ly", "lz", "cosine", "mirrored", "specular", "value", "r",
                         "g", "b", "rest"}}},
          .constants = {"load",    "load_place", "load_data", "point",     "place_x", "place_y",
                        "place_z", "scale",      "scale_e",   "width",     "height",  "far_x",
                        "far_y",   "far_z",      "diffuse",   "highlight", "ambient", "lunar",
                        "lunar_k", "falls",      "reach",     "reach_e",   "offset"},
          .levels = {},
          .sources = light_sources()};
}

bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }
int between(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}
std::uint64_t port(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }

// What a view sets.
struct LightCase {
  Config config;
  model::LightStage stage;
  int scale_exponent = 0, reach_exponent = 0;

  LightCase(const Config& c, Random& random, bool is_point) : config(c) {
    Scene scene;
    scene.light = Light{.is_point = is_point,
                        .place = {0.25, 0.5, -1},
                        .lunar = has_lunar(c) && chance(random, 0.8) ? 1.0 : 0,
                        .reach = has_light_fall(c) && chance(random, 0.8) ? 1.0 : 0};
    stage = model::prepare_light(c, model::Constants{}, scene);
    const auto drawn = [&](FormatId id) { return random_raw(random, c.format(id)); };
    const int most = std::min(1 << (pixel_index_bits(c) - 1), 20000);
    stage.width = between(random, 1, chance(random, 0.5) ? most : 100);
    stage.height = between(random, 1, chance(random, 0.5) ? most : 100);
    if (stage.takes_place) {
      // Every second one takes pixels to places that the register holds.
      scale_exponent = chance(random, 0.5)
                           ? between(random, 6, 12)
                           : between(random, light_scale_exponent_min, light_scale_exponent_max);
      stage.scale = {drawn(FormatId::light_scale),
                     c.format(FormatId::light_scale).fraction() + scale_exponent};
    }
    if (is_point) {
      for (std::int64_t& part : stage.place) part = drawn(FormatId::light_position);
    } else if (chance(random, 0.5)) {
      for (std::int64_t& part : stage.far_direction) part = drawn(FormatId::light_direction);
    }
    for (std::int64_t* share : {&stage.diffuse, &stage.highlight, &stage.ambient}) {
      *share = drawn(FormatId::light_value);
    }
    if (stage.is_lunar && chance(random, 0.7)) stage.lunar_k = drawn(FormatId::light_lunar);
    if (stage.falls) {
      // Places in this view are mostly as far away as their register holds.
      reach_exponent = chance(random, 0.7)
                           ? between(random, 2, 8)
                           : between(random, light_reach_exponent_min, light_reach_exponent_max);
      stage.per_reach = {drawn(FormatId::light_scale),
                         c.format(FormatId::light_scale).fraction() + reach_exponent};
      if (chance(random, 0.5)) stage.offset = drawn(FormatId::light_distance);
    }
    if (chance(random, 0.5)) {
      for (std::int64_t& entry : stage.table) entry = drawn(FormatId::light_specular);
    }
  }
  void set(StageBench& bench) const {
    const auto set = [&](const char* name, std::int64_t raw, FormatId id) {
      bench.set_constant(name, port(raw, config.format(id)));
    };
    for (std::size_t i = 0; i < stage.table.size(); ++i) {
      bench.set_constant("load", 1);
      bench.set_constant("load_place", i);
      set("load_data", stage.table[i], FormatId::light_specular);
      bench.clock();
    }
    bench.set_constant("load", 0);
    bench.set_constant("point", stage.is_point ? 1 : 0);
    bench.set_constant("width", static_cast<std::uint64_t>(stage.width));
    bench.set_constant("height", static_cast<std::uint64_t>(stage.height));
    bench.set_constant("scale_e", Rtl::to_port(scale_exponent, 6));
    set("scale", static_cast<std::int64_t>(stage.scale.raw), FormatId::light_scale);
    constexpr std::array places{"place_x", "place_y", "place_z"}, far{"far_x", "far_y", "far_z"};
    for (std::size_t i = 0; i < 3; ++i) {
      set(places[i], stage.place[i], FormatId::light_position);
      set(far[i], stage.far_direction[i], FormatId::light_direction);
    }
    set("diffuse", stage.diffuse, FormatId::light_value);
    set("highlight", stage.highlight, FormatId::light_value);
    set("ambient", stage.ambient, FormatId::light_value);
    bench.set_constant("lunar", stage.is_lunar ? 1 : 0);
    set("lunar_k", stage.lunar_k, FormatId::light_lunar);
    bench.set_constant("falls", stage.falls ? 1 : 0);
    set("reach", static_cast<std::int64_t>(stage.per_reach.raw), FormatId::light_scale);
    bench.set_constant("reach_e", Rtl::to_port(reach_exponent, 6));
    set("offset", stage.offset, FormatId::light_distance);
  }
};

struct LightRun : UnitRun {
  std::size_t lit = 0, shining = 0, without_normal = 0;
  std::size_t in_relief = 0, in_shadow = 0;  // and lit
};

Exchange random_fragment(Random& random, LightCase& t, std::uint64_t number, LightRun& run) {
  const Config& c = t.config;
  const Format& normal = c.format(FormatId::normal_value);
  const Format& color = c.format(FormatId::texture_color);
  const Format& mix = c.format(FormatId::texture_mix);
  const Format& relief = c.format(FormatId::relief_value);
  const Format& uv = c.format(FormatId::span_uv);
  const Format& s = c.format(FormatId::distance_s);
  // The draw state may change from a fragment to the next one.
  t.stage.has_map = t.stage.takes_map && chance(random, 0.5);
  t.stage.has_shadow = t.stage.takes_shadow && !t.stage.has_map && chance(random, 0.7);
  FragmentRecord f;
  f.x = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(t.stage.width));
  f.y = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(t.stage.height));
  DistanceRecord distance;
  distance.s = random_raw(random, s);
  model::LightChannels given;
  // Of any length, down to one ulp and to none; toward the viewer more often than not.
  const int down = chance(random, 0.5) ? 0 : between(random, 0, normal.word);
  for (std::int64_t& part : given.normal) part = random_raw(random, normal) >> down;
  if (chance(random, 0.05)) given.normal = {};
  if (normal.is_signed && chance(random, 0.7)) given.normal[2] = -std::abs(given.normal[2] + 1);
  TextureRecord texel;
  for (std::int64_t* v : {&texel.r, &texel.g, &texel.b}) *v = random_raw(random, color);
  // Codes as well as what lies between them; the middle of the codes is no direction.
  const auto drawn_texel = [&] {
    return chance(random, 0.5) && mix.fraction() >= 0 && mix.integer > 8
               ? std::int64_t{between(random, 0, 255)} << mix.fraction()
               : random_raw(random, mix);
  };
  for (std::int64_t* v : {&texel.texel_r, &texel.texel_g, &texel.texel_b}) *v = drawn_texel();
  const int near = chance(random, 0.5) ? 0 : between(random, 0, relief.word);
  for (std::int64_t& part : given.place) part = random_raw(random, relief) >> near;
  for (std::int64_t& part : given.at) part = random_raw(random, uv) >> near;
  LightRecord r;
  model::light(t.stage, f, distance, given, texel, r);
  run.lit += r.cosine > 0 ? 1U : 0U;
  run.shining += r.cosine > 0 && r.mirrored > 0 ? 1U : 0U;
  run.without_normal += r.nx == 0 && r.ny == 0 && r.nz == 0 ? 1U : 0U;
  run.in_relief += t.stage.has_map && r.cosine > 0 ? 1U : 0U;
  run.in_shadow += t.stage.has_shadow && r.cosine > 0 ? 1U : 0U;
  Exchange g;
  g.in = {static_cast<std::uint64_t>(f.x),
          static_cast<std::uint64_t>(f.y),
          port(distance.s, s),
          port(given.normal[0], normal),
          port(given.normal[1], normal),
          port(given.normal[2], normal),
          port(texel.r, color),
          port(texel.g, color),
          port(texel.b, color),
          port(texel.texel_r, mix),
          port(texel.texel_g, mix),
          port(texel.texel_b, mix),
          port(given.place[0], relief),
          port(given.place[1], relief),
          port(given.place[2], relief),
          port(given.at[0], uv),
          port(given.at[1], uv),
          t.stage.has_shadow ? 1U : 0U,
          t.stage.has_map ? 1U : 0U,
          number};
  const auto out = [&](std::int64_t raw, FormatId id) { return port(raw, c.format(id)); };
  g.out = {out(r.nx, FormatId::light_normal),
           out(r.ny, FormatId::light_normal),
           out(r.nz, FormatId::light_normal),
           out(r.lx, FormatId::light_direction),
           out(r.ly, FormatId::light_direction),
           out(r.lz, FormatId::light_direction),
           out(r.cosine, FormatId::light_cosine),
           out(r.mirrored, FormatId::light_cosine),
           out(r.specular, FormatId::light_specular),
           out(r.value, FormatId::light_value),
           port(r.r, color),
           port(r.g, color),
           port(r.b, color),
           number};
  return g;
}

// Sends `count` fragments; throws where one comes out otherwise, is lost, doubled, or comes after the last.
LightRun run_light(LightCase& t, Random& random, std::size_t count, const StageStalls& stalls,
                   StageTrace* trace = nullptr, int reset_after = 0) {
  const StageDesign unit = design_of(t.config);
  StageBench bench(unit, random());
  if (trace != nullptr) bench.keep_trace(*trace);
  t.set(bench);
  bench.set_stalls(stalls);
  LightRun r;
  if (reset_after > 0) {
    for (int n = 0; n < reset_after; ++n) bench.send("in", random_fragment(random, t, 0, r).in);
    for (int n = 0; n < reset_after; ++n) bench.clock();
    bench.reset();
  }
  static_cast<UnitRun&>(r) = run_unit(
      bench, unit, count, [&](std::uint64_t n) { return random_fragment(random, t, mark_of(n), r); },
      to_toml(t.config));
  return r;
}

Config with_light(Config c, LightSource source = LightSource::point) {
  c.light = LightAt::pixel;
  c.light_source = source;
  return c;
}

// The same, and all that a light can have.
Config with_all(const Config& config) {
  Config c = with_light(config);
  c.light_law = LightLaw::lunar;
  c.light_fall = LightFall::second;
  c.light_normal = LightNormal::map;
  c.light_shadow = LightShadow::map;
  return c;
}

// Legal, around a random one, with registers of other widths.
Config random_light_config(std::uint64_t seed) {
  Random random(seed);
  for (std::uint64_t n = 0;; ++n) {
    Config c = with_light(random_stage_config(seed + 1000 * n),
                          chance(random, 0.7) ? LightSource::point : LightSource::parallel);
    const auto choose = [&]<class Choice>(Choice& key) {
      if (chance(random, 0.6)) key = static_cast<Choice>(random() % enum_names<Choice>.size());
    };
    choose(c.light_law);
    choose(c.light_fall);
    choose(c.light_fall_to);
    choose(c.light_normal);
    choose(c.light_shadow);
    for (const FormatId id :
         {FormatId::normal_value, FormatId::distance_s, FormatId::light_scale, FormatId::light_position,
          FormatId::light_root, FormatId::light_normal, FormatId::light_direction, FormatId::light_cosine,
          FormatId::light_specular, FormatId::light_value, FormatId::light_inverse, FormatId::light_lunar,
          FormatId::light_distance, FormatId::light_fall, FormatId::relief_value}) {
      Format& f = c.format(id);
      f.word += between(random, -6, 2);
      f.rounding = static_cast<Rounding>(random() % enum_names<Rounding>.size());
      f.overflow = static_cast<Overflow>(random() % enum_names<Overflow>.size());
    }
    c.light_root = {.operand_bits = between(random, 8, 22),
                    .index_bits = between(random, 1, 7),
                    .table_bits = between(random, 5, 14),
                    .internal_bits = between(random, 8, 26),
                    .steps = between(random, 0, 3)};
    c.light_index_bits = between(random, 2, 9);
    if (first_violation(c)) continue;
    try {
      static_cast<void>(design_of(c));
      return c;
    } catch (const InputError&) {  // a cosine without a place behind the point
    }
  }
}

void check(const Config& config, std::uint64_t seed, std::size_t count) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  const StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};
  for (const StageStalls& stalls : conditions) {
    LightCase t(config, random, has_light_points(config) && chance(random, 0.75));
    const LightRun r = run_light(t, random, count, stalls);
    EXPECT_EQ(r.fragments, count);
    EXPECT_GT(r.without_normal, 0U);
  }
}

// In the gate one of them.
std::vector<Config> designs() {
  std::vector<Config> all;
  for (const Config& config : shipped_configs()) {
    all.push_back(with_light(config));
    all.push_back(with_light(config, LightSource::parallel));
    all.push_back(with_all(config));
  }
  const auto some = in_gate(all);
  return {some.begin(), some.end()};
}

// In the long form more than 10^7 fragments.
TEST(LightRtl, Shipped) {
  for (const Config& config : designs()) check(config, 11, is_long_run() ? 420000 : 2000);
}

TEST(LightRtl, ShowsBothSidesOfTheTerminator) {
  Random random(4);
  LightCase t(with_light(shipped_config("depth16")), random, true);
  const LightRun r = run_light(t, random, 3000, {});
  EXPECT_GT(r.lit, 300U);
  EXPECT_GT(r.fragments - r.lit, 300U);
  EXPECT_GT(r.shining, 100U);
}

// Each alone, and a fall of both kinds to both places: they have different clocks. In the gate one of them.
TEST(LightRtl, EachChoice) {
  const Config plain = with_light(shipped_config("narrow"));
  std::vector<Config> choices(4, plain);
  choices[0].light_law = LightLaw::lunar;
  choices[1].light_shadow = LightShadow::map;
  choices[2].light_normal = choices[3].light_normal = LightNormal::map;
  choices[3].light_source = LightSource::parallel;
  for (const LightFall fall : {LightFall::first, LightFall::second}) {
    for (const LightFallTo to : {LightFallTo::light, LightFallTo::viewer}) {
      Config& c = choices.emplace_back(plain);
      c.light_fall = fall;
      c.light_fall_to = to;
    }
  }
  for (const Config& config : in_gate(choices)) {
    SCOPED_TRACE(to_toml(config));
    Random random(6);
    std::size_t in_relief = 0, in_shadow = 0;
    for (int view = 0; view < 4; ++view) {
      LightCase t(config, random, has_light_points(config) && view < 3);
      const LightRun r = run_light(t, random, is_long_run() ? 200000 : 700, {0.2, 0.2});
      in_relief += r.in_relief;
      in_shadow += r.in_shadow;
    }
    EXPECT_EQ(in_relief > 100, has_relief(config));
    EXPECT_EQ(in_shadow > 100, has_light_shadow(config));
  }
}

TEST(LightRtl, Random) {
  for (const std::uint64_t seed : stage_seeds(is_long_run() ? 20 : 2)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_light_config(seed), seed, 1000);
  }
}

TEST(LightRtl, Clocks) {
  for (const Config& config : designs()) {
    Random random(5);
    LightCase t(config, random, has_light_points(config));
    const auto total = static_cast<std::uint64_t>(light_timing(config).total);
    const LightRun r = run_light(t, random, 500, {});
    EXPECT_EQ(r.first_out, r.offered + total) << config.name;
    EXPECT_EQ(r.last_out, r.offered + total + 499) << config.name;
  }
}

TEST(LightRtl, ResetAmidFragments) {
  Random random(7);
  LightCase t(with_light(shipped_config("narrow")), random, true);
  for (const int clocks : {3, 12, 90}) {
    EXPECT_EQ(run_light(t, random, 300, {0.2, 0.3}, nullptr, clocks).fragments, 300U) << clocks;
  }
}

// One Newton step and a small table.
Config with_small_root(Config c) {
  c.light_root = {.operand_bits = 8, .index_bits = 3, .table_bits = 6, .internal_bits = 8, .steps = 1};
  c.light_index_bits = 2;
  return c;
}

// In the gate with shadows alone: Yosys takes a tenth of the time.
TEST(LightRtl, IcarusAndYosysAgree) {
  Config shaded = with_light(shipped_config("narrow"), LightSource::parallel);
  shaded.light_shadow = LightShadow::map;
  const Config config = with_small_root(is_long_run() ? with_all(shaded) : shaded);
  Random random(8);
  LightCase t(config, random, has_light_points(config));
  StageTrace trace;
  run_light(t, random, 40, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(t.config), trace);
}

TEST(LightRtl, RefusesWhatItDoesNotHave) {
  EXPECT_THROW(emit_light_sv(shipped_config("depth16")), InputError);
  Config c = with_light(shipped_config("depth16"));
  c.format(FormatId::light_cosine).is_signed = false;
  EXPECT_THROW(emit_light_sv(c), InputError);
  c = with_all(shipped_config("depth16"));
  EXPECT_NO_THROW(emit_light_sv(c));
  for (const FormatId id : {FormatId::light_fall, FormatId::texture_alpha}) {
    Config coarse = c;
    coarse.format(id).integer = coarse.format(id).word + 1;
    EXPECT_THROW(emit_light_sv(coarse), InputError) << key_of(id);
  }
  c.format(FormatId::texture_mix).is_signed = true;
  EXPECT_THROW(emit_light_sv(c), InputError);
}

TEST(LightRtl, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/light.sv", "{1'b0, at[axis], 1'b1}", "{1'b0, at[axis], 1'b0}"},
      {"rtl/light.sv", "TowardW'(to - from);", "TowardW'(from - to);"},
      {"rtl/light.sv", "assign size[1] = height_i;", "assign size[1] = width_i;"},
      {"rtl/light.sv", ".Width(PositionW),\n        .Depth(PlaceAt - 1)",
       ".Width(PositionW),\n        .Depth(PlaceAt)"},
      {"rtl/light.sv", "point_i ? of_point : far", "!point_i ? of_point : far"},
      {"rtl/light.sv", "minus_z_q <= -wide_z;", "minus_z_q <= wide_z;"},
      {"rtl/light.sv", ".AFrac(CosineFrac - 1),", ".AFrac(CosineFrac - 2),"},
      {"rtl/light.sv", "&& cosine_q != '0;", "&& 1'b1;"},
      {"rtl/light.sv", "assign shines = lit_m &&", "assign shines ="},
      {"rtl/light.sv", "cosine_lit <= lit_q ? cosine_1 : '0;", "cosine_lit <= cosine_1;"},
      {"rtl/light.sv", "interval} + (IndexBits + 1)'(1);", "interval};"},
      {"rtl/light.sv", ".a_i(highlight_i),", ".a_i(ambient_i),"},
      {"rtl/light.sv", "relief_p ? TowardW'(through_field) :", "1'b0 ? TowardW'(through_field) :"},
      {"rtl/light.sv", "(to <<< ReliefUp) - (from <<< UvUp)", "(to <<< ReliefUp) + (from <<< UvUp)"},
      {"rtl/light.sv", "(NormalXW'(255) << (MixFrac + MapUp))", "(NormalXW'(256) << (MixFrac + MapUp))"},
      {"rtl/light.sv", "mirrored = relief_m ? '0 : mirrored_made;", "mirrored = mirrored_made;"},
      {"rtl/light.sv", "(lunar_i && !relief_s) ?", "lunar_i ?"},
      {"rtl/light.sv", "to_viewer = minus_z_q[NormalW] ? '0 : minus_z_q;", "to_viewer = minus_z_q;"},
      {"rtl/light.sv", "ambient_now = later_b ? '0 : ambient;", "ambient_now = ambient;"},
      {"rtl/light.sv", "(falls_i || shadow_f) ? ambient", "falls_i ? ambient"},
      {"rtl/light_fall.sv", ".c_i(offset),", ".c_i('0),"},
      {"rtl/light_divide.sv", ".e_i({e_line, 1'b0}),", ".e_i({e_line, 1'b1}),"},
      {"rtl/light_divide.sv", "t_q <= none ? TW'(1) : t_i;", "t_q <= t_i;"},
      {"rtl/over_255.sv", "+ ProductW'(v_2);", "+ '0;"},
      {"rtl/root.sv", "assign odd = top[0];", "assign odd = !top[0];"},
      {"rtl/root.sv", "product_y >> (YFrac + 1));", "product_y >> YFrac);"},
      {"rtl/root.sv", "e_q <= top >>> 1;", "e_q <= top;"},
      {"rtl/unit_vector.sv", "d_q     <= two_q + third_q;", "d_q     <= two_q;"},
      {"rtl/mul_pipe.sv", "? j*BLimbs+i :", "? i*BLimbs+j :"},
  };
  Config config = with_small_root(with_all(shipped_config("narrow")));
  config.light_fall_to = LightFallTo::viewer;
  // To the nearest one, a quotient just below a whole one is that, too.
  config.format(FormatId::texture_alpha).rounding = Rounding::trn;
  const auto run = [&] {
    Random random(5);
    for (int view = 0; view < 30; ++view) {
      LightCase t(config, random, view % 3 != 0);
      run_light(t, random, 500, {0.2, 0.4});
    }
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
