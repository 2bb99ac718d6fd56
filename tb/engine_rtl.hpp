// SPDX-License-Identifier: Apache-2.0
// The engine `rtl`: the model's pipeline with the Verilated span interpolator in place of span_setup and
// span.
//
// The RTL gives 17 fields of the span record: all but triangle, the shades and the coordinate of the row. It
// gives x, last, h, fu, fv, the reciprocal, u and v of the fragment record, and its y in const_depth_rows, by
// step_o. The model gives everything else. The frame is written at the RTL's position.
#pragma once

#include <cstdint>
#include <memory>

#include "config/modes.hpp"
#include "engine/engine.hpp"
#include "tb/rtl_abi.hpp"

namespace bitspan {

// How many fields of a record are read from the RTL's ports.
#define BITSPAN_COUNT_PORT(name) +1
inline constexpr std::uint64_t rtl_span_fields = 0 BITSPAN_RTL_SPAN(BITSPAN_COUNT_PORT);
// In delta_f step_o is always 0, and a fragment's y is its row's.
inline std::uint64_t rtl_fragment_fields(const Config& config) {
  constexpr std::uint64_t ports = 0 BITSPAN_RTL_PIXEL(BITSPAN_COUNT_PORT);
  return has_plane_rows(config.perspective) ? ports : ports - 1;
}
#undef BITSPAN_COUNT_PORT

struct RtlOptions {
  // Random gaps of the input and stalls of the output; values do not depend on them.
  std::uint64_t stall_seed = 1;
  double in_gap = 0.1;     // probability per clock
  double out_stall = 0.1;  // probability per clock
};

// Builds the RTL of this configuration, or finds it built (tb/rtl_build.hpp). Throws InputError where the
// mode has no RTL or a tool is missing. Counters::cycles counts the RTL's clocks, stalls included.
std::unique_ptr<Engine> make_rtl(const Config& config, const RtlOptions& options = {});

}  // namespace bitspan
