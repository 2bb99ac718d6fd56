// SPDX-License-Identifier: Apache-2.0
// Compiled together with one Verilated module into a shared library; see rtl_module.cpp, which puts in front
// of it the module's header, BITSPAN_TOP, and its ports as BITSPAN_INPUTS(X) and BITSPAN_OUTPUTS(X).
#include <cstdint>

// The compiler finds them by their folder: this file is not part of the project's own build.
#include "rtl_harness.hpp"

using Module = Simulation<BITSPAN_TOP>;

BITSPAN_EXPORT void* bitspan_module_create() {
  auto* module = new Module;
  // A design may ask for plusargs: there are none.
  const char* name = "bitspan";
  module->context.commandArgs(1, &name);
  return module;
}
BITSPAN_EXPORT void bitspan_module_destroy(void* module) { destroy<Module>(module); }

BITSPAN_EXPORT const char* bitspan_module_reset(void* handle) {
  return guarded<Module>(handle, [](Module& module) {
#define BITSPAN_CLEAR(name) module.top.name = 0;
    BITSPAN_INPUTS(BITSPAN_CLEAR)
    module.reset();
  });
}

BITSPAN_EXPORT const char* bitspan_module_clock(void* handle, const std::uint64_t* inputs,
                                                std::uint64_t* outputs) {
  return guarded<Module>(handle, [inputs, outputs](Module& module) {
    const std::uint64_t* in = inputs;
    std::uint64_t* out = outputs;
#define BITSPAN_DRIVE(name) module.top.name = static_cast<decltype(module.top.name + 0)>(*in++);
    BITSPAN_INPUTS(BITSPAN_DRIVE)
    module.top.eval();
#define BITSPAN_SAMPLE(name) *out++ = module.top.name;
    BITSPAN_OUTPUTS(BITSPAN_SAMPLE)
    module.edge();
  });
}
