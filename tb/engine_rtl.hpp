// The engine `rtl`: the model's pipeline with the Verilated span interpolator in place of span_setup and
// span.
//
// From the RTL come all numbers of the span record but the shades, and of the fragment record x, y, h, fu,
// fv, the reciprocal, u, v and last; shades and covered are the model's. The RTL's position is what the frame
// is written by.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/engine.hpp"

namespace bitspan {

struct RtlOptions {
  // Random gaps of the input and stalls of the output; values do not depend on them.
  std::uint64_t stall_seed = 1;
  double in_gap = 0.1;     // probability, a clock
  double out_stall = 0.1;  // probability, a clock
};

// Builds the RTL of this configuration, or finds it built (tb/rtl_build.hpp). Throws InputError where the
// mode has no RTL or a tool is missing. Counters::cycles counts the RTL's clocks, stalls included.
std::unique_ptr<Engine> make_rtl(const Config& config, const RtlOptions& options = {});

}  // namespace bitspan
