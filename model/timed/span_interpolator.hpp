// SPDX-License-Identifier: Apache-2.0
// span_setup and span, timed: one module as in rtl/span_interpolator.sv, whose clocks SpanInterpolatorTiming
// keeps; here the values go with them.
#pragma once

#include <string_view>
#include <vector>

#include "model/timed/run.hpp"
#include "model/timed/span_interpolator_timing.hpp"

namespace bitspan::timed {

class SpanInterpolator : public TimedStage {
 public:
  // `out` null: the owner calls step() instead of clock(). `handshake` null: not recorded.
  SpanInterpolator(Run& run, Fifo<RowItem*>& in, Fifo<FragmentItem*>* out,
                   std::vector<HandshakeClock>* handshake);

  void clock(std::uint64_t now) override {
    if (FragmentItem* item = step(now, out_->can_push(now))) out_->push(now) = item;
  }
  // Where the pixels go from now on; none is inside.
  void set_out(Fifo<FragmentItem*>& out) { out_ = &out; }
  // The pixel that stands at the output; null for none.
  const FragmentItem* waiting() const { return timing_.out_valid() ? in_span_.front() : nullptr; }
  // A clock whose out_ready the caller gives; returns the pixel delivered, or null.
  FragmentItem* step(std::uint64_t now, bool out_ready);
  bool idle() const override { return timing_.idle(); }
  std::vector<StageMeter*> meters() override { return {&span_setup_, &span_}; }
  std::string_view module() const override { return "span_interpolator"; }

 private:
  void accept(RowItem* item);
  void issue();
  void take();

  Run& run_;
  Fifo<RowItem*>& in_;
  Fifo<FragmentItem*>* out_;
  std::vector<HandshakeClock>* handshake_;
  InterpolatorLatency latency_;
  SpanInterpolatorTiming timing_;
  Ring<RowItem*> in_setup_;      // accepted, not yet taken
  RowItem* loaded_ = nullptr;    // taken, with pixels still to issue
  model::SpanState state_;       // of the loaded one
  Ring<FragmentItem*> in_span_;  // issued, not yet delivered
  StageMeter span_setup_, span_;
};

}  // namespace bitspan::timed
