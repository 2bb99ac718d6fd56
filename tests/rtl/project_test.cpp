// SPDX-License-Identifier: Apache-2.0
// rtl/project.sv alone against the model's stage: shipped and random configurations, every kind of
// reciprocal, points in front of the projector and behind, gaps and stalls.
#include "model/stages/project.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_project_sv.hpp"
#include "engine/sv_writer.hpp"
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
          .top = "project",
          .package = emit_project_sv(c),
          .channels = {{ChannelKind::in, "in", {"h", "x", "y", "w", "width", "height", "rest"}},
                       {ChannelKind::out,
                        "out",
                        {"recip_m", "recip_e", "s", "t", "ratio", "h", "z", "inside", "rest"}}},
          .constants = {"b", "a", "far_b", "projector"},
          .levels = {},
          .sources = project_sources()};
}

bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }
std::uint64_t port(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }

// What a view sets.
struct ProjectCase {
  Config config;
  model::ProjectStage stage;
  std::int64_t b = 1, a = 1, far_b = 0;

  ProjectCase(const Config& c, Random& random, bool has_projector = true) : config(c) {
    Scene scene;
    scene.projector = Projector{1, 2};
    stage = model::prepare_project(c, model::Constants{}, scene);
    const auto drawn = [&](FormatId id) { return random_raw(random, c.format(id)); };
    const auto exact = [&](std::int64_t raw, FormatId id) {
      return model::Exact{raw, c.format(id).fraction()};
    };
    b = std::max<std::int64_t>(1, drawn(FormatId::setup_b));
    a = drawn(FormatId::distance_a);
    far_b = drawn(FormatId::setup_b);
    stage.q.b = model::on_grid(exact(b, FormatId::setup_b), stage.q.fraction);
    stage.a = exact(a, FormatId::distance_a);
    stage.projector_b = exact(far_b, FormatId::setup_b);
    stage.has_projector = has_projector;
  }
  void set(StageBench& bench) const {
    bench.set_constant("b", port(b, config.format(FormatId::setup_b)));
    bench.set_constant("a", port(a, config.format(FormatId::distance_a)));
    bench.set_constant("far_b", port(far_b, config.format(FormatId::setup_b)));
    bench.set_constant("projector", stage.has_projector ? 1 : 0);
  }
};

struct ProjectRun : UnitRun {
  std::size_t inside = 0, behind = 0;
};

Exchange random_fragment(Random& random, ProjectCase& t, std::uint64_t number, ProjectRun& run) {
  const Config& c = t.config;
  const Format& value = c.format(FormatId::project_value);
  t.stage.width = static_cast<int>(1 + random() % (chance(random, 0.5) ? 16 : texture_size_limit));
  t.stage.height = static_cast<int>(1 + random() % (chance(random, 0.5) ? 16 : texture_size_limit));
  FragmentRecord f;
  f.h = random_raw(random, c.format(FormatId::span_h));
  const std::int64_t w = random_raw(random, value);
  // Mostly where its texture is, or a little beside it: elsewhere s and t are at the ends of their range.
  const auto along = [&](int side) {
    if (chance(random, 0.2)) return random_raw(random, value);
    const double share = std::uniform_real_distribution<double>(-0.1, 1.1)(random);
    const double at = static_cast<double>(w) * share * side;
    const double most = std::ldexp(1.0, value.word - (value.is_signed ? 1 : 0)) * 0.999;
    return static_cast<std::int64_t>(std::clamp(at, value.is_signed ? -most : 0.0, most));
  };
  const std::int64_t x = along(t.stage.width);
  const std::int64_t y = along(t.stage.height);
  model::FragmentChannels channels{};
  std::size_t given = 0;
  for (const auto& [line, raw] :
       {std::pair{LineId::project_x, x}, {LineId::project_y, y}, {LineId::project_w, w}}) {
    channels[given].channel = static_cast<std::int64_t>(line) - fixed_lines;
    channels[given++].w = raw;
  }
  ProjectRecord r;
  model::project(t.stage, f, &channels, r);
  run.inside += r.inside == 1 ? 1U : 0U;
  run.behind += w <= 0 ? 1U : 0U;
  Exchange g;
  g.in = {port(f.h, c.format(FormatId::span_h)),
          port(x, value),
          port(y, value),
          port(w, value),
          static_cast<std::uint64_t>(t.stage.width),
          static_cast<std::uint64_t>(t.stage.height),
          number};
  const Format& uv = c.format(FormatId::span_uv);
  g.out = {port(r.recip_m, c.pixel_reciprocal.output),
           Rtl::to_port(r.recip_e, exponent_bits),
           port(r.s, uv),
           port(r.t, uv),
           port(r.ratio, c.format(FormatId::project_ratio)),
           port(r.h, c.format(FormatId::project_h)),
           port(r.z, c.depth_format()),
           static_cast<std::uint64_t>(r.inside),
           number};
  return g;
}

// Sends `count` fragments; throws where one comes out otherwise, is lost, doubled, or comes after the last.
ProjectRun run_project(ProjectCase& t, Random& random, std::size_t count, const StageStalls& stalls,
                       StageTrace* trace = nullptr, int reset_after = 0) {
  const StageDesign unit = design_of(t.config);
  StageBench bench(unit, random());
  t.set(bench);
  bench.set_stalls(stalls);
  ProjectRun r;
  if (reset_after > 0) {
    for (int n = 0; n < reset_after; ++n) bench.send("in", random_fragment(random, t, 0, r).in);
    for (int n = 0; n < reset_after; ++n) bench.clock();
    bench.reset();
  }
  if (trace != nullptr) bench.keep_trace(*trace);
  static_cast<UnitRun&>(r) = run_unit(
      bench, unit, count, [&](std::uint64_t n) { return random_fragment(random, t, mark_of(n), r); },
      to_toml(t.config));
  return r;
}

Config with_projector(Config c, DepthCode code = DepthCode::inverse) {
  c.project = ProjectUnit::reciprocal;
  c.depth_code = code;
  return c;
}

// Legal, around a random one, with registers of other widths.
Config random_project_config(std::uint64_t seed) {
  Random random(seed);
  for (std::uint64_t n = 0;; ++n) {
    Config c = with_projector(random_stage_config(seed + 1000 * n),
                              chance(random, 0.5) ? DepthCode::inverse : DepthCode::opengl);
    c.pixel_reciprocal.pipelined = true;
    for (const FormatId id : {FormatId::project_value, FormatId::project_ratio, FormatId::project_h}) {
      Format& f = c.format(id);
      f.word += static_cast<int>(random() % 9) - 6;
      f.integer += static_cast<int>(random() % 5) - 2;
      f.rounding = static_cast<Rounding>(random() % enum_names<Rounding>.size());
      f.overflow = static_cast<Overflow>(random() % enum_names<Overflow>.size());
    }
    if (first_violation(c)) continue;
    try {
      static_cast<void>(design_of(c));
      Random unused(seed);
      static_cast<void>(ProjectCase(c, unused));
      return c;
    } catch (const InputError&) {  // an operand that the ports do not hold, or the range of the distances
    }
  }
}

void check(const Config& config, std::uint64_t seed, std::size_t count) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  const StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};
  for (const StageStalls& stalls : conditions) {
    ProjectCase t(config, random);
    const ProjectRun r = run_project(t, random, count, stalls);
    EXPECT_EQ(r.fragments, count);
    EXPECT_GT(r.behind, 0U);
  }
}

// In the gate one of them.
std::vector<Config> designs() {
  std::vector<Config> all;
  for (const Config& config : shipped_configs()) {
    all.push_back(with_projector(config));
    all.push_back(with_projector(config, DepthCode::opengl));
  }
  const auto some = in_gate(all);
  return {some.begin(), some.end()};
}

// In the long form more than 10^7 fragments.
TEST(ProjectRtl, Shipped) {
  for (const Config& config : designs()) check(config, 11, is_long_run() ? 420000 : 3000);
}

TEST(ProjectRtl, ShowsPointsOnBothSidesOfEachEdge) {
  Random random(4);
  ProjectCase t(with_projector(shipped_config("depth16")), random);
  const ProjectRun r = run_project(t, random, 4000, {});
  EXPECT_GT(r.inside, 400U);
  EXPECT_GT(r.behind, 400U);
  EXPECT_GT(r.fragments - r.inside - r.behind, 400U);
}

TEST(ProjectRtl, Random) {
  for (const std::uint64_t seed : stage_seeds(is_long_run() ? 20 : 2)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_project_config(seed), seed, 1200);
  }
}

TEST(ProjectRtl, Clocks) {
  for (const Config& config : designs()) {
    Random random(5);
    ProjectCase t(config, random);
    const auto total = static_cast<std::uint64_t>(project_timing(config).total);
    const ProjectRun r = run_project(t, random, 500, {});
    EXPECT_EQ(r.first_out, r.offered + total) << config.name;
    EXPECT_EQ(r.last_out, r.offered + total + 499) << config.name;
  }
}

TEST(ProjectRtl, AViewWithoutProjectorGivesZeros) {
  Random random(6);
  ProjectCase t(with_projector(shipped_config("narrow"), DepthCode::opengl), random, false);
  EXPECT_EQ(run_project(t, random, 500, {0.2, 0.2}).inside, 0U);
}

TEST(ProjectRtl, ResetAmidFragments) {
  Random random(7);
  ProjectCase t(with_projector(shipped_config("narrow"), DepthCode::opengl), random);
  for (const int clocks : {3, 12, 40}) {
    EXPECT_EQ(run_project(t, random, 300, {0.2, 0.3}, nullptr, clocks).fragments, 300U) << clocks;
  }
}

TEST(ProjectRtl, IcarusAndYosysAgree) {
  Random random(8);
  ProjectCase t(with_projector(shipped_config("narrow"), DepthCode::opengl), random);
  StageTrace trace;
  run_project(t, random, 60, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(t.config), trace);
}

TEST(ProjectRtl, RefusesWhatItDoesNotHave) {
  EXPECT_THROW(emit_project_sv(shipped_config("depth16")), InputError);
  Config c = with_projector(shipped_config("depth16"));
  c.pixel_reciprocal.pipelined = false;
  EXPECT_THROW(emit_project_sv(c), InputError);
}

TEST(ProjectRtl, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/project.sv", "&& in_w_i != '0;", "&& 1'b1;"},
      {"rtl/project.sv", "!((ValueSigned != 0) && in_w_i[ValueW-1]) &&", "(1'b1) &&"},
      {"rtl/project.sv", "assign in_front = projector_i &&", "assign in_front ="},
      {"rtl/project.sv", ".value_i(in_y_i),", ".value_i(in_h_i),"},
      {"rtl/project.sv", ".side_i(in_height_i),", ".side_i(in_height_i ^ 1),"},
      {"rtl/project_place.sv", "placed < limit;", "placed <= limit;"},
      {"rtl/project_place.sv", "!placed[CompareW-1] &&", "(!1'b0) &&"},
      {"rtl/project.sv", "contains_s && contains_t;", "contains_s || contains_t;"},
      {"rtl/project.sv", "minus_far_b = -far_b;", "minus_far_b = far_b;"},
      {"rtl/project.sv", ".c_i(minus_far_b),", ".c_i('0),"},
      {"rtl/project.sv", ".Depth(RecipAt - 1)\n  ) u_sum_line", ".Depth(RecipAt)\n  ) u_sum_line"},
      {"rtl/project.sv", ".Depth(Clocks - HAt)\n  ) u_h_line", ".Depth(Clocks - HAt + 1)\n  ) u_h_line"},
      {"rtl/project.sv", "- DifferenceW'(1)) <<< HGrid;", ") <<< HGrid;"},
      {"rtl/project.sv", ".a_i(sum),\n", ".a_i(sum_q),\n"},
      {"rtl/multiply_round.sv", "sticky_i(sticky)", "sticky_i(1'b0)"},
      {"rtl/multiply_round.sv", "far_i(far)", "far_i(1'b0)"},
  };
  Config config = with_projector(shipped_config("narrow"), DepthCode::opengl);
  config.format(FormatId::project_ratio).rounding = Rounding::rnd_min_inf;
  const auto run = [&] {
    Random random(5);
    for (const bool has_projector : {true, false}) {
      ProjectCase t(config, random, has_projector);
      run_project(t, random, 3000, {0.2, 0.4});
    }
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
