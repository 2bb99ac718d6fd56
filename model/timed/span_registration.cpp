// SPDX-License-Identifier: Apache-2.0
// Makes the engine `timed` known: span mode alone, for programs without SystemC.
#include "engine/registry.hpp"
#include "model/timed/engine_timed.hpp"

namespace bitspan {
namespace {

const RegisterEngine timed_engine{
    {.name = "timed",
     .order = 3,
     .compared = true,
     .runs = [](const Config&) { return true; },
     .make = [](const Config& c, const EngineOptions&) -> std::unique_ptr<Engine> {
       return timed::make_timed_engine("timed", c, {.mode = TimedMode::span}, timed::make_span_machine);
     }}};

}  // namespace
}  // namespace bitspan
