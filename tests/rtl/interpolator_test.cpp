// SPDX-License-Identifier: Apache-2.0
// The Verilated span interpolator against exact rational numbers, over random configurations and records.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "config/rtl_timing.hpp"
#include "tb/rtl_stream.hpp"
#include "tests/rtl/interpolator_case.hpp"
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

// Number of values compared.
std::size_t compare(const Config& c, const InterpolatorCase& expected, const RtlRun& run) {
  EXPECT_EQ(run.spans.size(), expected.spans.size());
  EXPECT_EQ(run.pixels.size(), expected.pixels.size());
  for (std::size_t i = 0; i < run.spans.size(); ++i) {
    const std::string d = difference(span_record(c, run.spans[i]), expected.spans[i]);
    EXPECT_EQ(d, "") << "span " << i << "\n" << to_toml(c);
    if (!d.empty()) return 0;
  }
  for (std::size_t i = 0; i < run.pixels.size(); ++i) {
    const std::string d = difference(fragment_record(c, run.pixels[i]), expected.pixels[i].fragment);
    EXPECT_EQ(d, "") << "pixel " << i << "\n" << to_toml(c);
    EXPECT_EQ(run.pixels[i].step != 0, expected.pixels[i].step) << "pixel " << i << "\n" << to_toml(c);
    if (!d.empty()) return 0;
  }
  return run.spans.size() * 17 + run.pixels.size() * 10;
}

// Clocks of a run without gaps and stalls, from docs/rtl.md alone.
void check_clocks(const Config& c, const InterpolatorCase& given, const RtlRun& run) {
  const RtlTiming t = rtl_timing(c);
  ASSERT_FALSE(run.accepted_at.empty());
  const auto interval = static_cast<std::uint64_t>(t.row.interval);
  EXPECT_EQ(run.taken_at[0], run.accepted_at[0] + static_cast<std::uint64_t>(t.row.latency) + 1);
  // One clock of the buffer at the output.
  const std::uint64_t span = static_cast<std::uint64_t>(t.span) + 1;
  EXPECT_EQ(run.delivered_at[0], run.taken_at[0] + 1 + span);
  std::size_t pixel = 0;
  std::uint64_t least = 0;  // clocks that the rows cost at least
  for (std::size_t i = 0; i < given.inputs.size(); ++i) {
    for (std::uint64_t p = 0; p < given.inputs[i].count; ++p) {
      ASSERT_EQ(run.delivered_at[pixel++], run.taken_at[i] + 1 + p + span) << "span " << i;
    }
    if (i == 0) continue;
    // Rows are accepted every `interval` clocks, but where the FIFO is full; pixels follow without a bubble.
    EXPECT_GE(run.accepted_at[i], run.accepted_at[i - 1] + interval) << "span " << i;
    EXPECT_GE(run.taken_at[i], run.taken_at[i - 1] + given.inputs[i - 1].count) << "span " << i;
    // A FIFO of one record holds span_setup up for a clock after each of them.
    least += std::max(interval + (c.rtl.fifo == 1 ? 1 : 0), given.inputs[i - 1].count);
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
  const int configs = count == nullptr ? 6 : std::atoi(count);
  const std::uint64_t first = seed == nullptr ? 1 : std::strtoull(seed, nullptr, 10);
  for (int i = 0; i < configs; ++i) {
    const std::uint64_t s = first + static_cast<std::uint64_t>(i);
    SCOPED_TRACE("BITSPAN_RTL_CONFIGS=1 BITSPAN_RTL_SEED=" + std::to_string(s));
    Random random(s);
    check_config_on(random, random_rtl_config(random), 200);
    if (HasFailure()) return;
  }
}

TEST(Interpolator, Depth16) {
  Random random(16);
  check_config_on(random, shipped_config("depth16"), 200);
}

// Constants that change between frames, and a span that needs every bit of the pixel index.
TEST(Interpolator, ManyConstantsAndALongSpan) {
  Config c = shipped_config("depth16");
  for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
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

TEST(Interpolator, AssertionsSpeak) {
  const Config c = shipped_config("depth16");
  Rtl rtl(c);
  RtlDrive drive{};
  drive.in_valid = true;
  drive.in.count = 0;
  RtlSample sample{};
  EXPECT_THROW(rtl.clock(drive, sample), std::logic_error);
}

TEST(Interpolator, RefusesModesWithoutRtl) {
  Config c = shipped_config("depth16");
  for (const Perspective p : {Perspective::hyperbolic, Perspective::affine}) {
    c.perspective = p;
    EXPECT_THROW(build_rtl(c), InputError);
  }
}

}  // namespace
}  // namespace bitspan
