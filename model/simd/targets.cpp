// SPDX-License-Identifier: Apache-2.0
#include "model/simd/targets.hpp"

#include <cstdint>

#include "config/config.hpp"
#include "hwy/highway.h"

namespace bitspan::model {
namespace {

std::mutex& dispatch_mutex() {
  static std::mutex mutex;
  return mutex;
}

// The one lane form is every table's last entry, whatever the mask.
std::int64_t mask_of(VectorTarget target) {
  switch (target) {
    case VectorTarget::avx512:
      return HWY_AVX3;
    case VectorTarget::avx2:
      return HWY_AVX2;
    case VectorTarget::baseline:
      return HWY_STATIC_TARGET;
    case VectorTarget::best:
      break;
  }
  return hwy::SupportedTargets();
}

}  // namespace

bool supported(VectorTarget target) {
  return target == VectorTarget::best || target == VectorTarget::baseline ||
         (hwy::SupportedTargets() & HWY_TARGETS & mask_of(target)) != 0;
}

TargetScope::TargetScope(VectorTarget target) {
  if (!supported(target)) {
    throw InputError(target == VectorTarget::avx512 ? "this processor has no AVX-512"
                                                    : "this processor has no AVX2");
  }
  lock_ = std::unique_lock(dispatch_mutex());
  hwy::GetChosenTarget().Update(mask_of(target));
}

TargetScope::~TargetScope() { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); }

}  // namespace bitspan::model
