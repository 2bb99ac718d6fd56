// SPDX-License-Identifier: Apache-2.0
// What every harness of a Verilated module has: the hooks of Verilator's runtime, and calls whose failed
// assertions come back as text.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "verilated.h"
#if VM_COVERAGE
#include <unistd.h>

#include <cstdlib>

#include "verilated_cov.h"
#endif

namespace {

#if VM_COVERAGE
// A name of its own, without an ending, in the folder of tb/rtl_coverage.hpp.
std::string coverage_file() {
  std::string name = std::string(std::getenv("BITSPAN_RTL_COVERAGE")) + "/XXXXXX";
  const int file = ::mkstemp(name.data());
  if (file < 0) std::abort();
  ::close(file);
  return name;
}
#endif

// Top: Verilator's class of the top module.
template <class Top>
struct Simulation {
  // Registers begin at 0, or with random values of a seed other than 0.
  explicit Simulation(int seed = 0) : top{prepare(context, seed)} {}

  VerilatedContext context;
  Top top;
  std::string printed;  // since the call began: the text of a failed assertion
#if VM_COVERAGE
  // What was counted to the end of the first reset goes into a file of its own: a signal that never changes
  // reaches its value then, which is no toggle.
  std::string counts = coverage_file();
  bool fresh = true;
  ~Simulation() { context.coveragep()->write((counts + ".dat").c_str()); }
#endif

  void edge() {
    top.clk_i = 1;
    top.eval();
    top.clk_i = 0;
  }
  static VerilatedContext* prepare(VerilatedContext& context, int seed) {
    context.randReset(seed == 0 ? 0 : 2);
    context.randSeed(seed);
    Verilated::threadContextp(&context);  // Verilator's constructors draw from it
    return &context;
  }
  // Holds reset for two clocks.
  void reset() {
#if VM_COVERAGE
    if (std::exchange(fresh, false)) {
      reset();
      context.coveragep()->write((counts + ".start").c_str());
    }
#endif
    top.clk_i = 0;
    top.rst_ni = 1;
    top.eval();
    top.rst_ni = 0;
    for (int i = 0; i < 2; ++i) {
      top.eval();
      edge();
    }
    top.rst_ni = 1;
    top.eval();
  }
};

// Whose call is under way: Verilator's hooks do not say.
thread_local std::string* current_text = nullptr;

// Runs one call; returns null, or the text of an assertion that failed in it.
template <class Sim, class Call>
const char* guarded(void* handle, Call call) {
  Sim& sim = *static_cast<Sim*>(handle);
  sim.printed.clear();
  current_text = &sim.printed;
  try {
    call(sim);
  } catch (const std::exception& e) {
    if (sim.printed.empty()) sim.printed = e.what();
    return sim.printed.c_str();
  }
  return nullptr;
}

template <class Sim>
void destroy(void* handle) {
  std::unique_ptr<Sim> owned(static_cast<Sim*>(handle));
  // Verilator's scopes take themselves out of the thread's current context, which may be that of an instance
  // already gone.
  Verilated::threadContextp(&owned->context);
}

}  // namespace

// Verilator's runtime is compiled to call these in place of printf and abort.
extern "C" int bitspan_rtl_printf(const char* format, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, format);
  const int n = std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (current_text != nullptr) *current_text += text;
  return n;
}
void vl_finish(const char*, int, const char*) {}
void vl_stop(const char*, int, const char*) { throw std::runtime_error("stopped"); }
void vl_fatal(const char*, int, const char*, const char* text) { throw std::runtime_error(text); }

#define BITSPAN_EXPORT extern "C" __attribute__((visibility("default")))
