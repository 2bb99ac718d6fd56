// SPDX-License-Identifier: Apache-2.0
// The reciprocal square root RS; docs/numeric-spec.md, "Reciprocal square root".
#pragma once

#include <vector>

#include "config/config.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

// Returns the table in units of 2^-table_bits: the entries for 1 to 2, then those for 2 to 4.
std::vector<std::int64_t> root_table(const RootUnit& unit);

// Stands for m 2^-e.
template <class Real>
struct InverseRoot {
  Real m = 0;
  int e = 0;
};

template <class Real>
class InverseRootUnit {
 public:
  explicit InverseRootUnit(const Config& config)
      : steps_(config.light_root.steps),
        operand_scale_(pow2<Real>(config.light_root.operand_bits)),
        operand_ulp_(pow2<Real>(-config.light_root.operand_bits)),
        index_scale_(pow2<Real>(config.light_root.index_bits)),
        internal_scale_(pow2<Real>(config.light_root.internal_bits)),
        internal_ulp_(pow2<Real>(-config.light_root.internal_bits)),
        output_(config.format(FormatId::light_root)) {
    const Real ulp = pow2<Real>(-config.light_root.table_bits);
    for (const std::int64_t entry : root_table(config.light_root)) table_.push_back(Real(entry) * ulp);
  }

  // Takes any d > 0.
  InverseRoot<Real> operator()(Real d) const {
    const int octave = exponent_of(d);
    const int e = (octave - (octave % 2 != 0 ? 1 : 0)) / 2;
    const Real n = floor_of(d * pow2<Real>(-2 * e) * operand_scale_) * operand_ulp_;
    const bool second = n >= 2;
    const Real place = floor_of((n * (second ? Real(0.5) : Real(1)) - 1) * index_scale_);
    Real y = table_[static_cast<std::size_t>(to_integer(place + (second ? index_scale_ : Real(0))))];
    for (int step = 0; step < steps_; ++step) {
      const Real a = cut(n * y);
      const Real c = cut(a * y);
      y = cut(y * (3 - c) * Real(0.5));
    }
    return {output_(y), e};
  }

 private:
  Real cut(Real x) const { return floor_of(x * internal_scale_) * internal_ulp_; }

  int steps_;
  Real operand_scale_, operand_ulp_, index_scale_, internal_scale_, internal_ulp_;
  Quantizer<Real> output_;
  std::vector<Real> table_;
};

}  // namespace bitspan::golden
