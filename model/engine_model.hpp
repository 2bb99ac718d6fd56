// SPDX-License-Identifier: Apache-2.0
// The engine `model`: the bit-true pipeline in integers. Every form of it below gives the same bits.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "engine/engine.hpp"
#include "model/numeric/observe.hpp"

namespace bitspan {

// How the model computes.
enum class ModelForm : std::uint8_t {
  automatic,    // specialised where a shipped configuration's formats match, else vector
  scalar,       // a record at a time, in the stage functions alone: the reference of the other forms
  vector,       // batches of rows and fragments, formats read at run time
  specialised,  // the same with the formats of a shipped configuration compiled in
};

// Which instructions the vectors are made of.
enum class VectorTarget : std::uint8_t { best, avx512, avx2, baseline };

struct ModelOptions {
  ModelForm form = ModelForm::automatic;
  VectorTarget target = VectorTarget::best;
  int threads = 1;  // bands of rows; the bits do not depend on it
  // Keep u, v and the triangle of the fragment that won. Without them Frame::u, v and triangle are empty.
  bool winners = true;
};

// Throws InputError where the processor lacks the target, or no compiled-in configuration is this one.
std::unique_ptr<Engine> make_model(const Config& config, const ModelOptions& options = {});

// The model with an observer at every register; equal in every value, and slower.
class ObservedEngine : public Engine {
 public:
  // Since the last begin().
  virtual const model::Statistics& statistics() const = 0;
};
// form: scalar, or automatic for vectors where the configuration has that form.
std::unique_ptr<ObservedEngine> make_observed_model(const Config& config,
                                                    ModelForm form = ModelForm::automatic);

}  // namespace bitspan
