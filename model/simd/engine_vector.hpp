// SPDX-License-Identifier: Apache-2.0
// The vector form of the engine `model`: batches of triangles, spans and fragments; docs/performance.md.
#pragma once

#include <memory>

#include "model/engine_model.hpp"

namespace bitspan::model {

// options.form: vector or specialised; the configuration can be drawn in lanes (vector_refusal is null).
std::unique_ptr<Engine> make_vector_model(const Config& config, const ModelOptions& options);
// With an observer at every register.
std::unique_ptr<ObservedEngine> make_observed_vector_model(const Config& config, VectorTarget target);

// Why this configuration has no vector form; null where it has.
const char* vector_refusal(const Config& config);

}  // namespace bitspan::model
