#include "model/timed/span_interpolator_timing.hpp"

#include "config/rtl_timing.hpp"

namespace bitspan {

InterpolatorLatency interpolator_latency(const Config& config) {
  Config like_rtl = config;
  if (!has_rtl(config)) like_rtl.perspective = Perspective::delta_f;
  like_rtl.pixel_reciprocal.pipelined = true;
  const RtlTiming rtl = rtl_timing(like_rtl);

  InterpolatorLatency latency;
  latency.span_setup = rtl.span_setup;
  latency.pipelined = rtl.row_unit_pipelined;
  latency.span = config.perspective == Perspective::affine ? 1 : rtl.span;
  const bool pixel_divides =
      config.perspective == Perspective::delta_f || config.perspective == Perspective::hyperbolic;
  const bool waits_for_pixel_unit = pixel_divides && !config.pixel_reciprocal.pipelined;
  if (waits_for_pixel_unit) latency.pixel_interval = rtl.pixel_unit;
  latency.exact = has_rtl(config) && !waits_for_pixel_unit;
  return latency;
}

SpanInterpolatorTiming::SpanInterpolatorTiming(const InterpolatorLatency& latency) : latency_(latency) {}

InterpolatorClock SpanInterpolatorTiming::clock(bool in_valid, std::int64_t count, bool out_ready) {
  InterpolatorClock now;
  now.out_valid = !pixels_.empty() && pixels_.front() == pixel_ticks_;
  const bool en_p = !now.out_valid || out_ready;
  now.deliver = now.out_valid && out_ready;
  now.issue = active_ && en_p && pixel_ticks_ >= next_issue_tick_;
  const bool issues_last = now.issue && remaining_ == 1;

  now.res_valid = !setup_.empty() && setup_ticks_ >= setup_.front().due;
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

}  // namespace bitspan
