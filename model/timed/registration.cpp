// SPDX-License-Identifier: Apache-2.0
// Makes the engine `systemc` known.
#include "engine/registry.hpp"
#include "model/timed/engine_systemc.hpp"

namespace bitspan {
namespace {

const RegisterEngine systemc_engine{
    {.name = "systemc",
     .order = 3,
     .compared = true,
     .runs = [](const Config&) { return true; },
     .make = [](const Config& c, const EngineOptions&) -> std::unique_ptr<Engine> { return make_systemc(c); },
     // The records and the picture come from the model's stage functions.
     .own =
         [](const Config&, const Scene&) {
           EngineOwn own;
           for_each_counter([&](const CounterInfo& info, auto) { own.counters += info.compared ? 1 : 0; });
           return own;
         }}};

}  // namespace
}  // namespace bitspan

// The linker is told to look for this name, and so takes the object above.
extern "C" void bitspan_timed_registration() {}
