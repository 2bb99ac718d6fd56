// SPDX-License-Identifier: Apache-2.0
// Which instructions the vector form runs on: one table of kernels a target, picked at run time.
//
// Every file of kernels exports a getter of its table (HWY_EXPORT) and gets the table of a target by
// on_target. The targets compiled are fixed by HWY_DISABLED_TARGETS (model/CMakeLists.txt): AVX-512, AVX2 and
// one lane at a time.
#pragma once

#include <mutex>

#include "model/engine_model.hpp"

namespace bitspan::model {

// Whether this processor has it; `best` and `baseline` always.
bool supported(VectorTarget target);

// While it lives, Highway's dynamic dispatch goes to one target; one at a time in the process. Throws
// InputError where the processor lacks the target.
class TargetScope {
 public:
  explicit TargetScope(VectorTarget target);
  ~TargetScope();
  TargetScope(const TargetScope&) = delete;
  TargetScope& operator=(const TargetScope&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

// get(), which dispatches, on a target: on_target(target, [] { return HWY_DYNAMIC_DISPATCH(kernels)(); }).
template <class Get>
auto on_target(VectorTarget target, Get get) {
  const TargetScope scope(target);
  return get();
}

}  // namespace bitspan::model
