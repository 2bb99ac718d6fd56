// SPDX-License-Identifier: Apache-2.0
// Compiled together with one Verilated span interpolator into a shared library; see rtl_build.cpp.
#include <cstdarg>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "Vspan_interpolator.h"
#include "verilated.h"

// The compiler finds it by its folder: this file is not part of the project's own build.
#include "rtl_abi.hpp"

namespace {

struct Rtl {
  VerilatedContext context;
  Vspan_interpolator top{&context};
  std::string printed;  // since the call began: the text of a failed assertion
};

// Whose call is under way: Verilator's hooks do not say.
thread_local Rtl* current = nullptr;

void edge(Rtl& rtl) {
  rtl.top.clk_i = 1;
  rtl.top.eval();
  rtl.top.clk_i = 0;
}

}  // namespace

// Verilator's runtime is compiled to call these in place of printf and abort.
extern "C" int bitspan_rtl_printf(const char* format, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, format);
  const int n = std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (current != nullptr) current->printed += text;
  return n;
}
void vl_finish(const char*, int, const char*) {}
void vl_stop(const char*, int, const char*) { throw std::runtime_error("stopped"); }
void vl_fatal(const char*, int, const char*, const char* text) { throw std::runtime_error(text); }

#define BITSPAN_EXPORT extern "C" __attribute__((visibility("default")))

BITSPAN_EXPORT void* bitspan_rtl_create() { return new Rtl; }
BITSPAN_EXPORT void bitspan_rtl_destroy(void* rtl) {
  std::unique_ptr<Rtl> owned(static_cast<Rtl*>(rtl));
  // Verilator's scopes take themselves out of the thread's current context, which may be that of an instance
  // already gone.
  Verilated::threadContextp(&owned->context);
}

// Runs one call; returns null, or the text of an assertion that failed in it.
template <class Call>
static const char* guarded(void* handle, Call call) {
  Rtl& rtl = *static_cast<Rtl*>(handle);
  rtl.printed.clear();
  current = &rtl;
  try {
    call(rtl);
  } catch (const std::exception& e) {
    if (rtl.printed.empty()) rtl.printed = e.what();
    return rtl.printed.c_str();
  }
  return nullptr;
}

BITSPAN_EXPORT const char* bitspan_rtl_reset(void* handle) {
  return guarded(handle, [](Rtl& rtl) {
    rtl.top.in_valid_i = 0;
    rtl.top.out_ready_i = 0;
    rtl.top.clk_i = 0;
    rtl.top.rst_ni = 1;
    rtl.top.eval();
    rtl.top.rst_ni = 0;
    for (int i = 0; i < 2; ++i) {
      rtl.top.eval();
      edge(rtl);
    }
    rtl.top.rst_ni = 1;
    rtl.top.eval();
  });
}

BITSPAN_EXPORT const char* bitspan_rtl_clock(void* handle, const bitspan::RtlDrive* drive,
                                             bitspan::RtlSample* sample) {
  return guarded(handle, [drive, sample](Rtl& rtl) {
    Vspan_interpolator& top = rtl.top;
    top.in_valid_i = drive->in_valid;
    top.out_ready_i = drive->out_ready;
#define BITSPAN_DRIVE(name) top.name##_i = static_cast<decltype(top.name##_i + 0)>(drive->in.name);
    BITSPAN_RTL_INPUTS(BITSPAN_DRIVE)
    top.eval();
    sample->in_ready = top.in_ready_o;
    sample->out_valid = top.out_valid_o;
    sample->span_take = top.span_take_o;
    if (sample->out_valid) {
#define BITSPAN_PIXEL(name) sample->pixel.name = top.name##_o;
      BITSPAN_RTL_PIXEL(BITSPAN_PIXEL)
    }
    if (sample->span_take) {
#define BITSPAN_SPAN(name) sample->span.name = top.span_##name##_o;
      BITSPAN_RTL_SPAN(BITSPAN_SPAN)
    }
    edge(rtl);
  });
}
