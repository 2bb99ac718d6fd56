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
  int span_setup = 1;      // LS: ticks from acceptance to the span record, >= 1
  int interval = 1;        // ticks from one acceptance to the next, >= 1
  int fifo = 2;            // span records that fit between span_setup and span
  int span = 1;            // LP: clocks from issue to the buffer at the output, >= 1
  int pixel_interval = 1;  // clocks from one pixel's issue to the next, >= 1
  bool exact = true;       // the RTL has these numbers; else an estimate (docs/timing.md)
};

// rtl_timing's numbers where the configuration has RTL. Where its pixel unit is not pipelined, a pixel is
// issued each latency of that unit.
InterpolatorLatency interpolator_latency(const Config& config);

// What happened on one clock; a transfer is valid and ready both 1.
struct InterpolatorClock {
  bool in_ready = false;
  bool out_valid = false;
  bool accept = false;      // transfer in: a span entered span_setup
  bool take = false;        // span loaded the first span record of the FIFO
  bool issue = false;       // a pixel of the loaded span entered span's pipeline
  bool deliver = false;     // transfer out: a pixel left
  bool res_valid = false;   // a span record was there for span to take
  bool span_held = false;   // span stood still: the buffer at its output was full
  bool setup_held = false;  // span_setup stood still: its span record met a full FIFO
  bool setup_busy = false;  // a span was inside span_setup
  bool active = false;      // span had a span loaded
};

class SpanInterpolatorTiming {
 public:
  explicit SpanInterpolatorTiming(const InterpolatorLatency& latency) : latency_(latency) {}

  // One rising edge. `count` is the number of pixels (>= 1) of the span offered, read where it is accepted.
  InterpolatorClock clock(bool in_valid, std::int64_t count, bool out_ready);
  // What the next clock will see of them.
  bool out_valid() const { return out_ != 0; }
  bool res_valid() const { return !records_.empty(); }
  bool setup_held() const {
    return !setup_.empty() && setup_.front().due == setup_ticks_ &&
           records_.size() == static_cast<std::size_t>(latency_.fifo);
  }
  bool span_held() const { return out_ == out_room; }
  bool setup_busy() const { return !setup_.empty(); }
  bool active() const { return active_; }
  // How many clocks from the next one on are like it and move nothing (no accept, take, issue, deliver), as
  // long as in_valid and out_ready stay as given; `never` where only these can end that.
  std::uint64_t rest(bool in_valid, bool out_ready) const;
  // Lets so many of these clocks pass.
  void skip(std::uint64_t clocks);
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

  // Nothing inside: no span and no pixel.
  bool idle() const { return setup_.empty() && records_.empty() && !active_ && pixels_.empty() && out_ == 0; }

 private:
  struct SetupEntry {
    std::uint64_t due = 0;  // setup_ticks_ at which its span record goes to the FIFO
    std::int64_t count = 0;
  };
  static constexpr int out_room = 2;  // pixels in the buffer at the output

  bool accepts() const {
    return !setup_held() && setup_ticks_ % static_cast<std::uint64_t>(latency_.interval) == 0;
  }
  // A pixel is issued on shifts that are multiples of the interval.
  std::uint64_t ticks_to_issue() const {
    const auto interval = static_cast<std::uint64_t>(latency_.pixel_interval);
    return (interval - pixel_ticks_ % interval) % interval;
  }

  InterpolatorLatency latency_;
  // Every stage of a pipeline shifts together, so a record's place is the number of shifts since it entered.
  timed::Ring<SetupEntry> setup_;
  std::uint64_t setup_ticks_ = 0;      // shifts of span_setup
  timed::Ring<std::int64_t> records_;  // counts of the span records in the FIFO
  timed::Ring<std::uint64_t>
      pixels_;                     // pixel_ticks_ at which each pixel in flight goes to the output's buffer
  std::uint64_t pixel_ticks_ = 0;  // shifts of span
  int out_ = 0;                    // pixels in the buffer at the output
  bool active_ = false;
  std::int64_t remaining_ = 0;  // pixels of the loaded span still to issue
};

inline InterpolatorClock SpanInterpolatorTiming::clock(bool in_valid, std::int64_t count, bool out_ready) {
  InterpolatorClock now;
  now.out_valid = out_valid();
  now.span_held = span_held();
  const bool en_p = !now.span_held;
  now.deliver = now.out_valid && out_ready;
  now.issue = active_ && en_p && ticks_to_issue() == 0;
  const bool issues_last = now.issue && remaining_ == 1;
  const bool arrives = en_p && !pixels_.empty() && pixels_.front() == pixel_ticks_;

  now.res_valid = res_valid();
  now.take = now.res_valid && (!active_ || issues_last);
  now.setup_held = setup_held();
  const bool formed = !now.setup_held && !setup_.empty() && setup_.front().due == setup_ticks_;
  now.in_ready = accepts();
  now.accept = in_valid && now.in_ready;
  now.setup_busy = !setup_.empty();
  now.active = active_;

  // The edge itself.
  out_ += (arrives ? 1 : 0) - (now.deliver ? 1 : 0);
  if (arrives) pixels_.pop();
  if (now.issue) {
    pixels_.push(pixel_ticks_ + static_cast<std::uint64_t>(latency_.span));
    if (--remaining_ == 0) active_ = false;
  }
  if (en_p) ++pixel_ticks_;
  if (now.take) {
    active_ = true;
    remaining_ = records_.front();
    records_.pop();
  }
  if (formed) {
    records_.push(setup_.front().count);
    setup_.pop();
  }
  if (now.accept) setup_.push({setup_ticks_ + static_cast<std::uint64_t>(latency_.span_setup), count});
  if (!now.setup_held) ++setup_ticks_;
  return now;
}

inline std::uint64_t SpanInterpolatorTiming::rest(bool in_valid, bool out_ready) const {
  if (out_valid() && out_ready) return 0;
  if (res_valid() && !active_) return 0;
  std::uint64_t clocks = never;
  if (!setup_held()) {
    if (in_valid) {
      const auto interval = static_cast<std::uint64_t>(latency_.interval);
      clocks = (interval - setup_ticks_ % interval) % interval;
    }
    if (!setup_.empty()) clocks = std::min(clocks, setup_.front().due - setup_ticks_);
  }
  if (!span_held()) {
    if (active_) clocks = std::min(clocks, ticks_to_issue());
    if (!pixels_.empty()) clocks = std::min(clocks, pixels_.front() - pixel_ticks_);
  }
  return clocks;
}

inline void SpanInterpolatorTiming::skip(std::uint64_t clocks) {
  if (!span_held()) pixel_ticks_ += clocks;
  if (!setup_held()) setup_ticks_ += clocks;
}

}  // namespace bitspan
