// SPDX-License-Identifier: Apache-2.0
// rtl/depth.sv alone against the model's stage function: every depth code and comparison, random gaps, stalls
// and memory latencies, and pixels that are hit again while they are in flight.
#include "model/stages/depth.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "depth",
          .package = emit_pixel_sv(c),
          .channels = {{ChannelKind::in, "in", {"x", "y", "h", "func", "rest"}},
                       {ChannelKind::out, "request", {"x", "y"}},
                       {ChannelKind::in, "answer", {"z"}},
                       {ChannelKind::out, "write", {"x", "y", "z"}},
                       {ChannelKind::out, "out", {"x", "y", "h", "z", "mark", "rest"}},
                       {ChannelKind::in, "fate", {"x", "y", "z", "mark", "write"}},
                       {ChannelKind::tap,
                        "record",
                        {"x", "y", "recip_m", "recip_e", "z", "stored", "pass", "rest"}}},
          .constants = {"b", "c1", "c0", "bias"},
          .levels = {"bias_rest"}};
}

std::uint64_t port_of(DepthFunc func) {
  const PassingDistances d = passing_distances(func);
  return (d.nearer ? 1U : 0U) | (d.equal ? 2U : 0U) | (d.farther ? 4U : 0U);
}

struct Drawn {
  FragmentRecord fragment;
  DepthFunc func = DepthFunc::less;
  bool written = false;  // its fate, where it passes
};

struct DepthCase {
  model::Constants constants;
  std::int64_t bias = 0;
  std::vector<Drawn> drawn;
  std::vector<DepthRecord> records;  // one per fragment
  std::map<StageMemory::Address, std::uint64_t> stored;
};

std::uint64_t initial_code(const model::DepthStage& stage, const StageMemory::Address& at) {
  return static_cast<std::uint64_t>(
      (at[0] + at[1]) % 3 == 0 ? (static_cast<std::int64_t>(at[0] * 977 + at[1]) & stage.formats.zmax)
                               : stage.clear);
}

// What the sequential model makes of the fragments.
DepthCase expect_of(const Config& c, const model::Constants& constants, std::vector<Drawn> drawn,
                    std::int64_t bias = 0) {
  DepthCase made;
  made.constants = constants;
  made.bias = bias;
  model::DepthStage stage = model::prepare_depth(c, constants);
  stage.bias = bias;
  for (const Drawn& d : drawn) {
    const StageMemory::Address at{static_cast<std::uint64_t>(d.fragment.x),
                                  static_cast<std::uint64_t>(d.fragment.y)};
    const auto found = made.stored.find(at);
    const std::uint64_t stored = found == made.stored.end() ? initial_code(stage, at) : found->second;
    stage.func = d.func;
    DepthRecord record;
    const bool pass = model::depth(stage, d.fragment, nullptr, static_cast<std::int64_t>(stored), record);
    if (pass && d.written) made.stored[at] = static_cast<std::uint64_t>(record.z);
    made.records.push_back(record);
  }
  made.drawn = std::move(drawn);
  return made;
}

// Constants that bring codes into range; false where the configuration does not hold them.
bool set_constants_of_scene(const Config& c, model::Constants& constants) {
  Scene scene;
  scene.s_min = 1;
  scene.s_max = 100;
  try {
    constants = model::make_constants(c, scene);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

// Fragments on width x height pixels, the codes of some of them equal.
DepthCase make_case(Random& random, const Config& c, int count, std::uint64_t width, std::uint64_t height) {
  DepthCase made;
  ConstantsRecord& k = made.constants.record;
  const bool of_scene = random() % 2 == 0 && set_constants_of_scene(c, made.constants);
  if (!of_scene) k.b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
  if (!of_scene && is_linear_in_distance(c.depth_code)) {
    k.c1 = random_raw(random, c.format(FormatId::depth_c1));
    k.c0 = random_raw(random, c.format(FormatId::depth_c0));
  }
  const Format& h = c.format(FormatId::span_h);
  std::vector<std::int64_t> pool(8);
  for (std::int64_t& raw : pool) raw = random_raw(random, h);
  const std::uint64_t mask = (std::uint64_t{1} << pixel_index_bits(c)) - 1;
  const std::uint64_t corner = random() & mask;
  std::vector<Drawn> drawn(static_cast<std::size_t>(count));
  for (Drawn& d : drawn) {
    d.fragment.x = static_cast<std::int64_t>((corner + random() % width) & mask);
    d.fragment.y = static_cast<std::int64_t>((corner + random() % height) & mask);
    d.fragment.h = random() % 2 == 0 ? pool[random() % pool.size()] : random_raw(random, h);
    d.func = static_cast<DepthFunc>(random() % enum_names<DepthFunc>.size());
    d.written = random() % 5 != 0;
  }
  const std::int64_t zmax = (std::int64_t{1} << c.depth_bits) - 1;
  const std::int64_t biases[] = {0, 1, -1, zmax / 3, -zmax / 3, zmax, -zmax};
  return expect_of(c, made.constants, std::move(drawn), biases[random() % std::size(biases)]);
}

struct Way {
  double in_gap = 0;   // of the fragments
  StageStalls stalls;  // of the other channels
  StageMemory::Latency latency;
  bool fates_in_order = true;
  std::uint64_t seed = 1;
};

struct DepthRun {
  std::size_t compared = 0, in_flight = 0;
  std::uint64_t first_out = 0, last_record = 0;  // clocks since the first fragment was accepted
};

// Throws std::logic_error where anything differs.
DepthRun run_depth(const Config& c, const DepthCase& given, const Way& way) {
  StageBench bench(design_of(c), way.seed);
  await_sweep(bench, c);
  const auto port = [&](FormatId id, std::int64_t raw) { return Rtl::to_port(raw, c.format(id).word); };
  const ConstantsRecord& k = given.constants.record;
  bench.set_constant("b", port(FormatId::setup_b, k.b));
  bench.set_constant("c1", port(FormatId::depth_c1, k.c1));
  bench.set_constant("c0", port(FormatId::depth_c0, k.c0));
  bench.set_constant("bias", Rtl::to_port(given.bias, c.depth_bits + 1));
  bench.set_stalls(way.stalls);
  bench.set_stalls("in", {way.in_gap, 0});
  const model::DepthStage stage = model::prepare_depth(c, given.constants);
  StageMemory memory(bench, "request", "answer", "write", 2, way.latency, way.seed,
                     [&](const StageMemory::Address& at) { return StageValues{initial_code(stage, at)}; });
  DepthRun run;
  const std::uint64_t begin = bench.clocks();
  std::size_t next_record = 0;
  std::size_t next_out = 0;  // of the records
  std::vector<StageValues> fates;
  const auto expect = [](const char* what, std::size_t i, const StageValues& got, const StageValues& want) {
    if (got == want) return;
    throw std::logic_error(
        fmt::format("{} {} is {}, expected {}", what, i, fmt::join(got, " "), fmt::join(want, " ")));
  };
  bench.on_transfer("record", [&](const StageValues& v) {
    if (next_record >= given.records.size()) throw std::logic_error("a record after the last");
    const DepthRecord& r = given.records[next_record];
    expect("record", next_record, v,
           {static_cast<std::uint64_t>(r.x), static_cast<std::uint64_t>(r.y),
            Rtl::to_port(r.recip_m, c.pixel_reciprocal.output.word), Rtl::to_port(r.recip_e, 8),
            static_cast<std::uint64_t>(r.z), static_cast<std::uint64_t>(r.stored),
            static_cast<std::uint64_t>(r.pass), next_record});
    ++next_record;
    run.compared += v.size();
    run.last_record = bench.clocks() - 1 - begin;
  });
  bench.on_transfer("out", [&](const StageValues& v) {
    if (next_out == 0) run.first_out = bench.clocks() - 1 - begin;
    while (next_out < given.records.size() && given.records[next_out].pass == 0) ++next_out;
    if (next_out == given.records.size()) throw std::logic_error("a fragment after the last");
    const DepthRecord& r = given.records[next_out];
    expect("fragment", next_out, v,
           {static_cast<std::uint64_t>(r.x), static_cast<std::uint64_t>(r.y),
            port(FormatId::span_h, given.drawn[next_out].fragment.h), static_cast<std::uint64_t>(r.z), v[4],
            next_out});
    fates.push_back({v[0], v[1], v[3], v[4], given.drawn[next_out].written ? 1U : 0U});
    run.compared += v.size() - 1;
    ++next_out;
  });
  for (std::size_t i = 0; i < given.drawn.size(); ++i) {
    const Drawn& d = given.drawn[i];
    bench.send("in", {static_cast<std::uint64_t>(d.fragment.x), static_cast<std::uint64_t>(d.fragment.y),
                      port(FormatId::span_h, d.fragment.h), port_of(d.func), i});
  }
  const auto passed = static_cast<std::uint64_t>(std::ranges::count(given.records, 1, &DepthRecord::pass));
  Random random(way.seed);
  bench.run_until([&] {
    if (way.fates_in_order) {
      for (StageValues& fate : fates) bench.send("fate", std::move(fate));
      fates.clear();
    } else if (!fates.empty() && random() % 4 == 0) {
      const std::size_t i = random() % fates.size();
      bench.send("fate", fates[i]);
      fates.erase(fates.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return next_record == given.records.size() && bench.transfers("out") == passed && fates.empty() &&
           bench.waiting("fate") == 0;
  });
  if (bench.transfers("out") != passed || !fates.empty()) {
    throw std::logic_error(fmt::format("{} fragments come out, {} pass", bench.transfers("out"), passed));
  }
  for (const auto& [at, z] : given.stored) {
    expect("pixel", 0, memory.at(at), {z});
    ++run.compared;
  }
  if (memory.written().size() != given.stored.size()) throw std::logic_error("other pixels are written");
  run.in_flight = memory.most_in_flight();
  return run;
}

// Many hits per pixel, few, and none within what is in flight.
void check_config_on(const Config& c, std::uint64_t seed, int count) {
  Random random(seed);
  const DepthCase dense = make_case(random, c, count, 3, 2);
  const DepthCase single = make_case(random, c, count, 1, 1);
  const DepthCase loose = make_case(random, c, count, 40, 30);
  EXPECT_GE(run_depth(c, dense, {0, {}, {1, 1}, true, random()}).compared,
            static_cast<std::size_t>(8 * count));
  run_depth(c, dense, {0.2, {0.2, 0.4}, {1, 9}, false, random()});
  run_depth(c, single, {0.9, {0.1, 0.1}, {1, 3}, true, random()});  // most arrive as an earlier one leaves
  run_depth(c, loose, {0.3, {0.3, 0.3}, {1, 40}, true, random()});
  const DepthRun fast = run_depth(c, loose, {0, {}, {12, 20}, false, random()});
  EXPECT_GE(fast.in_flight, 8U);
}

class DepthRtl : public testing::TestWithParam<std::tuple<std::string, DepthCode>> {};

TEST_P(DepthRtl, ShippedConfigurations) {
  Config c = shipped_config(std::get<0>(GetParam()));
  c.depth_code = std::get<1>(GetParam());
  check_config_on(c, 7, 400);
}

INSTANTIATE_TEST_SUITE_P(Depth, DepthRtl,
                         testing::Combine(testing::ValuesIn(shipped_names),
                                          testing::Values(DepthCode::inverse, DepthCode::opengl,
                                                          DepthCode::linear)));

TEST(Depth, RandomConfigurations) {
  for (const std::uint64_t seed : stage_seeds(6)) {
    SCOPED_TRACE(stage_seed_text(seed));
    const Config c = random_stage_config(seed);
    check_config_on(c, seed, 300);
    if (HasFailure()) return;
  }
}

// Codes far beyond the range of z, where what is left of the sum has no sign of its own.
TEST(Depth, EveryRoundingWhereTheLinearCodeWraps) {
  Config c = shipped_config("depth16");
  c.depth_code = DepthCode::linear;
  c.depth_overflow = Overflow::wrap;
  for (int rounding = 0; rounding < rounding_modes; ++rounding) {
    if (!in_gate(static_cast<std::size_t>(rounding), rounding_modes)) continue;
    c.depth_rounding = static_cast<Rounding>(rounding);
    SCOPED_TRACE(to_string(c.depth_rounding));
    Random random(17);
    for (int i = 0; i < 6; ++i) run_depth(c, make_case(random, c, 200, 40, 30), {0, {}, {1, 4}, true, 1});
  }
}

// A row of pixels on a memory that answers at once: one per clock, by the clocks of config/pixel_timing.
TEST(Depth, OneFragmentPerClock) {
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl, DepthCode::linear}) {
    Config c = shipped_config("depth16");
    c.depth_code = code;
    Random random(3);
    const DepthCase one = make_case(random, c, 1, 1, 1);
    std::vector<Drawn> drawn(250, one.drawn.front());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      drawn[i].func = DepthFunc::always;
      drawn[i].fragment.x = static_cast<std::int64_t>(i);
    }
    const DepthCase row = expect_of(c, one.constants, std::move(drawn));
    const auto total = static_cast<std::uint64_t>(pixel_timing(c).depth.total);
    const DepthRun run = run_depth(c, row, {0, {}, {1, 1}, true, 1});
    EXPECT_EQ(run.first_out, total);
    EXPECT_EQ(run.last_record, total - 1 + 249);
    // As fast on a memory whose latency the fragments in flight cover.
    const int latency = pixel_timing(c).in_flight - 8;
    const DepthRun late = run_depth(c, row, {0, {}, {latency, latency}, true, 1});
    EXPECT_LE(late.last_record, total + static_cast<std::uint64_t>(latency) + 249);
  }
}

TEST(Depth, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/scoreboard.sv", "leaves_b && place_b == looked_place_q;",
       "leaves_b && place_b < looked_place_q;"},
      {"rtl/scoreboard.sv", "assign leaves_b_entry = leaves_b && place_b == place;",
       "assign leaves_b_entry = leaves_b && place_b < place;"},
      {"rtl/scoreboard.sv", "free_q <= free_q || leaves_a_held", "free_q <= free_q || leave_a_i"},
      {"rtl/depth.sv", "less_q <= joined_z < joined_stored;", "less_q <= joined_z <= joined_stored;"},
      {"rtl/depth.sv", "assign failed = compared_q && en && !comes_out;",
       "assign failed = compared_q && en;"},
      {"rtl/depth.sv", ".leave_b_i     (fate_done)", ".leave_b_i     (fate_valid)"},
      {"rtl/depth.sv", "assign write_valid_o = fate_valid && fate_write;",
       "assign write_valid_o = fate_valid;"},
      {"rtl/depth.sv", "assign take = join_valid && en;", "assign take = join_valid;"},
  };
  const Config c = shipped_config("depth16");
  Random random(5);
  const DepthCase given = make_case(random, c, 300, 3, 2);
  const DepthCase single = make_case(random, c, 300, 1, 1);
  const DepthCase loose = make_case(random, c, 300, 40, 30);
  const auto run = [&] {
    run_depth(c, given, {0.2, {0.2, 0.4}, {1, 9}, false, 11});
    run_depth(c, single, {0.9, {0.1, 0.1}, {1, 3}, true, 12});
    run_depth(c, loose, {0, {0.1, 0.7}, {1, 3}, true, 13});
  };
  expect_seen(bugs, run);
  expect_seen(scoreboard_bugs, run);
  constexpr PlantedBug bias_bugs[] = {
      {"rtl/depth.sv", "biased[ZW+1] ? '0", "1'b0 ? '0"},
      {"rtl/depth.sv", "biased[ZW] ? '1", "1'b0 ? '1"},
      {"rtl/depth.sv", "(ZW + 2)'($signed(bias_i))", "(ZW + 2)'(bias_i)"},
  };
  const std::int64_t bias = std::int64_t{1} << (c.depth_bits - 1);
  expect_seen(bias_bugs, [&] {
    for (const std::int64_t by : {bias, -bias}) {
      run_depth(c, expect_of(c, given.constants, given.drawn, by), {0, {}, {1, 1}, true, 11});
    }
  });
  Config linear = c;
  linear.depth_code = DepthCode::linear;
  DepthCase far = make_case(random, linear, 300, 3, 2);
  ASSERT_TRUE(set_constants_of_scene(linear, far.constants));
  far = expect_of(linear, far.constants, std::move(far.drawn));
  run_depth(linear, far, {0, {}, {1, 1}, true, 11});
  constexpr PlantedBug linear_bugs[] = {{"rtl/depth_code.sv", "minus_c0 = -c0;", "minus_c0 = c0;"}};
  expect_seen(linear_bugs, [&] { run_depth(linear, far, {0, {}, {1, 1}, true, 11}); });
}

}  // namespace
}  // namespace bitspan
