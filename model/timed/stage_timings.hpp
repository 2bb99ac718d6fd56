// SPDX-License-Identifier: Apache-2.0
// The latency, the interval and the FIFO of each stage that the timed model runs with cache and bus.
#pragma once

#include <array>

#include "config/config.hpp"

namespace bitspan::timed {

// As configured for setup and the walk. Latency and interval of depth, texture, fog and merge are those of
// the RTL with an ideal memory: config/pixel_timing. Where a stage takes an R_pixel that is not pipelined it
// has no RTL; then it takes a fragment per latency of that unit. span_setup and span have clocks of their own
// (span_interpolator_timing), and only the FIFO in front of span_setup counts.
std::array<StageTiming, stage_count> stage_timings(const Config& config);

}  // namespace bitspan::timed
