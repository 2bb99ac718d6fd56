// SPDX-License-Identifier: Apache-2.0
// The Verilated span interpolator against exact rational numbers, over random configurations and records.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "config/rtl_timing.hpp"
#include "tb/rtl_stream.hpp"
#include "tests/rtl/interpolator_case.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

template <class R>
std::string difference(const R& got, const R& expected) {
  const auto a = raw_values(got);
  const auto b = raw_values(expected);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) {
      return std::string(fields<R>[i].name) + " is " + std::to_string(a[i]) + ", expected " +
             std::to_string(b[i]);
    }
  }
  return "";
}

// What a run did otherwise than it should; empty where it did all as expected.
std::string first_difference(const Config& c, const InterpolatorCase& expected, const RtlRun& run) {
  if (run.spans.size() != expected.spans.size()) return std::to_string(run.spans.size()) + " spans";
  if (run.pixels.size() != expected.pixels.size()) return std::to_string(run.pixels.size()) + " pixels";
  for (std::size_t i = 0; i < run.spans.size(); ++i) {
    const std::string d = difference(span_record(c, run.spans[i]), expected.spans[i]);
    if (!d.empty()) return "span " + std::to_string(i) + ": " + d;
  }
  const std::size_t channels = ChannelList(c).size();
  for (std::size_t i = 0; i < expected.span_channels.size(); ++i) {
    SpanChannelRecord got = expected.span_channels[i];
    take_channel(c, run.spans[i / channels], got);
    const std::string d = difference(got, expected.span_channels[i]);
    if (!d.empty()) return "span " + std::to_string(i / channels) + ", channel: " + d;
  }
  for (std::size_t i = 0; i < run.pixels.size(); ++i) {
    std::string d = difference(fragment_record(c, run.pixels[i]), expected.pixels[i].fragment);
    if (d.empty() && (run.pixels[i].step != 0) != expected.pixels[i].step) d = "step";
    if (!d.empty()) return "pixel " + std::to_string(i) + ": " + d;
  }
  for (std::size_t i = 0; i < expected.pixel_channels.size(); ++i) {
    FragmentChannelRecord got = expected.pixel_channels[i];
    take_channel(c, run.pixels[i / channels], got);
    const std::string d = difference(got, expected.pixel_channels[i]);
    if (!d.empty()) return "pixel " + std::to_string(i / channels) + ", channel: " + d;
  }
  return "";
}

// Number of values compared.
std::size_t compare(const Config& c, const InterpolatorCase& expected, const RtlRun& run) {
  const std::string d = first_difference(c, expected, run);
  EXPECT_EQ(d, "") << to_toml(c);
  if (!d.empty()) return 0;
  return run.spans.size() * (c.rtl.shades ? 29 : 17) + run.pixels.size() * (c.rtl.shades ? 14 : 10) +
         3 * expected.span_channels.size() + expected.pixel_channels.size();
}

// Clocks of a run without gaps and stalls, from docs/rtl.md alone.
void check_clocks(const Config& c, const InterpolatorCase& given, const RtlRun& run) {
  const RtlTiming t = rtl_timing(c);
  ASSERT_FALSE(run.accepted_at.empty());
  const auto interval = static_cast<std::uint64_t>(t.row.interval);
  EXPECT_EQ(run.taken_at[0], run.accepted_at[0] + static_cast<std::uint64_t>(t.row.latency) + 1);
  // One clock of the buffer at the output.
  const std::uint64_t span = static_cast<std::uint64_t>(t.span) + 1;
  const auto per_pixel = static_cast<std::uint64_t>(t.pixel_interval);
  std::size_t pixel = 0;
  std::uint64_t least = per_pixel - 1;  // clocks that the rows cost at least, and those until a pixel may go
  for (std::size_t i = 0; i < given.inputs.size(); ++i) {
    // The first clock after the take on which a pixel may be issued; nothing stands still.
    const std::uint64_t issued = (run.taken_at[i] + per_pixel) / per_pixel * per_pixel;
    for (std::uint64_t p = 0; p < given.inputs[i].count; ++p) {
      ASSERT_EQ(run.delivered_at[pixel++], issued + p * per_pixel + span) << "span " << i;
    }
    if (i == 0) continue;
    // Rows are accepted every `interval` clocks, but where the FIFO is full; pixels follow without a bubble.
    EXPECT_GE(run.accepted_at[i], run.accepted_at[i - 1] + interval) << "span " << i;
    EXPECT_GE(run.taken_at[i], run.taken_at[i - 1] + per_pixel * (given.inputs[i - 1].count - 1) + 1)
        << "span " << i;
    // A FIFO of one record passes one per two clocks.
    least +=
        std::max({interval, per_pixel * given.inputs[i - 1].count, std::uint64_t{c.rtl.fifo == 1 ? 2U : 1U}});
    EXPECT_LE(run.taken_at[i], run.taken_at[0] + least) << "a clock lost before span " << i;
  }
}

void check_config_on(Random& random, const Config& c, int records) {
  const InterpolatorCase given = make_interpolator_case(random, c, records, 12);
  Rtl rtl(c);
  const RtlRun free = run_rtl(rtl, given.inputs, {}, true);
  const std::size_t compared = compare(c, given, free);
  EXPECT_GT(compared, static_cast<std::size_t>(records) * 17);
  check_clocks(c, given, free);
  rtl.reset();
  const RtlRun stalled = run_rtl(rtl, given.inputs, {random(), 0.3, 0.4}, true);
  EXPECT_EQ(compare(c, given, stalled), compared);
  EXPECT_GE(stalled.clocks, free.clocks);
  // Stalls took place.
  EXPECT_TRUE(std::any_of(stalled.handshakes.begin(), stalled.handshakes.end(),
                          [](const RtlHandshake& h) { return h.out_valid && !h.out_ready; }));
  // The same handshakes again give the same answers.
  rtl.reset();
  const RtlRun again = replay_rtl(rtl, given.inputs, stalled.handshakes);
  EXPECT_EQ(again.handshakes, stalled.handshakes);
  EXPECT_EQ(again.delivered_at, stalled.delivered_at);
}

TEST(Interpolator, RandomConfigurations) {
  const char* count = std::getenv("BITSPAN_RTL_CONFIGS");
  const char* seed = std::getenv("BITSPAN_RTL_SEED");
  const int configs = count != nullptr ? std::atoi(count) : is_gate_run() ? 2 : 6;
  const std::uint64_t first = seed == nullptr ? 1 : std::strtoull(seed, nullptr, 10);
  for (int i = 0; i < configs; ++i) {
    const std::uint64_t s = first + static_cast<std::uint64_t>(i);
    SCOPED_TRACE("BITSPAN_RTL_CONFIGS=1 BITSPAN_RTL_SEED=" + std::to_string(s));
    Random random(s);
    check_config_on(random, random_rtl_config(random), 200);
    if (HasFailure()) return;
  }
}

TEST(Interpolator, Depth16InEveryMode) {
  Random random(16);
  for (const Perspective mode : in_gate(all_perspectives)) {
    for (const bool shades : {true, false}) {
      SCOPED_TRACE(std::string(to_string(mode)) + (shades ? " with" : " without") + " shades");
      Config c = shipped_config("depth16");
      c.perspective = mode;
      c.rtl.shades = shades;
      check_config_on(random, c, 200);
      // Slopes by division.
      c.row_slope = RowSlope::divide;
      if (mode != Perspective::const_depth_rows) check_config_on(random, c, 100);
    }
  }
}

TEST(Interpolator, ChannelsInEveryMode) {
  Random random(20);
  for (const Perspective mode : in_gate(all_perspectives)) {
    SCOPED_TRACE(to_string(mode));
    Config c = shipped_config("depth16");
    c.perspective = mode;
    c.fog = FogMode::vertex;
    c.depth_line = DepthLine::z;
    if (mode == Perspective::delta_f) {
      c.shade_lines = ShadeLines::perspective;
      c.second_coordinates = SecondCoordinates::own;
    }
    check_config_on(random, c, 200);
    c.rtl.shades = false;
    if (mode != Perspective::const_depth_rows) c.row_slope = RowSlope::divide;
    check_config_on(random, c, 100);
  }
}

// Multipliers that take their factors digit by digit, in turns for u and v.
TEST(Interpolator, DigitsAndTurns) {
  struct Shape {
    const char* name;
    int digits, pixel_clocks;
  };
  for (const Shape& shape : {Shape{"narrow", 1, 2}, {"narrow", 4, 8}, {"depth16", 3, 1}, {"depth20", 2, 5}}) {
    SCOPED_TRACE(shape.name);
    Config c = shipped_config(shape.name);
    c.rtl.product_digits = shape.digits;
    c.rtl.pixel_clocks = shape.pixel_clocks;
    if (shape.digits > 1) c.shade_lines = ShadeLines::perspective;
    Random random(18);
    check_config_on(random, c, 200);
  }
}

TEST(Interpolator, BugsInDigitsAndTurnsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/mul_digits.sv", "{at[Digits-1] & b[Digits*W-1], magnitude}", "{1'b0, magnitude}"},
      {"rtl/mul_digits.sv", "(above & {(AW + W) {!at_q[0]}})", "$signed(above)"},
      {"rtl/mul_digits.sv", "assign low = high_q[W-1:0];", "assign low = high_q[W:1];"},
      {"rtl/setup_mac.sv", "if (loaded_q[Digits-1]) begin", "if (loaded_q[Digits]) begin"},
      {"rtl/multiply_round_turns.sv", "(SumFrac - CFrac)) + Half", "(SumFrac - CFrac))"},
      {"rtl/span_quotients.sv", "(LastSlot - 1) % Interval", "LastSlot % Interval"},
      {"rtl/span.sv", "assign issues = en && slot;", "assign issues = en;"},
      {"rtl/span_delay.sv", "(To - From - 1) / Interval", "(To - From) / Interval"},
  };
  expect_seen(bugs, [] {
    Config c = shipped_config("narrow");
    c.rtl.product_digits = 2;
    c.rtl.pixel_clocks = 4;
    Random random(19);
    const InterpolatorCase given = make_interpolator_case(random, c, 60, 12);
    Rtl rtl(c);
    const std::string d = first_difference(c, given, run_rtl(rtl, given.inputs, {19, 0.3, 0.3}, false));
    if (!d.empty()) throw std::logic_error(d);
  });
}

// Constants that change between frames, and a span that needs every bit of the pixel index.
TEST(Interpolator, ManyConstantsAndALongSpan) {
  Config c = shipped_config("depth16");
  for (const Perspective mode : all_perspectives) {
    c.perspective = mode;
    Random random(17);
    Rtl rtl(c);
    const auto check = [&](int records, int longest) {
      const InterpolatorCase given = make_interpolator_case(random, c, records, longest);
      rtl.reset();
      EXPECT_GT(compare(c, given, run_rtl(rtl, given.inputs, {random(), 0.1, 0.1}, false)), 0U);
      return given.pixels.size();
    };
    for (int i = 0; i < 20; ++i) check(4, 3);
    // The mode whose reference takes no division.
    if (mode == Perspective::const_depth_rows) {
      while (check(1, (1 << pixel_index_bits(c)) - 1000) <= 1U << (pixel_index_bits(c) - 1)) {
      }
    }
  }
}

// Resets the interpolator after so many clocks amid rows, one count after another. Registers begin at 0, or
// with random values of a seed other than 0. After each reset the rows must be exact, and nothing else may
// come out. Throws std::logic_error where they are not.
void check_resets(const Config& c, int seed, const std::vector<int>& counts) {
  Random random(static_cast<std::uint64_t>(seed));
  const InterpolatorCase given = make_interpolator_case(random, c, 40, 12);
  Rtl rtl(c, seed);
  for (const int clocks : counts) {
    RtlDrive drive{};
    RtlSample sample{};
    std::size_t next = 0;
    for (int i = 0; i < clocks; ++i) {
      drive.in_valid = next < given.inputs.size();
      drive.out_ready = (random() & 3) != 0;
      if (drive.in_valid) drive.in = given.inputs[next];
      rtl.clock(drive, sample);
      if (drive.in_valid && sample.in_ready) ++next;
    }
    if (clocks > 0) rtl.reset();
    const std::string d = first_difference(c, given, run_rtl(rtl, given.inputs, {random(), 0.2, 0.3}, false));
    if (!d.empty()) throw std::logic_error("reset after " + std::to_string(clocks) + " clocks: " + d);
  }
}

TEST(Interpolator, ResetAmidRows) {
  std::vector<Config> configs = {shipped_config("depth16"), shipped_config("narrow")};
  for (const Perspective mode :
       {Perspective::const_depth_rows, Perspective::hyperbolic, Perspective::affine}) {
    configs.push_back(configs.front());
    configs.back().perspective = mode;
  }
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    configs.push_back(random_rtl_config(random));
  }
  for (const Config& c : configs) {
    for (int seed = 0; seed <= 8; ++seed) {
      EXPECT_NO_THROW(check_resets(c, seed, {0, 1, 10, 35, 60, 80, 101, 150})) << "seed " << seed << "\n"
                                                                               << to_toml(c);
      if (HasFailure()) return;
    }
  }
}

bool has_wrong_reset(const Config& c, int seed, const std::vector<int>& counts) {
  try {
    check_resets(c, seed, counts);
  } catch (const std::logic_error&) {
    return true;
  }
  return false;
}

TEST(Interpolator, MissingResetsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/span.sv", "if (!rst_ni) valid_q <= '0;", "if (!rst_ni) valid_q <= valid_q;"},
      {"rtl/span.sv", "if (!rst_ni) active_q <= 1'b0;", "if (!rst_ni) active_q <= active_q;"},
      {"rtl/span_setup.sv", "if (!rst_ni) row_valid_q <= '0;", "if (!rst_ni) row_valid_q <= row_valid_q;"},
      {"rtl/skid.sv", "      out_valid_o <= 1'b0;", "      // not reset"},
  };
  // Random registers show it without a reset amid rows.
  const auto seen_at_random = [](const Config& c) {
    bool seen = false;
    for (int seed = 1; seed <= 8; ++seed) seen = seen || has_wrong_reset(c, seed, {0});
    return seen;
  };
  Config c = shipped_config("narrow");
  expect_seen(bugs, [&] {
    std::vector<int> amid;
    for (int clocks = 30; clocks < 230; clocks += 7) amid.push_back(clocks);
    // And a reset amid rows shows it in registers that began at 0.
    if (seen_at_random(c) && has_wrong_reset(c, 0, amid)) throw std::logic_error("seen both ways");
  });
  // More digits than clocks from a reset to the first product.
  constexpr PlantedBug in_digits[] = {
      {"rtl/mul_digits.sv", "if (!rst_ni) at_q <= '0;", "if (!rst_ni) at_q <= at_q;"},
  };
  c.rtl.product_digits = 8;
  c.rtl.pixel_clocks = 16;
  expect_seen(in_digits, [&] {
    if (seen_at_random(c)) throw std::logic_error("seen");
  });
}

// Throws std::logic_error where the interpolator of this configuration differs from the reference.
void check_values(const Config& c) {
  Random random(21);
  const InterpolatorCase given = make_interpolator_case(random, c, 120, 12);
  Rtl rtl(c);
  const std::string d = first_difference(c, given, run_rtl(rtl, given.inputs, {}, false));
  if (!d.empty()) throw std::logic_error(d);
}

TEST(Interpolator, WrongBitsAreSeenInEveryMode) {
  constexpr const char* setup = "rtl/span_setup.sv";
  constexpr const char* ends = "rtl/row_ends.sv";
  constexpr const char* span = "rtl/span.sv";
  constexpr PlantedBug shades[] = {
      {ends, "left_q[(StartTick-1)/Interval*EndW+:EndW];",
       "left_q[(StartTick-1)/Interval*EndW+:EndW] ^ EndW'(1);"},
      {ends, "EndFrac)) + Offset;", "EndFrac));"},
      {setup, "      res_step,\n      res_start,", "      ~res_step,\n      res_start,"},
      {span, "own[ShadeAccW-1], own});", "own[ShadeAccW-1], own ^ ShadeAccW'(1 << (ShadeAccW - 2))});"},
      {span, "        .Width(OwnSidesW),\n        .From(0),\n        .To(Clocks)",
       "        .Width(OwnSidesW),\n        .From(0),\n        .To(Clocks - 1)"},
      {span, "own[LineAccW-1], own});", "own[LineAccW-1], own ^ LineAccW'(1 << (LineAccW - 2))});"},
      {span, "LineAccFrac[32*Value+:32]", "LineAccFrac[32*Value+:32] - 1"},
  };
  constexpr PlantedBug shades_by_division[] = {
      {"rtl/row_line.sv", "(bitspan_cfg_pkg::LineDivFrac[32*Line+:32])",
       "(bitspan_cfg_pkg::LineDivFrac[32*Line+:32] + ((Line > 2) ? 1 : 0))"},
  };
  constexpr PlantedBug plane_shades[] = {
      {setup, "shade_step1_i[bitspan_cfg_pkg::SidesStepW-1-:OwnStepW]",
       "shade_step0_i[bitspan_cfg_pkg::SidesStepW-1:bitspan_cfg_pkg::SidesStepW-OwnStepW]"},
      {setup, "shade_i[bitspan_cfg_pkg::SidesAccW-1-:OwnAccW]",
       "shade_i[bitspan_cfg_pkg::SidesAccW-1-:OwnAccW] ^ (OwnAccW'(1) << (OwnAccW - 1))"},
      {span, "assign step1 = res_step1[Step1At+:LineStepW];", "assign step1 = res_step0[StepAt+:LineStepW];"},
  };
  constexpr PlantedBug hyperbolic[] = {
      {setup, "assign left_sum = (EdgeSumW'(h_l)", "assign left_sum = (EdgeSumW'(h_r)"},
      {setup, "assign f_left = f_left_q[", "assign f_left = ~f_left_q["},
      {setup, "assign f_start = f_left_q[", "assign f_start = ~f_left_q["},
      {span, ".x_i(quotient),\n          .sticky_i(sticky)", ".x_i(quotient),\n          .sticky_i(1'b0)"},
      {span, "assign divisor = operand_q | (SumW - 1)'(operand_q == '0);", "assign divisor = operand_q;"},
      {span, "if (en) q_q <= q;", "if (en) q_q <= q ^ OutUvW'(1);"},
  };
  constexpr PlantedBug affine[] = {
      {ends, "n_q[(SlopeTick-1)/Interval*(EndW+1)+:EndW+1];",
       "~n_q[(SlopeTick-1)/Interval*(EndW+1)+:EndW+1];"},
      {ends, "left_q[(StartTick-1)/Interval*EndW+:EndW];",
       "left_q[(StartTick-1)/Interval*EndW+:EndW] ^ EndW'(1);"},
  };
  const auto seen = [](Perspective mode, RowSlope form, std::span<const PlantedBug> bugs) {
    Config c = shipped_config("narrow");
    c.fog = FogMode::vertex;
    c.rtl.shades = true;
    c.perspective = mode;
    c.row_slope = form;
    // With signs, ties and divisors that are not positive.
    c.format(FormatId::span_h).is_signed = true;
    c.format(FormatId::setup_b).word -= 14;
    c.format(FormatId::setup_b).integer -= 14;
    c.format(FormatId::span_uv).rounding = Rounding::rnd_conv;
    EXPECT_NO_THROW(check_values(c));
    expect_seen(bugs, [&] { check_values(c); });
  };
  struct Group {
    Perspective mode;
    RowSlope form;
    std::span<const PlantedBug> bugs;
  };
  const Group groups[] = {{Perspective::delta_f, RowSlope::reciprocal, shades},
                          {Perspective::affine, RowSlope::divide, shades_by_division},
                          {Perspective::const_depth_rows, RowSlope::reciprocal, plane_shades},
                          {Perspective::hyperbolic, RowSlope::reciprocal, hyperbolic},
                          {Perspective::affine, RowSlope::reciprocal, affine}};
  for (const auto& [mode, form, bugs] : in_gate(groups)) seen(mode, form, bugs);
}

TEST(Interpolator, AssertionsSpeak) {
  const Config c = shipped_config("depth16");
  Rtl rtl(c);
  RtlDrive drive{};
  drive.in_valid = true;
  drive.in.count = 0;
  RtlSample sample{};
  EXPECT_THROW(rtl.clock(drive, sample), std::logic_error);
}

// An offered record must stay with all its fields, shades among them.
TEST(Interpolator, AChangedOfferIsSeen) {
  Random random(5);
  for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
    Config c = shipped_config("narrow");
    c.rtl.shades = true;
    c.perspective = mode;
    const InterpolatorCase given = make_interpolator_case(random, c, 2, 3);
    Rtl rtl(c);
    RtlDrive drive{.in_valid = true, .out_ready = true, .in = given.inputs[0]};
    RtlSample sample{};
    do rtl.clock(drive, sample);
    while (!sample.in_ready);
    rtl.clock(drive, sample);  // the next one waits for the row interval
    ASSERT_FALSE(sample.in_ready);
    rtl.clock(drive, sample);
    (mode == Perspective::delta_f ? drive.in.shade_r : drive.in.shade_step1).words[0] ^= 1;
    EXPECT_THROW(rtl.clock(drive, sample), std::logic_error);
  }
}

TEST(Interpolator, RefusesAPixelUnitThatIsNotPipelined) {
  Config c = shipped_config("depth16");
  c.pixel_reciprocal.pipelined = false;
  EXPECT_THROW(build_rtl(c), InputError);
}

}  // namespace
}  // namespace bitspan
