// SPDX-License-Identifier: Apache-2.0
// The reciprocal units R_pixel, R_row, R_edge and the slopes made with them; docs/numeric-spec.md,
// "Reciprocal".
#pragma once

#include <vector>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "golden/lanes.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {

// Stands for m 2^-e.
template <class Real>
struct Inverse {
  Real m = 0;
  int e = 0;
  PairOf<Real> times(Real x) const {
    return exact_product(x, m).scaled(pow2<typename RealTraits<Real>::Base>(-e));
  }
};

// Returns the fraction bits of the grid that h + B lies on.
inline int depth_sum_fraction(const Config& config, FormatId h) {
  const int a = config.format(h).fraction();
  const int b = config.format(FormatId::setup_b).fraction();
  return a > b ? a : b;
}

template <class Real>
class ReciprocalUnit {
 public:
  // operand_fraction: the operands are multiples of 2^-operand_fraction.
  ReciprocalUnit(const Reciprocal& unit, int operand_fraction);

  // Takes any d; d <= 0 stands for the smallest positive operand.
  Inverse<Real> operator()(Real d) const {
    if (d <= 0) d = least_;
    const int e = exponent_of(d);
    const Real n = d * pow2<Real>(-e);
    if (!has_table(kind_)) {
      if (normalize_) return {output_.quotient(Real(1), n), e};
      return {output_.quotient(Real(1), d), 0};
    }
    const Real y = by_table(n);
    if (normalize_) return {output_(y), e};
    return {output_(y * pow2<Real>(-e)), 0};
  }

  std::int64_t raw(Real m) const { return output_.raw(m); }

  // Gives m in ulps, 2^-e and e for a column of normal d > 0. Returns false where this unit, or one of these
  // d, has no quick form.
  bool quick(const Column& d, std::size_t n, Column& m, Column& inverse_power,
             std::int64_t* e) const requires std::same_as<Real, double>;
  double ulp() const requires std::same_as<Real, double> { return output_.ulp(); }

 private:
  Real cut(Real x) const { return floor_of(x * internal_scale_) * internal_ulp_; }
  Real cut(const PairOf<Real>& x) const {
    return Real(whole_of(x.scaled(base_of(internal_scale_))).whole) * internal_ulp_;
  }
  Real entry(Real index) const { return table_[static_cast<std::size_t>(to_integer(index))]; }
  // 1 / n as a kind with a table has it, before it is narrowed.
  Real by_table(Real n) const;

  ReciprocalKind kind_;
  bool normalize_;
  int steps_;
  bool single_;  // one Real holds each product of a lut kind
  Real least_;
  Real operand_scale_, operand_ulp_, index_scale_, internal_scale_, internal_ulp_;
  Quantizer<Real> output_;
  LaneFormat quick_output_;
  std::vector<Real> table_;
};

// Returns the table of a lut kind in units of 2^-table_bits; it is empty for restoring.
std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit);

// Returns the significant bits that hold every product of a lut kind.
int lut_product_bits(const Reciprocal& unit);

// What slopes are divided by: a length, and its reciprocal where that form is configured;
// docs/numeric-spec.md, "Slope".
template <class Real>
struct Divisor {
  Real length = 1;
  bool reciprocal = false;
  Inverse<Real> inverse;

  Divisor() = default;
  Divisor(Real d, SlopeForm form, const ReciprocalUnit<Real>& unit)
      : length(d), reciprocal(shares_reciprocal(form)) {
    if (reciprocal) inverse = unit(d);
  }
  Real slope(Real n, const Quantizer<Real>& q) const {
    return reciprocal ? q.product(inverse.times(n)) : q.quotient(n, length);
  }
};

}  // namespace bitspan::golden
