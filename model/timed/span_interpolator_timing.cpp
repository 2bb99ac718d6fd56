// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_interpolator_timing.hpp"

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {

InterpolatorLatency interpolator_latency(const Config& config) {
  Config like_rtl = config;
  if (!has_rtl(config)) like_rtl.perspective = Perspective::delta_f;
  like_rtl.pixel_reciprocal.pipelined = true;
  const RtlTiming rtl = rtl_timing(like_rtl);

  InterpolatorLatency latency;
  latency.span_setup = rtl.row.latency;
  latency.interval = rtl.row.interval;
  latency.fifo = config.rtl.fifo;
  latency.span = has_linear_edges(config.perspective) ? 1 : rtl.span;
  if (has_pixel_reciprocal(config.perspective)) latency.pixel_interval = rtl.pixel_interval;
  const bool pixel_divides =
      has_pixel_reciprocal(config.perspective) || has_pixel_quotients(config.perspective);
  const bool waits_for_pixel_unit = pixel_divides && !config.pixel_reciprocal.pipelined;
  if (waits_for_pixel_unit) latency.pixel_interval = rtl.pixel_unit;
  latency.exact = has_rtl(config) && !waits_for_pixel_unit;
  return latency;
}

}  // namespace bitspan
