// The engine `model`: the bit-true pipeline in integers, a record at a time.
#pragma once

#include <memory>

#include "config/engine.hpp"
#include "model/numeric/observe.hpp"

namespace bitspan {

std::unique_ptr<Engine> make_model(const Config& config);

// The same engine with an observer at every register; equal in every value, and slower.
class ObservedEngine : public Engine {
 public:
  // Since the last begin().
  virtual const model::Statistics& statistics() const = 0;
};
std::unique_ptr<ObservedEngine> make_observed_model(const Config& config);

}  // namespace bitspan
