// SPDX-License-Identifier: Apache-2.0
// Makes the engine `model` known.
#include "engine/registry.hpp"
#include "model/engine_model.hpp"
#include "model/paths.hpp"

namespace bitspan {
namespace {

const RegisterEngine model_engine{
    {.name = "model",
     .order = 2,
     .compared = true,
     .runs = [](const Config&) { return true; },
     .check = [](const EngineOptions& o) { static_cast<void>(model::model_options(o)); },
     .make = [](const Config& c, const EngineOptions& o) { return make_model(c, model::model_options(o)); },
     .has_bands = true}};

}  // namespace
}  // namespace bitspan

// The linker is told to look for this name, and so takes the object above.
extern "C" void bitspan_model_registration() {}
