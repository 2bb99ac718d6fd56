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

// Every register is a flag or a count that moves, as in rtl/span_setup.sv, fifo.sv, span.sv and skid.sv.
class RegisterReference {
 public:
  explicit RegisterReference(const InterpolatorLatency& l)
      : latency_(l),
        setup_(static_cast<std::size_t>(l.span_setup)),
        pixels_(static_cast<std::size_t>(l.span)) {}

  InterpolatorClock clock(bool in_valid, std::int64_t count, bool out_ready) {
    InterpolatorClock now;
    const bool en_p = skid_ready_;
    const bool issue = loaded_ > 0 && en_p && tick_ == 0;
    const bool res_valid = !fifo_.empty();
    const bool take = res_valid && (loaded_ == 0 || (loaded_ == 1 && issue));
    const bool room = fifo_.size() < static_cast<std::size_t>(latency_.fifo);
    const bool en_s = room || setup_.back() == 0;
    now.in_ready = en_s && phase_ == 0;
    now.out_valid = skid_valid_;
    now.accept = in_valid && now.in_ready;
    now.take = take;
    now.issue = issue;
    now.deliver = skid_valid_ && out_ready;

    // The buffer at the output.
    const bool in = pixels_.back() && skid_ready_;
    if (out_ready || !skid_valid_) {
      skid_valid_ = in || !skid_ready_;
      skid_ready_ = true;
    } else if (in) {
      skid_ready_ = false;
    }
    if (en_p) {
      for (std::size_t i = pixels_.size() - 1; i > 0; --i) pixels_[i] = pixels_[i - 1];
      pixels_[0] = issue;
      tick_ = (tick_ + 1) % latency_.pixel_interval;
    }
    if (issue) --loaded_;
    if (take) {
      loaded_ = fifo_.front();
      fifo_.erase(fifo_.begin());
    }
    if (en_s) {
      if (setup_.back() != 0) fifo_.push_back(setup_.back());
      for (std::size_t i = setup_.size() - 1; i > 0; --i) setup_[i] = setup_[i - 1];
      setup_[0] = now.accept ? count : 0;
      phase_ = (phase_ + 1) % latency_.interval;
    }
    return now;
  }

 private:
  InterpolatorLatency latency_;
  std::vector<std::int64_t> setup_;  // counts; 0: empty
  int phase_ = 0;
  std::vector<std::int64_t> fifo_;
  std::vector<bool> pixels_;
  int tick_ = 0;
  bool skid_ready_ = true, skid_valid_ = false;
  std::int64_t loaded_ = 0;
};

TEST(SpanInterpolatorTiming, EqualsTheRegistersOnEveryClock) {
  std::mt19937 random(11);
  std::uint64_t delivered = 0;
  for (int run = 0; run < 400; ++run) {
    const InterpolatorLatency latency{
        .span_setup = 1 + static_cast<int>(random() % 40),
        .interval = 1 + static_cast<int>(random() % 20),
        .fifo = 1 + static_cast<int>(random() % 4),
        .span = 1 + static_cast<int>(random() % 30),
        .pixel_interval = run % 2 == 0 ? 1 : 1 + static_cast<int>(random() % 9)};
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
                                      .interval = 1 + static_cast<int>(random() % 20),
                                      .fifo = 1 + static_cast<int>(random() % 4),
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
        skipping.skip(rest);
        skipped += rest;
        t += rest;
      }
    }
  }
  EXPECT_GT(skipped, 100000U);
  EXPECT_GT(delivered, 10000U);
}

TEST(SpanInterpolatorTiming, CountsByHand) {
  // LS = 3, LP = 2, spans of 2 pixels, always valid, always ready. Accepted at 0; in the FIFO from 4 on and
  // taken then; pixels issued at 5 and 6, in front of the output's buffer at 7 and 8, and out at 8 and 9. The
  // next span is taken at 6, with the last issue.
  SpanInterpolatorTiming timing({.span_setup = 3, .interval = 1, .span = 2});
  std::vector<int> takes;
  std::vector<int> outs;
  for (int t = 0; t < 20; ++t) {
    const InterpolatorClock c = timing.clock(true, 2, true);
    if (c.take) takes.push_back(t);
    if (c.deliver) outs.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{4, 6, 8, 10, 12, 14, 16, 18}), takes);
  ASSERT_EQ(outs.size(), 12U);
  for (std::size_t i = 0; i < outs.size(); ++i) EXPECT_EQ(outs[i], 8 + static_cast<int>(i));  // no bubble

  // A row every 4 ticks.
  SpanInterpolatorTiming spaced({.span_setup = 3, .interval = 4, .span = 2});
  std::vector<int> accepts;
  for (int t = 0; t < 12; ++t) {
    if (spaced.clock(true, 1, true).accept) accepts.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{0, 4, 8}), accepts);
}

// Rows that come as fast as they are taken cost the longer of their pixels and the interval: nothing is lost.
TEST(SpanInterpolatorTiming, LosesNoClockBesideTheInterval) {
  std::mt19937 random(13);
  for (int run = 0; run < 50; ++run) {
    const InterpolatorLatency latency{.span_setup = 1 + static_cast<int>(random() % 60),
                                      .interval = 1 + static_cast<int>(random() % 20),
                                      .fifo = 2,
                                      .span = 1 + static_cast<int>(random() % 30)};
    SpanInterpolatorTiming timing(latency);
    const unsigned longest = 1U << (1 + random() % 6);
    std::int64_t least = 0;
    std::int64_t clocks = 0;
    int rows = 0;
    std::int64_t count = 1 + static_cast<std::int64_t>(random() % longest);
    for (; rows < 2000 || !timing.idle(); ++clocks) {
      if (!timing.clock(rows < 2000, count, true).accept) continue;
      least += std::max<std::int64_t>(count, latency.interval);
      count = 1 + static_cast<std::int64_t>(random() % longest);
      ++rows;
    }
    EXPECT_LE(clocks, least + least / 100 + latency.span_setup + latency.span + 100) << "run " << run;
  }
}

TEST(SpanInterpolatorTiming, StallsKeepEverythingAndLoseNothing) {
  SpanInterpolatorTiming timing({.span_setup = 5, .interval = 2, .span = 4});
  std::int64_t accepted = 0;
  std::int64_t delivered = 0;
  for (int t = 0; t < 100; ++t) {
    const InterpolatorClock c = timing.clock(true, 3, false);
    accepted += c.accept ? 3 : 0;
    EXPECT_FALSE(c.deliver);
  }
  // Full: pixels at the output and behind it, one span loaded, two in the FIFO, and span_setup's.
  EXPECT_FALSE(timing.clock(true, 3, false).in_ready);
  for (int t = 0; t < 200; ++t) delivered += timing.clock(false, 0, true).deliver ? 1 : 0;
  EXPECT_EQ(delivered, accepted);
  EXPECT_TRUE(timing.idle());
}

TEST(SpanInterpolatorTiming, PixelsAreIssuedOnMultiplesOfTheirInterval) {
  SpanInterpolatorTiming timing({.span_setup = 2, .interval = 1, .span = 6, .pixel_interval = 4});
  std::vector<int> issues;
  for (int t = 0; t < 20; ++t) {
    if (timing.clock(true, 2, true).issue) issues.push_back(t);
  }
  EXPECT_EQ((std::vector<int>{4, 8, 12, 16}), issues);
}

}  // namespace
}  // namespace bitspan
