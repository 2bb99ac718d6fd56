// SPDX-License-Identifier: Apache-2.0
// Which way the engine model takes with a configuration, and why: what `bitspan config check` tells. The
// decisions are the stages' own; this only asks them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/registry.hpp"
#include "model/engine_model.hpp"

namespace bitspan::model {

// "auto", "scalar", "vector", "specialised"; "best", "avx512", "avx2", "baseline": as the command line has
// them.
std::string_view to_string(ModelForm form);
std::string_view to_string(VectorTarget target);

// Throws InputError, naming the command line's flag, where a name is unknown or this processor lacks the
// target.
ModelOptions model_options(const EngineOptions& options);

// What `best` stands for on this processor.
VectorTarget best_target();

// The form that make_model takes for the one asked for. Throws InputError where `specialised` is asked for
// and the configuration has the formats of no shipped one.
ModelForm chosen_form(const Config& config, ModelForm asked);

struct StagePath {
  std::string stage;
  std::string path;    // what it computes in: "32-bit lanes", "64-bit lanes", "scalar" ...
  std::string widest;  // the expression that takes most bits, as in docs/numeric-spec.md
  int bits = 0;        // of a signed integer that holds it, aligned with its register
};
// In the order of the stages; of every scene the configuration may meet.
std::vector<StagePath> model_paths(const Config& config);

}  // namespace bitspan::model
