// SPDX-License-Identifier: Apache-2.0
// The clocks of the span interpolator (span_setup followed by span), one call per clock, without values.
//
// docs/rtl.md, "Clocks", is the contract: given the same in_valid, counts and out_ready, in_ready and
// out_valid equal the RTL's on every clock. No SystemC here; the timed model wraps it, tests run it alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "config/config.hpp"
#include "model/timed/ring.hpp"

namespace bitspan {

struct InterpolatorLatency {
  int span_setup = 1;      // LS: clocks from acceptance to the result register, >= 1
  bool pipelined = true;   // span_setup accepts a record each clock; else holds one until it is taken
  int span = 1;            // LP: clocks from issue to output, >= 1
  int pixel_interval = 1;  // clocks from one pixel's issue to the next, >= 1; 1 wherever there is RTL
  bool exact = true;       // the RTL has these numbers; else an estimate (docs/timing.md)
};

// rtl_timing's numbers where the configuration has RTL. hyperbolic counts as delta_f does (its two divides
// run side by side); affine has delta_f's span_setup and a span of one clock; a pixel unit that is not
// pipelined issues a pixel each latency of that unit.
InterpolatorLatency interpolator_latency(const Config& config);

// What happened on one clock; a transfer is valid and ready both 1.
struct InterpolatorClock {
  bool in_ready = false;
  bool out_valid = false;
  bool accept = false;      // transfer in: a span entered span_setup
  bool take = false;        // span loaded the span in the result register
  bool issue = false;       // a pixel of the loaded span entered span's pipeline
  bool deliver = false;     // transfer out: a pixel left
  bool res_valid = false;   // the result register held a span
  bool setup_busy = false;  // a span was inside span_setup
  bool active = false;      // span had a span loaded
};

class SpanInterpolatorTiming {
 public:
  explicit SpanInterpolatorTiming(const InterpolatorLatency& latency) : latency_(latency) {}

  // One rising edge. `count` is the number of pixels (>= 1) of the span offered, read where it is accepted.
  InterpolatorClock clock(bool in_valid, std::int64_t count, bool out_ready);
  // What the next clock will see of them.
  bool out_valid() const { return !pixels_.empty() && pixels_.front() == pixel_ticks_; }
  bool res_valid() const { return !setup_.empty() && setup_ticks_ >= setup_.front().due; }
  bool setup_busy() const { return !setup_.empty(); }
  bool active() const { return active_; }
  // How many clocks from the next one on are like it and move nothing (no accept, take, issue, deliver), as
  // long as in_valid and out_ready stay as given; `never` where only these can end that.
  std::uint64_t rest(bool in_valid, bool out_ready) const;
  // Lets so many of these clocks pass.
  void skip(std::uint64_t clocks, bool out_ready);
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

  // Nothing inside: no span and no pixel.
  bool idle() const { return setup_.empty() && !active_ && pixels_.empty(); }

 private:
  struct SetupEntry {
    std::uint64_t due = 0;  // setup_ticks_ at which it stands in the result register
    std::int64_t count = 0;
  };

  InterpolatorLatency latency_;
  // Every stage of a pipeline shifts together, so a record's place is the number of shifts since it entered.
  timed::Ring<SetupEntry> setup_;
  std::uint64_t setup_ticks_ = 0;      // shifts of span_setup; clocks where it is not pipelined
  timed::Ring<std::uint64_t> pixels_;  // pixel_ticks_ at which each pixel in flight is at the output
  std::uint64_t pixel_ticks_ = 0;      // shifts of span
  bool active_ = false;
  std::int64_t remaining_ = 0;         // pixels of the loaded span still to issue
  std::uint64_t next_issue_tick_ = 0;  // pixel_ticks_ from which the next pixel may be issued
};

inline InterpolatorClock SpanInterpolatorTiming::clock(bool in_valid, std::int64_t count, bool out_ready) {
  InterpolatorClock now;
  now.out_valid = out_valid();
  const bool en_p = !now.out_valid || out_ready;
  now.deliver = now.out_valid && out_ready;
  now.issue = active_ && en_p && pixel_ticks_ >= next_issue_tick_;
  const bool issues_last = now.issue && remaining_ == 1;

  now.res_valid = res_valid();
  now.take = now.res_valid && (!active_ || issues_last);
  const bool en_s = !now.res_valid || now.take;
  now.in_ready = latency_.pipelined ? en_s : setup_.empty();
  now.accept = in_valid && now.in_ready;
  now.setup_busy = !setup_.empty();
  now.active = active_;

  // The edge itself.
  if (now.deliver) pixels_.pop();
  if (now.issue) {
    pixels_.push(pixel_ticks_ + static_cast<std::uint64_t>(latency_.span));
    next_issue_tick_ = pixel_ticks_ + static_cast<std::uint64_t>(latency_.pixel_interval);
    if (--remaining_ == 0) active_ = false;
  }
  if (en_p) ++pixel_ticks_;
  if (now.take) {
    active_ = true;
    remaining_ = setup_.front().count;
    setup_.pop();
  }
  if (now.accept) setup_.push({setup_ticks_ + static_cast<std::uint64_t>(latency_.span_setup), count});
  if (en_s || !latency_.pipelined) ++setup_ticks_;
  return now;
}

inline std::uint64_t SpanInterpolatorTiming::rest(bool in_valid, bool out_ready) const {
  const bool stands = out_valid();
  if (stands && out_ready) return 0;
  const bool result = res_valid();
  const bool in_ready = latency_.pipelined ? !result : setup_.empty();
  if ((result && !active_) || (in_valid && in_ready)) return 0;
  std::uint64_t clocks = never;
  if (!stands && active_) {
    if (pixel_ticks_ >= next_issue_tick_) return 0;
    clocks = next_issue_tick_ - pixel_ticks_;
  }
  if (!stands && !pixels_.empty()) clocks = std::min(clocks, pixels_.front() - pixel_ticks_);
  if (!result && !setup_.empty()) clocks = std::min(clocks, setup_.front().due - setup_ticks_);
  return clocks;
}

inline void SpanInterpolatorTiming::skip(std::uint64_t clocks, bool out_ready) {
  if (!out_valid() || out_ready) pixel_ticks_ += clocks;
  if (!latency_.pipelined || !res_valid()) setup_ticks_ += clocks;
}

}  // namespace bitspan
