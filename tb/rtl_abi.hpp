// SPDX-License-Identifier: Apache-2.0
// What crosses the border between bitspan and a Verilated span interpolator: plain C structs of raw port
// values.
//
// The ports are those of rtl/span_interpolator.sv, by name. A value is the port's bits, zero-extended;
// tb/rtl_build handles the signs. Both sides are compiled from this header, whose text is part of the cache's
// key.
#pragma once

#include <cstdint>

namespace bitspan {

// Inputs: b; the record's first pixel and count; then the row's ends, then those of const_depth_rows. The
// ports of the second lists hold four shades side by side, and above them the channels.
// clang-format off
#define BITSPAN_RTL_INPUTS(X)                                       \
  X(b) X(x_first) X(count)                                          \
  X(x_l) X(x_r) X(h_l) X(h_r) X(u_l) X(u_r) X(v_l) X(v_r)           \
  X(phase) X(k) X(h) X(gu) X(gv)                                    \
  X(gu_step0) X(gu_step1) X(gv_step0) X(gv_step1)
#define BITSPAN_RTL_INPUT_SHADES(X) \
  X(shade_l) X(shade_r) X(shade) X(shade_step0) X(shade_step1)
#define BITSPAN_RTL_PIXEL(X) \
  X(x) X(step) X(last) X(h) X(fu) X(fv) X(recip_m) X(recip_e) X(u) X(v)
#define BITSPAN_RTL_PIXEL_SHADES(X) X(shade)
#define BITSPAN_RTL_SPAN(X)                                         \
  X(x) X(count) X(recip_m) X(recip_e) X(phase) X(fu_diff) X(fv_diff) \
  X(h) X(h_step) X(u1) X(v1) X(fu) X(fv)                            \
  X(fu_step0) X(fu_step1) X(fv_step0) X(fv_step1)
#define BITSPAN_RTL_SPAN_SHADES(X) X(shade) X(shade_step0) X(shade_step1)
// clang-format on

// The bits of a port of shades, the lowest ones in word 0. The port's width says how many there are.
struct RtlShades {
  std::uint64_t words[32];
};

#define BITSPAN_RTL_MEMBER(name) std::uint64_t name;
#define BITSPAN_RTL_SHADES_MEMBER(name) RtlShades name;
struct RtlInputs {
  BITSPAN_RTL_INPUTS(BITSPAN_RTL_MEMBER)
  BITSPAN_RTL_INPUT_SHADES(BITSPAN_RTL_SHADES_MEMBER)
};
struct RtlPixel {
  BITSPAN_RTL_PIXEL(BITSPAN_RTL_MEMBER)
  BITSPAN_RTL_PIXEL_SHADES(BITSPAN_RTL_SHADES_MEMBER)
};
struct RtlSpan {
  BITSPAN_RTL_SPAN(BITSPAN_RTL_MEMBER)
  BITSPAN_RTL_SPAN_SHADES(BITSPAN_RTL_SHADES_MEMBER)
};
#undef BITSPAN_RTL_MEMBER
#undef BITSPAN_RTL_SHADES_MEMBER

// One clock: what is driven before the rising edge, and what the ports show just before it. pixel is
// meaningful with out_valid, span with span_take.
struct RtlDrive {
  bool in_valid;
  bool out_ready;
  RtlInputs in;
};
struct RtlSample {
  bool in_ready;
  bool out_valid;
  bool span_take;
  RtlPixel pixel;
  RtlSpan span;
};

// The entry points of the shared library, by name: bitspan_rtl_create and so on.
extern "C" {
using RtlCreate = void* (*)(int initial_seed);
using RtlDestroy = void (*)(void* rtl);
// These two return null, or the text of an assertion that failed, which lives until the next call.
// Holds reset for two clocks.
using RtlReset = const char* (*)(void* rtl);
// Drives, samples, and gives the rising edge.
using RtlClock = const char* (*)(void* rtl, const RtlDrive* drive, RtlSample* sample);
}

}  // namespace bitspan
