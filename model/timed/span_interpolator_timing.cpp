// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_interpolator_timing.hpp"

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {

InterpolatorLatency interpolator_latency(const Config& config) {
  Config like_rtl = config;
  like_rtl.pixel_reciprocal.pipelined = true;
  like_rtl.subspan_bits = 0;
  if (has_setup_plane(config)) like_rtl.row_slope = RowSlope::reciprocal;
  RtlTiming rtl = timing_with_dividers(like_rtl);
  if (has_setup_plane(config)) rtl.row = row_schedule_by_plane(config);

  InterpolatorLatency latency;
  latency.span_setup = rtl.row.latency;
  latency.interval = rtl.row.interval;
  latency.fifo = config.rtl.fifo;
  latency.span = rtl.span;
  latency.pixel_interval = rtl.pixel_interval;
  latency.exact = has_rtl(config);
  const bool waits = has_pixel_reciprocal(config.perspective) && !config.pixel_reciprocal.pipelined;
  if (waits) latency.pixel_interval = rtl.pixel_unit;
  return latency;
}

}  // namespace bitspan
