// SPDX-License-Identifier: Apache-2.0
// The interpolator's clocks against docs/rtl.md written out register by register, and by hand.
#include "model/timed/span_interpolator_timing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace bitspan {
namespace {

// Every pipeline register is a flag that moves; nothing is counted.
class RegisterReference {
 public:
  explicit RegisterReference(const InterpolatorLatency& l)
      : latency_(l),
        setup_(static_cast<std::size_t>(l.span_setup)),
        pixels_(static_cast<std::size_t>(l.span)) {}

  InterpolatorClock clock(bool in_valid, std::int64_t count, bool out_ready) {
    InterpolatorClock now;
    const bool out_valid = pixels_.back();
    const bool en_p = !(out_valid && !out_ready);
    const bool res_valid = setup_.back() != 0;
    const bool issue = loaded_ > 0 && en_p;
    const bool take = res_valid && (loaded_ == 0 || (loaded_ == 1 && issue));
    const bool en_s = !res_valid || take;
    const bool in_ready = latency_.pipelined ? en_s : !busy_;
    now.in_ready = in_ready;
    now.out_valid = out_valid;
    now.accept = in_valid && in_ready;
    now.take = take;
    now.issue = issue;
    now.deliver = out_valid && out_ready;

    if (en_p) {
      for (std::size_t i = pixels_.size() - 1; i > 0; --i) pixels_[i] = pixels_[i - 1];
      pixels_[0] = issue;
    }
    if (issue) --loaded_;
    if (take) loaded_ = setup_.back();
    if (en_s) {
      for (std::size_t i = setup_.size() - 1; i > 0; --i) setup_[i] = setup_[i - 1];
      setup_[0] = now.accept ? count : 0;
    }
    if (take) busy_ = false;
    if (now.accept) busy_ = true;
    return now;
  }

 private:
  InterpolatorLatency latency_;
  std::vector<std::int64_t> setup_;  // counts; 0: empty
  std::vector<bool> pixels_;
  std::int64_t loaded_ = 0;
  bool busy_ = false;
};

TEST(SpanInterpolatorTiming, EqualsTheRegistersOnEveryClock) {
  std::mt19937 random(11);
  std::uint64_t delivered = 0;
  for (int run = 0; run < 400; ++run) {
    const InterpolatorLatency latency{.span_setup = 1 + static_cast<int>(random() % 40),
                                      .pipelined = random() % 2 == 0,
                                      .span = 1 + static_cast<int>(random() % 30)};
    SpanInterpolatorTiming timing(latency);
    RegisterReference reference(latency);
    const auto gap = random() % 5;    // 0: always valid
    const auto stall = random() % 5;  // 0: always ready
    const unsigned longest = 1U << (random() % 7);
    std::int64_t count = 1;
    for (int t = 0; t < 2000; ++t) {
      const bool in_valid = gap == 0 || random() % (gap + 1) == 0;
      const bool out_ready = stall == 0 || random() % (stall + 1) == 0;
      const InterpolatorClock a = timing.clock(in_valid, count, out_ready);
      const InterpolatorClock b = reference.clock(in_valid, count, out_ready);
      ASSERT_EQ(a.in_ready, b.in_ready) << "run " << run << " clock " << t;
      ASSERT_EQ(a.out_valid, b.out_valid) << "run " << run << " clock " << t;
      ASSERT_EQ(a.take, b.take) << "run " << run << " clock " << t;
      ASSERT_EQ(a.issue, b.issue) << "run " << run << " clock " << t;
      delivered += a.deliver ? 1 : 0;
      if (a.accept) count = 1 + static_cast<std::int64_t>(random() % longest);
    }
  }
  EXPECT_GT(delivered, 50000U);
}

// Skipping what rest() promises leaves the same state as clocking it, and on those clocks nothing happens.
TEST(SpanInterpolatorTiming, RestsAreClocksWithoutMovement) {
  std::mt19937 random(12);
  std::uint64_t skipped = 0;
  std::uint64_t delivered = 0;
  for (int run = 0; run < 400; ++run) {
    const InterpolatorLatency latency{.span_setup = 1 + static_cast<int>(random() % 40),
                                      .pipelined = random() % 2 == 0,
                                      .span = 1 + static_cast<int>(random() % 30),
                                      .pixel_interval = 1 + static_cast<int>(random() % 5)};
    SpanInterpolatorTiming skipping(latency);
    SpanInterpolatorTiming clocking(latency);
    const unsigned longest = 1U << (random() % 4);
    std::int64_t count = 1;
    std::uint64_t t = 0;
    while (t < 2000) {
      // As they stay for a while.
      const bool in_valid = random() % 2 == 0;
      const bool out_ready = random() % 2 == 0;
      const std::uint64_t until = t + 1 + random() % 60;
      while (t < until) {
        const InterpolatorClock a = skipping.clock(in_valid, count, out_ready);
        const InterpolatorClock b = clocking.clock(in_valid, count, out_ready);
        ++t;
        ASSERT_EQ(a.accept, b.accept) << "run " << run << " clock " << t;
        ASSERT_EQ(a.take, b.take) << "run " << run << " clock " << t;
        ASSERT_EQ(a.issue, b.issue) << "run " << run << " clock " << t;
        ASSERT_EQ(a.deliver, b.deliver) << "run " << run << " clock " << t;
        ASSERT_EQ(a.in_ready, b.in_ready) << "run " << run << " clock " << t;
        ASSERT_EQ(a.out_valid, b.out_valid) << "run " << run << " clock " << t;
        ASSERT_EQ(a.res_valid, b.res_valid) << "run " << run << " clock " << t;
        delivered += a.deliver ? 1 : 0;
        if (a.accept) count = 1 + static_cast<std::int64_t>(random() % longest);
        const std::uint64_t rest = std::min(skipping.rest(in_valid, out_ready), until - t);
        for (std::uint64_t i = 0; i < rest; ++i) {
          const InterpolatorClock c = clocking.clock(in_valid, count, out_ready);
          ASSERT_FALSE(c.accept || c.take || c.issue || c.deliver) << "run " << run << " clock " << t + i;
          ASSERT_EQ(c.out_valid, skipping.out_valid()) << "run " << run << " clock " << t + i;
          ASSERT_EQ(c.res_valid, skipping.res_valid()) << "run " << run << " clock " << t + i;
        }
        skipping.skip(rest, out_ready);
        skipped += rest;
        t += rest;
      }
    }
  }
  EXPECT_GT(skipped, 100000U);
  EXPECT_GT(delivered, 10000U);
}

TEST(SpanInterpolatorTiming, CountsByHand) {
  // LS = 3, LP = 2, spans of 2 pixels, always valid, always ready: accepted at 0; result at 3, taken at 3;
  // pixels issued at 4 and 5 and out at 6 and 7; the next span is taken at 5, with the last issue.
  SpanInterpolatorTiming timing({.span_setup = 3, .pipelined = true, .span = 2});
  std::vector<int> takes;
  std::vector<int> outs;
  for (int t = 0; t < 20; ++t) {
    const InterpolatorClock c = timing.clock(true, 2, true);
    if (c.take) takes.push_back(t);
    if (c.deliver) outs.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{3, 5, 7, 9, 11, 13, 15, 17, 19}), takes);
  ASSERT_EQ(outs.size(), 14U);
  for (std::size_t i = 0; i < outs.size(); ++i) EXPECT_EQ(outs[i], 6 + static_cast<int>(i));  // no bubble

  // Not pipelined: the next record goes in on the clock after the take, so a span each LS + 1 clocks.
  SpanInterpolatorTiming alone({.span_setup = 3, .pipelined = false, .span = 2});
  std::vector<int> accepts;
  for (int t = 0; t < 12; ++t) {
    if (alone.clock(true, 1, true).accept) accepts.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{0, 4, 8}), accepts);
}

TEST(SpanInterpolatorTiming, StallsKeepEverythingAndLoseNothing) {
  SpanInterpolatorTiming timing({.span_setup = 5, .pipelined = true, .span = 4});
  std::int64_t accepted = 0;
  std::int64_t delivered = 0;
  for (int t = 0; t < 100; ++t) {
    const InterpolatorClock c = timing.clock(true, 3, false);
    accepted += c.accept ? 3 : 0;
    EXPECT_FALSE(c.deliver);
  }
  // Full: pixels at the output and behind it, one span loaded, span_setup's five registers.
  EXPECT_FALSE(timing.clock(true, 3, false).in_ready);
  for (int t = 0; t < 200; ++t) delivered += timing.clock(false, 0, true).deliver ? 1 : 0;
  EXPECT_EQ(delivered, accepted);
  EXPECT_TRUE(timing.idle());
}

TEST(SpanInterpolatorTiming, APixelUnitThatIsNotPipelinedSpacesTheIssues) {
  SpanInterpolatorTiming timing({.span_setup = 2, .pipelined = true, .span = 6, .pixel_interval = 4});
  std::vector<int> issues;
  for (int t = 0; t < 20; ++t) {
    if (timing.clock(true, 2, true).issue) issues.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{3, 7, 11, 15, 19}), issues);
}

}  // namespace
}  // namespace bitspan
