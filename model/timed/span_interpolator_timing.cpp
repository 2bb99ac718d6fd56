// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_interpolator_timing.hpp"

#include "config/rtl_timing.hpp"

namespace bitspan {

InterpolatorLatency interpolator_latency(const Config& config) {
  Config like_rtl = config;
  if (!has_rtl(config)) like_rtl.pixel_reciprocal.pipelined = true;
  const RtlTiming rtl = rtl_timing(like_rtl);

  InterpolatorLatency latency;
  latency.span_setup = rtl.row.latency;
  latency.interval = rtl.row.interval;
  latency.fifo = config.rtl.fifo;
  latency.span = rtl.span;
  latency.pixel_interval = rtl.pixel_interval;
  latency.exact = has_rtl(config);
  if (!latency.exact) latency.pixel_interval = rtl.pixel_unit;
  return latency;
}

}  // namespace bitspan
