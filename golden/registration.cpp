// SPDX-License-Identifier: Apache-2.0
// Makes golden and ideal known.
#include "engine/registry.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"

namespace bitspan {
namespace {

bool any(const Config& /*config*/) { return true; }

const RegisterEngine golden_engine{
    {.name = "golden",
     .order = 1,
     .compared = true,
     .runs = any,
     .make = [](const Config& c, const EngineOptions&) { return make_golden(c); },
     .has_bands = true}};
const RegisterEngine ideal_engine{
    {.name = "ideal",
     .order = 5,
     .compared = false,
     .runs = any,
     .make = [](const Config& c, const EngineOptions&) { return make_ideal(c); }}};

}  // namespace
}  // namespace bitspan

// The linker is told to look for this name, and so takes the object above.
extern "C" void bitspan_golden_registration() {}
