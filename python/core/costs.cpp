// SPDX-License-Identifier: Apache-2.0
// What a configuration costs: from its formats alone, and as Yosys and nextpnr build it.
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include <atomic>
#include <chrono>
#include <future>

#include "python/core/core.hpp"
#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/cost.hpp"

namespace bitspan::python {
namespace {

Metrics costs(const ConfigHandle& handle) {
  const Config config = handle.full();
  Metrics out;
  add_costs(config, out);
  add_timing(config, out);
  add_estimates(config, out);
  return out;
}

// The tools run beside a thread that looks for Ctrl-C.
nb::tuple area(const ConfigHandle& handle, const std::string& family, const std::string& part, bool place,
               double seconds) {
  const Config config = handle.full();
  const AreaTarget target{family_named(family), area_part_named(part)};
  std::atomic<bool> cancelled = false;
  AreaResult result;
  {
    const nb::gil_scoped_release unlocked;
    auto done = std::async(std::launch::async, [&] {
      return measure_area(config, target, place, {.seconds = seconds, .cancelled = &cancelled});
    });
    while (done.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      const nb::gil_scoped_acquire locked;
      if (PyErr_CheckSignals() != 0) {
        cancelled = true;
        throw nb::python_error();  // the future waits for the tools' end
      }
    }
    result = done.get();
  }
  return nb::make_tuple(std::string(to_string(result.status)), result.counts.luts, result.counts.ffs,
                        result.counts.multipliers, result.counts.memory_bits, result.fmax_mhz, result.message,
                        result.seconds, result.tools);
}

}  // namespace

void bind_costs(nb::module_& m) {
  m.def("costs", &costs, nb::arg("config"), "The metrics that the configuration alone gives.");
  m.def("area", &area, nb::arg("config"), nb::arg("family"), nb::arg("part"), nb::arg("place"),
        nb::arg("seconds"),
        "(status, LUTs, flip-flops, multipliers, memory bits, MHz, message, seconds, tools).");
}

}  // namespace bitspan::python
