// SPDX-License-Identifier: Apache-2.0
// The engine `rtl`: the Verilated span interpolator and pixel stages behind the model's setup and walk.
//
// The RTL gives the fields of the span record: all but triangle and the coordinate of the row. It gives x,
// last, h, fu, fv, the reciprocal, u, v and the shades of the fragment record, and its y in const_depth_rows,
// by step_o. The fragments that cover their pixel go on through the pixel stages, and these give every field
// of the later records but triangle. The picture is their memory.
//
// The model takes over where the RTL cannot: shades where rtl.shades is false, the pixel stages of a
// configuration, of a scene or of a draw state that they do not take (rtl_draws_pixels, pixel_rtl_takes), and
// the indices of the texels of a texture that repeats and has a size that is no power of two
// (addresses_texels).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/engine.hpp"
#include "engine/records.hpp"
#include "engine/registry.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Whether depth, texture, fog and merge of a scene are the RTL's, in all its draw states.
bool rtl_draws_pixels(const Config& config, const Scene& scene);

EngineOwn rtl_own(const Config& config, const Scene& scene);

struct RtlOptions {
  // Random gaps of the input and stalls of the output; values do not depend on them.
  std::uint64_t stall_seed = 1;
  double in_gap = 0.1;     // probability per clock
  double out_stall = 0.1;  // probability per clock
};

// Builds the RTL of this configuration, or finds it built (tb/rtl_build.hpp). Throws InputError where the
// configuration has no RTL or a tool is missing. Counters::cycles counts the clocks of the span interpolator,
// stalls included; the pixel stages follow it without throttling it, and their clocks are not counted.
std::unique_ptr<Engine> make_rtl(const Config& config, const RtlOptions& options = {});

}  // namespace bitspan
