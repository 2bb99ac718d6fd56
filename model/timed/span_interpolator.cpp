// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_interpolator.hpp"

#include "model/timed/span_values.hpp"

namespace bitspan::timed {

SpanInterpolator::SpanInterpolator(Run& run, Fifo<RowItem*>& in, Fifo<FragmentItem*>* out,
                                   std::vector<HandshakeClock>* handshake)
    : run_(run),
      in_(in),
      out_(out),
      handshake_(handshake),
      latency_(interpolator_latency(run.config)),
      timing_(latency_) {
  span_setup_.report.name = to_string(Stage::span_setup);
  span_setup_.report.fifo_capacity = in.capacity();
  span_.report.name = to_string(Stage::span);
}

FragmentItem* SpanInterpolator::step(std::uint64_t now, bool out_ready) {
  span_setup_.see_fifo(in_.occupancy(now));
  const bool in_valid = in_.can_pop(now);
  const InterpolatorClock c = timing_.clock(in_valid, in_valid ? in_.front()->count : 0, out_ready);
  if (handshake_ != nullptr) handshake_->push_back({in_valid, out_ready, c.in_ready, c.out_valid});

  FragmentItem* delivered = nullptr;
  if (c.deliver) {
    delivered = in_span_.front();
    in_span_.pop();
    ++span_.report.records_out;
  }
  if (c.issue) issue();
  if (c.take) take();
  if (c.accept) {
    accept(in_.front());
    in_.pop(now);
  }

  span_setup_.count(c.accept                                              ? StageState::busy
                    : c.setup_held                                        ? StageState::blocked
                    : in_valid || (latency_.interval > 1 && c.setup_busy) ? StageState::busy
                                                                          : StageState::starved);
  const bool pixel_stands = c.span_held || (c.out_valid && !out_ready);
  span_.count(c.issue        ? StageState::busy
              : pixel_stands ? StageState::blocked
              : c.active     ? StageState::busy
                             : StageState::starved);
  if (c.accept || c.take) ++span_setup_.moves;
  if (c.issue || c.deliver) ++span_.moves;

  const unsigned occupancy = span_setup_.signals.occupancy;
  const unsigned setup_state = span_setup_.signals.state;
  span_setup_.signals = {in_valid, c.in_ready, c.res_valid, c.take, occupancy, setup_state};
  const unsigned span_state = span_.signals.state;
  span_.signals = {c.res_valid, c.take, c.out_valid, out_ready, c.res_valid ? 1U : 0U, span_state};
  return delivered;
}

void SpanInterpolator::accept(RowItem* item) {
  span_setup_values(run_, *item);
  in_setup_.push(item);
  ++span_setup_.report.records_in;
}

void SpanInterpolator::take() {
  loaded_ = in_setup_.front();
  in_setup_.pop();
  state_ = model::start_span(loaded_->span, geometry_of(run_, *loaded_));
  ++span_setup_.report.records_out;
  ++span_.report.records_in;
}

void SpanInterpolator::issue() {
  FragmentItem* item = run_.fragments.get();
  span_values(run_, *loaded_, state_, *item);
  in_span_.push(item);
  if (model::finished(state_)) {
    run_.rows.put(loaded_);
    loaded_ = nullptr;
  }
}

}  // namespace bitspan::timed
