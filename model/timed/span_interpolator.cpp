#include "model/timed/span_interpolator.hpp"

#include <stdexcept>
#include <string>

namespace bitspan::timed {

SpanInterpolator::SpanInterpolator(Run& run, Fifo<RowItem*>& in, Fifo<FragmentItem*>& out,
                                   std::vector<HandshakeClock>* handshake)
    : run_(run),
      in_(in),
      out_(out),
      handshake_(handshake),
      latency_(interpolator_latency(run.config)),
      timing_(latency_) {
  span_setup_.report.name = "span_setup";
  span_setup_.report.fifo_capacity = in.capacity();
  span_.report.name = "span";
}

void SpanInterpolator::clock(std::uint64_t now) {
  span_setup_.see_fifo(in_.occupancy(now));
  const bool in_valid = in_.can_pop(now);
  const bool out_ready = out_.can_push(now);
  const InterpolatorClock c = timing_.clock(in_valid, in_valid ? in_.front()->count : 0, out_ready);
  if (handshake_ != nullptr) handshake_->push_back({in_valid, out_ready, c.in_ready, c.out_valid});

  if (c.deliver) {
    out_.push(now) = in_span_.front();
    in_span_.pop();
    ++span_.report.records_out;
  }
  if (c.issue) issue();
  if (c.take) take();
  if (c.accept) {
    accept(in_.front());
    in_.pop(now);
  }

  const bool result_stands = c.res_valid && !c.take;
  const bool holds_one = !latency_.pipelined && c.setup_busy;
  span_setup_.count(c.accept                  ? StageState::busy
                    : result_stands           ? StageState::blocked
                    : (in_valid || holds_one) ? StageState::busy
                                              : StageState::starved);
  const bool pixel_stands = c.out_valid && !out_ready;
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
}

void SpanInterpolator::accept(RowItem* item) {
  const auto& stage = run_.pipeline.span_setup;
  const int divides = run_.pipeline.const_depth_rows
                          ? model::span_setup(stage, item->plane_row, item->geometry, item->span)
                          : model::span_setup(stage, item->row, item->span);
  run_.counters.divides_row += static_cast<std::uint64_t>(divides);
  if (run_.trace != nullptr) run_.trace->span.push_back(item->span);
  in_setup_.push(item);
  ++span_setup_.report.records_in;
}

void SpanInterpolator::take() {
  loaded_ = in_setup_.front();
  in_setup_.pop();
  // The clocks go by the row's pixels, the values by the span's.
  if (loaded_->span.count != loaded_->count) {
    throw std::logic_error("span_setup made " + std::to_string(loaded_->span.count) + " pixels of a row of " +
                           std::to_string(loaded_->count));
  }
  state_ = model::start_span(loaded_->span, run_.pipeline.const_depth_rows ? &loaded_->geometry : nullptr);
  ++span_setup_.report.records_out;
  ++span_.report.records_in;
}

void SpanInterpolator::issue() {
  FragmentItem* item = run_.fragments.get();
  item->texture = loaded_->texture;
  model::span(run_.pipeline.span, state_, item->fragment);
  Counters& counters = run_.counters;
  const auto covered = static_cast<std::uint64_t>(item->fragment.covered);
  ++counters.fragments;
  counters.covered += covered;
  counters.divides_pixel += static_cast<std::uint64_t>(run_.pipeline.span.divides_per_fragment);
  if (run_.pipeline.const_depth_rows) counters.divides_saved += item->fragment.covered;
  if (run_.trace != nullptr) run_.trace->fragment.push_back(item->fragment);
  in_span_.push(item);
  if (model::finished(state_)) {
    run_.rows.put(loaded_);
    loaded_ = nullptr;
  }
}

}  // namespace bitspan::timed
