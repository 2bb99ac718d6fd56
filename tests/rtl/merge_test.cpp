// SPDX-License-Identifier: Apache-2.0
// rtl/merge.sv alone against the model's stage function: opaque and translucent fragments, blending on and
// off, any equation where merge has them, random gaps, stalls and memory latencies, and pixels that are hit
// again while they are in flight.
#include "model/stages/merge.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "tests/rtl/pipe_case.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

StageDesign design_of(const Config& c) {
  return {
      .name = c.name,
      .top = "merge",
      .package = emit_pixel_sv(c),
      .channels = {{ChannelKind::in, "in", {"x", "y", "r", "g", "b", "a", "blend", "reads", "write", "rest"}},
                   {ChannelKind::out, "request", {"x", "y"}},
                   {ChannelKind::in, "answer", {"r", "g", "b", "a"}},
                   {ChannelKind::out, "write", {"x", "y", "r", "g", "b", "a", "has_a"}},
                   {ChannelKind::tap, "record", {"rest"}}},
      .constants = {"joined_src", "joined_dst", "joined_op", "joined_alpha_src", "joined_alpha_dst",
                    "joined_alpha_op", "joined_constant", "joined_logic", "joined_has_a"},
      .levels = {"joined_rest"}};
}

using Pixel = std::array<std::uint8_t, 4>;

struct Drawn {
  std::uint64_t x = 0, y = 0;
  FogRecord fog;
  std::int64_t a = 0;
  bool blend = true, write = true;
};

struct MergeCase {
  model::MergeStage stage;  // its blend counts where merge has equations
  std::vector<Drawn> drawn;
  std::vector<StageValues> writes;  // x, y, r, g, b, a, has_a; a is 0 where it is not written
  std::size_t reads = 0;
  std::map<StageMemory::Address, StageValues> stored;
};

Pixel background(const StageMemory::Address& at) {
  return {static_cast<std::uint8_t>(at[0] * 37), static_cast<std::uint8_t>(at[1] * 59),
          static_cast<std::uint8_t>(at[0] + at[1]), static_cast<std::uint8_t>(at[0] * 91 + at[1] * 7)};
}
StageValues values(const Pixel& p) { return {p[0], p[1], p[2], p[3]}; }

// What the sequential model makes of the fragments.
MergeCase expect_of(const Config& c, std::vector<Drawn> drawn, const model::Blend& blend = {}) {
  MergeCase made;
  made.stage = model::prepare_merge(c);
  const bool by_equation = has_blend_equation(c.rtl.blend);
  if (by_equation) model::set_blend(made.stage, blend);
  const model::MergeStage& stage = made.stage;
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::texture_alpha).fraction();
  for (const Drawn& d : drawn) {
    const StageMemory::Address at{d.x, d.y};
    const auto found = made.stored.find(at);
    Pixel stored = background(at);
    if (found != made.stored.end()) {
      for (std::size_t i = 0; i < 4; ++i) stored[i] = static_cast<std::uint8_t>(found->second[i]);
    }
    TextureRecord texture;
    texture.a = by_equation || d.blend ? d.a : one;
    MergeRecord record;
    model::merge(stage, {}, texture, d.fog, stored, record);
    const MergeAlphaRecord alpha = model::merged_alpha(stage, texture, stored[3]);
    made.reads += model::reads_stored_color(stage, texture.a) ? 1 : 0;
    if (!d.write) continue;
    StageValues colour{static_cast<std::uint64_t>(record.r), static_cast<std::uint64_t>(record.g),
                       static_cast<std::uint64_t>(record.b),
                       stage.changes_alpha ? static_cast<std::uint64_t>(alpha.a) : stored[3]};
    made.stored[at] = colour;
    made.writes.push_back({d.x, d.y, colour[0], colour[1], colour[2], stage.changes_alpha ? colour[3] : 0,
                           stage.changes_alpha ? 1U : 0U});
  }
  made.drawn = std::move(drawn);
  return made;
}

// Fragments on width x height pixels, half of them opaque.
MergeCase make_case(Random& random, const Config& c, int count, std::uint64_t width, std::uint64_t height) {
  std::vector<Drawn> drawn(static_cast<std::size_t>(count));
  const Format& color = c.format(FormatId::fog_color);
  const Format& alpha = c.format(FormatId::texture_alpha);
  const std::uint64_t mask = (std::uint64_t{1} << pixel_index_bits(c)) - 1;
  const std::uint64_t corner = random() & mask;
  for (Drawn& d : drawn) {
    d.x = (corner + random() % width) & mask;
    d.y = (corner + random() % height) & mask;
    for (std::int64_t* raw : {&d.fog.r, &d.fog.g, &d.fog.b}) *raw = random_raw(random, color);
    d.a = random_raw(random, alpha);
    switch (random() % 4) {
      case 0:
        d.a = std::int64_t{1} << alpha.fraction();
        break;
      case 1:
        d.a = static_cast<std::int64_t>(random() & ((std::uint64_t{1} << alpha.fraction()) - 1));
        break;
      default:
        break;
    }
    d.blend = random() % 4 != 0;
    d.write = random() % 8 != 0;
  }
  return expect_of(c, std::move(drawn), random_blend(random));
}

struct MergeRun {
  std::size_t compared = 0, in_flight = 0;
  std::uint64_t first_write = 0, last_write = 0;  // clocks since the first fragment was offered
};

// Throws std::logic_error where anything differs.
MergeRun run_merge(const Config& c, const MergeCase& given, double in_gap, const StageStalls& stalls,
                   StageMemory::Latency latency, std::uint64_t seed) {
  StageBench bench(design_of(c), seed);
  await_sweep(bench, c);
  bench.set_stalls(stalls);
  bench.set_stalls("in", {in_gap, 0});
  StageMemory memory(bench, "request", "answer", "write", 2, latency, seed,
                     [](const StageMemory::Address& at) { return values(background(at)); });
  memory.merge_writes(merged_color);
  const model::Blend& blend = given.stage.blend;
  const auto number = [](auto name) { return static_cast<std::uint64_t>(name); };
  bench.set_constant("joined_src", number(blend.color.src));
  bench.set_constant("joined_dst", number(blend.color.dst));
  bench.set_constant("joined_op", number(blend.color.op));
  bench.set_constant("joined_alpha_src", number(blend.alpha.src));
  bench.set_constant("joined_alpha_dst", number(blend.alpha.dst));
  bench.set_constant("joined_alpha_op", number(blend.alpha.op));
  bench.set_constant("joined_constant", number(blend.constant[0] | blend.constant[1] << 8 |
                                               blend.constant[2] << 16 | blend.constant[3] << 24));
  bench.set_constant("joined_logic", number(blend.logic));
  bench.set_constant("joined_has_a", given.stage.changes_alpha ? 1 : 0);
  // What tells a read: by the model in front of merge with equations; else `reads` is not looked at.
  const bool by_equation = has_blend_equation(c.rtl.blend);
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::texture_alpha).fraction();
  const bool reads = model::reads_stored_color(given.stage, one);
  const bool mixes = model::reads_stored_color(given.stage, one - 1) && !reads;
  MergeRun run;
  const std::uint64_t begin = bench.clocks();
  std::size_t next_record = 0;
  std::size_t next_write = 0;
  bench.on_transfer("record", [&](const StageValues& v) {
    if (v[0] != next_record) throw std::logic_error(fmt::format("record {} is {}", next_record, v[0]));
    ++next_record;
    ++run.compared;
  });
  memory.on_write([&](StageValues v) {
    if (v.back() == 0) v[5] = 0;
    if (next_write >= given.writes.size()) throw std::logic_error("a write after the last");
    if (v != given.writes[next_write]) {
      throw std::logic_error(fmt::format("write {} is {}, expected {}", next_write, fmt::join(v, " "),
                                         fmt::join(given.writes[next_write], " ")));
    }
    if (next_write == 0) run.first_write = bench.clocks() - 1 - begin;
    run.last_write = bench.clocks() - 1 - begin;
    ++next_write;
    run.compared += v.size();
  });
  for (std::size_t i = 0; i < given.drawn.size(); ++i) {
    const Drawn& d = given.drawn[i];
    const auto color = [&](std::int64_t raw) {
      return Rtl::to_port(raw, c.format(FormatId::fog_color).word);
    };
    bench.send("in", {d.x, d.y, color(d.fog.r), color(d.fog.g), color(d.fog.b),
                      Rtl::to_port(d.a, c.format(FormatId::texture_alpha).word),
                      (by_equation ? mixes : d.blend) ? 1U : 0U, (by_equation ? reads : i % 2 == 0) ? 1U : 0U,
                      d.write ? 1U : 0U, i});
  }
  bench.run_until([&] { return next_record == given.drawn.size() && next_write == given.writes.size(); });
  if (next_record != given.drawn.size()) throw std::logic_error("a record after the last");
  if (bench.transfers("request") != given.reads) {
    throw std::logic_error(
        fmt::format("{} reads, {} fragments are mixed", bench.transfers("request"), given.reads));
  }
  run.in_flight = memory.most_in_flight();
  return run;
}

void check_config_on(const Config& c, std::uint64_t seed, int count) {
  Random random(seed);
  const MergeCase dense = make_case(random, c, count, 3, 2);
  const MergeCase single = make_case(random, c, count, 1, 1);
  const MergeCase loose = make_case(random, c, count, 40, 30);
  EXPECT_GE(run_merge(c, dense, 0, {}, {1, 1}, random()).compared, static_cast<std::size_t>(3 * count));
  run_merge(c, dense, 0.2, {0.2, 0.4}, {1, 9}, random());
  run_merge(c, single, 0.9, {0.1, 0.1}, {1, 3}, random());  // most arrive as an earlier one leaves
  run_merge(c, loose, 0.3, {0.3, 0.3}, {1, 40}, random());
  const std::size_t in_flight = run_merge(c, loose, 0, {}, {12, 20}, random()).in_flight;
  if (loose.reads > loose.drawn.size() / 5) {
    EXPECT_GE(in_flight, 4U);
  }
}

class MergeRtl : public testing::TestWithParam<std::string> {};
TEST_P(MergeRtl, ShippedConfigurations) { check_config_on(shipped_config(GetParam()), 8, 400); }
TEST_P(MergeRtl, Equations) {
  Config c = shipped_config(GetParam());
  c.rtl.blend = RtlBlend::equation;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) check_config_on(c, seed, 200);
}
INSTANTIATE_TEST_SUITE_P(Merge, MergeRtl, testing::ValuesIn(shipped_names));

TEST(Merge, RandomConfigurations) {
  for (const std::uint64_t seed : stage_seeds(6)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check_config_on(random_stage_config(seed), seed, 300);
    if (HasFailure()) return;
  }
}

// A row of pixels on a memory that answers at once: one per clock, by the clocks of config/pixel_timing.
TEST(Merge, OneFragmentPerClock) {
  for (const auto& [of, blend] : {std::pair(RtlBlend::alpha, false),
                                  {RtlBlend::alpha, true},
                                  {RtlBlend::equation, false},
                                  {RtlBlend::equation, true}}) {
    Config c = shipped_config("depth16");
    c.rtl.blend = of;
    const MergeTiming timing = pixel_timing(c).merge;
    std::vector<Drawn> row(250);
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i].x = i;
      row[i].fog.g = static_cast<std::int64_t>(i * 16);
      row[i].a = 300;
      row[i].blend = blend;
    }
    model::Blend replaces;
    replaces.color = {BlendFactor::one, BlendFactor::zero, BlendOp::add};
    const MergeCase given = expect_of(c, row, blend ? model::Blend{} : replaces);
    EXPECT_EQ(given.reads, blend ? 250U : 0U);
    const auto total = static_cast<std::uint64_t>(blend ? timing.total_blending : timing.total);
    const MergeRun run = run_merge(c, given, 0, {}, {1, 1}, 1);
    EXPECT_EQ(run.first_write, total);
    EXPECT_EQ(run.last_write, total + 249);
    const int latency = pixel_timing(c).in_flight - 8;
    EXPECT_LE(run_merge(c, given, 0, {}, {latency, latency}, 1).last_write,
              total + static_cast<std::uint64_t>(latency) + 249);
  }
}

TEST(Merge, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/merge.sv", "assign reads = entry_needs[0] && translucent;", "assign reads = translucent;"},
      {"rtl/merge.sv", ".out_ready_i(take && waited_reads)", ".out_ready_i(take || !waited_reads)"},
      {"rtl/merge.sv", "share_q <= waited_reads ? waited_a : AlphaW'(1) << AlphaFrac;",
       "share_q <= waited_a;"},
      {"rtl/merge.sv", "assign write_valid_o = done_valid && done_write;",
       "assign write_valid_o = done_valid;"},
      {"rtl/merge.sv", "assign leave = done_valid && done_ready;", "assign leave = done_valid;"},
      {"rtl/blend.sv", "diff_q <= DiffW'(b) - DiffW'(a);", "diff_q <= DiffW'(a) - DiffW'(b);"},
      {"rtl/blend.sv", ".Depth(ProductClocks)", ".Depth(ProductClocks + 1)"},
  };
  const Config c = shipped_config("depth16");
  Random random(5);
  const MergeCase given = make_case(random, c, 300, 3, 2);
  const MergeCase single = make_case(random, c, 300, 1, 1);
  const auto run = [&] {
    run_merge(c, given, 0.2, {0.2, 0.4}, {1, 9}, 11);
    run_merge(c, single, 0.9, {0.1, 0.1}, {1, 3}, 12);
  };
  expect_seen(bugs, run);
  expect_seen(scoreboard_bugs, run);
  run_merge(c, given, 0.2, {0.2, 0.4}, {1, 9}, 11);
}

TEST(Merge, PlantedBugsOfEquationsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/merge.sv", "assign reads = entry_needs[NeedsW-1] || (entry_needs[0] && translucent);",
       "assign reads = entry_needs[NeedsW-1];"},
      {"rtl/merge.sv", "assign reads = entry_needs[NeedsW-1] || (entry_needs[0] && translucent);",
       "assign reads = (entry_needs[0] && translucent);"},
      {"rtl/merge.sv", "stored_q <= waited_reads ? stored : '0;", "stored_q <= '0;"},
      {"rtl/merge.sv", "{stored_q[3*ColorW+:ColorW], stored_q[0+:ColorW]",
       "{stored_q[0+:ColorW], stored_q[0+:ColorW]"},
      {"rtl/merge.sv", ".in_r_i        (own_q[2*OwnW+:OwnW])", ".in_r_i        (own_q[0+:OwnW])"},
      {"rtl/merge.sv",
       "{constant_q, logic_q, has_a_q} <= {joined_constant_i, joined_logic_i, joined_has_a_i};",
       "{constant_q, logic_q, has_a_q} <= {joined_constant_i, joined_logic_i, 1'b1};"},
      {"rtl/merge.sv", "{alpha_src_q, alpha_dst_q, alpha_op_q} <= {joined_alpha_src_i, joined_alpha_dst_i,",
       "{alpha_src_q, alpha_dst_q, alpha_op_q} <= {joined_src_i, joined_dst_i,"},
      {"rtl/merge.sv", "else if (en) valid_q <= join_valid;", "else valid_q <= join_valid;"},
  };
  Config c = shipped_config("depth16");
  c.rtl.blend = RtlBlend::equation;
  Random random(5);
  std::vector<MergeCase> cases;
  for (int i = 0; i < 16; ++i) cases.push_back(make_case(random, c, 100, 3, 2));
  const auto run = [&] {
    for (const MergeCase& given : cases) run_merge(c, given, 0.2, {0.2, 0.4}, {1, 9}, 11);
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
