// SPDX-License-Identifier: Apache-2.0
// Compiled together with one Verilated span interpolator into a shared library; see rtl_build.cpp.
#include <type_traits>

#include "Vspan_interpolator.h"

// The compiler finds them by their folder: this file is not part of the project's own build.
#include "rtl_abi.hpp"
#include "rtl_harness.hpp"

using Rtl = Simulation<Vspan_interpolator>;

namespace {

// A port of shades is an integer of its width, or beyond 64 bits words of 32.
template <class Port>
void drive_shades(Port& port, const bitspan::RtlShades& shades) {
  if constexpr (std::is_integral_v<Port>) {
    port = static_cast<Port>(shades.words[0]);
  } else {
    for (unsigned i = 0; i < sizeof(Port) / 4; ++i)
      port[i] = static_cast<std::uint32_t>(shades.words[i / 2] >> (i % 2 * 32));
  }
}
template <class Port>
void sample_shades(const Port& port, bitspan::RtlShades& shades) {
  shades = {};
  if constexpr (std::is_integral_v<Port>) {
    shades.words[0] = port;
  } else {
    for (unsigned i = 0; i < sizeof(Port) / 4; ++i)
      shades.words[i / 2] |= static_cast<std::uint64_t>(port[i]) << (i % 2 * 32);
  }
}

}  // namespace

BITSPAN_EXPORT void* bitspan_rtl_create(int seed) { return new Rtl(seed); }
BITSPAN_EXPORT void bitspan_rtl_destroy(void* rtl) { destroy<Rtl>(rtl); }

BITSPAN_EXPORT const char* bitspan_rtl_reset(void* handle) {
  return guarded<Rtl>(handle, [](Rtl& rtl) {
    rtl.top.in_valid_i = 0;
    rtl.top.out_ready_i = 0;
    rtl.reset();
  });
}

BITSPAN_EXPORT const char* bitspan_rtl_clock(void* handle, const bitspan::RtlDrive* drive,
                                             bitspan::RtlSample* sample) {
  return guarded<Rtl>(handle, [drive, sample](Rtl& rtl) {
    Vspan_interpolator& top = rtl.top;
    top.in_valid_i = drive->in_valid;
    top.out_ready_i = drive->out_ready;
#define BITSPAN_DRIVE(name) top.name##_i = static_cast<decltype(top.name##_i + 0)>(drive->in.name);
    BITSPAN_RTL_INPUTS(BITSPAN_DRIVE)
#define BITSPAN_DRIVE_SHADES(name) drive_shades(top.name##_i, drive->in.name);
    BITSPAN_RTL_INPUT_SHADES(BITSPAN_DRIVE_SHADES)
    top.eval();
    sample->in_ready = top.in_ready_o;
    sample->out_valid = top.out_valid_o;
    sample->span_take = top.span_take_o;
    if (sample->out_valid) {
#define BITSPAN_PIXEL(name) sample->pixel.name = top.name##_o;
      BITSPAN_RTL_PIXEL(BITSPAN_PIXEL)
#define BITSPAN_PIXEL_SHADES(name) sample_shades(top.name##_o, sample->pixel.name);
      BITSPAN_RTL_PIXEL_SHADES(BITSPAN_PIXEL_SHADES)
    }
    if (sample->span_take) {
#define BITSPAN_SPAN(name) sample->span.name = top.span_##name##_o;
      BITSPAN_RTL_SPAN(BITSPAN_SPAN)
#define BITSPAN_SPAN_SHADES(name) sample_shades(top.span_##name##_o, sample->span.name);
      BITSPAN_RTL_SPAN_SHADES(BITSPAN_SPAN_SHADES)
    }
    rtl.edge();
  });
}
