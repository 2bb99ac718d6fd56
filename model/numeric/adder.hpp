// SPDX-License-Identifier: Apache-2.0
// An accumulator and its step: acc = Q(acc + step), how far each is shifted onto the common grid.
#pragma once

#include <algorithm>

#include "model/numeric/register.hpp"

namespace bitspan::model {

struct Adder {
  Register acc;
  int acc_up = 0, step_up = 0, fraction = 0;
  bool fits_int64 = false;  // the sum fits 64 bits
  bool operator==(const Adder&) const = default;
};
constexpr Adder make_adder(const Register& acc, const Register& step) {
  const int fraction = std::max(acc.fraction, step.fraction);
  const int acc_up = fraction - acc.fraction;
  const int step_up = fraction - step.fraction;
  return {acc, acc_up, step_up, fraction, acc.word + acc_up <= 61 && step.word + step_up <= 61};
}

}  // namespace bitspan::model
