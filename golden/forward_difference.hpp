// SPDX-License-Identifier: Apache-2.0
// Stage `forward_difference`: the points of a cubic by three adders. [C2]
#pragma once

#include <array>
#include <vector>

#include "config/curve.hpp"
#include "golden/quantize.hpp"
#include "golden/real.hpp"

namespace bitspan::golden {

template <class Real>
class ForwardDifference {
 public:
  using Values = std::array<Real, 4>;

  ForwardDifference(const CurveFormats& formats, int k)
      : q_{Quantizer<Real>(formats[0]), Quantizer<Real>(formats[1]), Quantizer<Real>(formats[2]),
           Quantizer<Real>(formats[3])},
        step_(pow2<Real>(-k)) {}

  // power[i]: of t^i.
  Values start(const Values& power) const {
    const Real c = power[1] * step_;
    const Real b = power[2] * step_ * step_;
    const Real a = power[3] * step_ * step_ * step_;
    return {q_[0](power[0]), q_[1].sum(a, b, c), q_[2].sum(exact_product(Real(6), a), b + b),
            q_[3].product(Real(6), a)};
  }
  void advance(Values& d) const {
    for (std::size_t i = 0; i < 3; ++i) d[i] = q_[i].sum(d[i], d[i + 1]);
  }
  CurveRegisters raw(const Values& d) const {
    CurveRegisters out;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = q_[i].raw(d[i]);
    return out;
  }

 private:
  std::array<Quantizer<Real>, 4> q_;
  Real step_;
};

// The registers at each of the 2^k + 1 points. Throws InputError as check_curve.
std::vector<CurveRegisters> forward_difference(const CurveFormats& formats, const CurveCoefficients& curve,
                                               int k);

}  // namespace bitspan::golden
