// SPDX-License-Identifier: Apache-2.0
// The module bitspan._core. The package's Python makes of it what users see.
#include "python/core/core.hpp"

#include <nanobind/stl/string.h>

#include <new>

#include "io/data_folder.hpp"
#include "tb/programs.hpp"

namespace bitspan::python {

void check(bs_status status) {
  switch (status) {
    case BS_OK:
      return;
    case BS_BAD_INPUT:
    case BS_UNSUPPORTED:
      throw InputError(bs_last_error());
    case BS_BAD_HANDLE:
    case BS_BAD_ORDER:
    case BS_BUSY:
      throw StateError(bs_last_error());
    case BS_NO_MEMORY:
      throw std::bad_alloc();
    default:
      throw std::runtime_error(bs_last_error());
  }
}

}  // namespace bitspan::python

NB_MODULE(_core, m) {
  using namespace bitspan::python;
  m.doc() = "bitspan in C++; use the package bitspan.";
  const nb::exception<bitspan::InputError> input_error(m, "InputError", PyExc_ValueError);
  const nb::exception<StateError> state_error(m, "StateError", PyExc_RuntimeError);
  const nb::exception<bitspan::ToolError> tool_error(m, "ToolError", PyExc_RuntimeError);
  m.attr("version") = bs_version();
  nb::list stages;
  for (bs_stage s = 0; bs_stage_name(s) != nullptr; ++s) stages.append(bs_stage_name(s));
  m.attr("stages") = nb::tuple(stages);
  nb::list engines;
  for (int i = 0; bs_engine_name(i) != nullptr; ++i) engines.append(bs_engine_name(i));
  m.attr("engines") = nb::tuple(engines);
  nb::list counters;
  for (int i = 0; bs_counter_name(i) != nullptr; ++i) counters.append(bs_counter_name(i));
  m.attr("counters") = nb::tuple(counters);
  m.def(
      "data_folder", [] { return bitspan::data_folder().string(); },
      "The folder with config/, rtl/ and dv/ that the package brings.");
  bind_config(m);
  bind_scene(m);
  bind_model(m);
  bind_errors(m);
  bind_costs(m);
  bind_search(m);
}
