// Q of docs/numeric-spec.md on floating point, all rounding and overflow modes.
//
// Every value is brought into the form whole + fraction, 0 <= fraction < 1, in ulps of the format; the mode
// needs to know of the fraction only which Part it is. So a sum is rounded exactly although its terms lie too
// far apart for one Real, and a quotient although it has no end.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "config/format.hpp"
#include "golden/real.hpp"

namespace bitspan::golden {

enum class Part : std::uint8_t { zero, below_half, half, above_half };

template <class Real>
struct Whole {
  Real whole;  // floor of the value
  Part part;   // of what is left
};

template <class Real>
Part part_of(Real fraction, Real half) {
  if (fraction == 0) return Part::zero;
  return fraction < half ? Part::below_half : fraction == half ? Part::half : Part::above_half;
}

// The comparison with whole + 1/2 stands in for a subtraction that might not be exact.
template <class Real>
Whole<Real> whole_of(Real x) {
  const Real whole = floor_of(x);
  if (whole == x) return {whole, Part::zero};
  const Real middle = whole + Real(0.5);
  return {whole, x < middle ? Part::below_half : x == middle ? Part::half : Part::above_half};
}

// n / d, d != 0: the rounded quotient is a candidate that the exact remainder corrects.
template <class Real>
Whole<Real> whole_of_quotient(Real n, Real d) {
  if (d < 0) {
    n = -n;
    d = -d;
  }
  Real whole = floor_of(n / d);
  Real rest = n - whole * d;
  while (rest < 0) {
    whole -= 1;
    rest += d;
  }
  while (rest >= d) {
    whole += 1;
    rest -= d;
  }
  return {whole, part_of(rest + rest, d)};
}

// A sum of terms of any sizes: integer and fractional parts are added apart.
template <class Real>
class WholeSum {
 public:
  void add(Real x) {
    const Real floor = floor_of(x);
    whole_ += floor;
    fraction_ += x - floor;
    if (fraction_ >= 1) {
      fraction_ -= 1;
      whole_ += 1;
    }
  }
  void add(const Product<Real>& x) {
    add(x.high);
    if (x.low != 0) add(x.low);
  }
  Whole<Real> get() const { return {whole_, part_of(fraction_, Real(0.5))}; }

 private:
  Real whole_ = 0;
  Real fraction_ = 0;
};

// ceil(x - 1/2) and floor(x - 1/2): the first and last pixel whose centre is at or right, or left, of x.
template <class Real>
Real ceil_less_half(const Whole<Real>& x) {
  return x.part == Part::above_half ? x.whole + 1 : x.whole;
}
template <class Real>
Real floor_less_half(const Whole<Real>& x) {
  return x.part == Part::half || x.part == Part::above_half ? x.whole : x.whole - 1;
}

template <class Real>
bool is_odd(Real integer) {
  const Real half = integer * Real(0.5);
  return floor_of(half) != half;
}

template <class Real>
Real round_whole(const Whole<Real>& x, Rounding mode) {
  bool up = false;
  switch (mode) {
    case Rounding::trn:
      return x.whole;
    case Rounding::trn_zero:
      up = x.whole < 0 && x.part != Part::zero;
      break;
    case Rounding::rnd:
      up = x.part >= Part::half;
      break;
    case Rounding::rnd_min_inf:
      up = x.part == Part::above_half;
      break;
    case Rounding::rnd_zero:
      up = x.part == Part::above_half || (x.part == Part::half && x.whole < 0);
      break;
    case Rounding::rnd_inf:
      up = x.part == Part::above_half || (x.part == Part::half && x.whole >= 0);
      break;
    case Rounding::rnd_conv:
      up = x.part == Part::above_half || (x.part == Part::half && is_odd(x.whole));
      break;
  }
  return up ? x.whole + 1 : x.whole;
}

// A product that may lie far outside the format `out` that it is summed into, beside terms that lie within
// the formats `near` and an offset. Where overflow saturates it is cut to a bound beyond which the result
// stays the same, so that its sum with the others needs no bits for the distance; where overflow wraps it
// stays as it is.
struct FarBound {
  bool wraps = true;
  int exponent = 0;  // the bound is 2^exponent: 4 times what any of the others holds
  FarBound(const Format& out, std::initializer_list<Format> near, double offset = 0)
      : wraps(out.overflow == Overflow::wrap || out.overflow == Overflow::wrap_sm), exponent(out.integer) {
    for (const Format& format : near) exponent = std::max(exponent, format.integer);
    if (offset != 0) exponent = std::max(exponent, std::ilogb(offset) + 1);
    exponent += 2;
  }
};

template <class Real>
class FarProduct {
 public:
  FarProduct() = default;
  explicit FarProduct(const FarBound& bound) : bound_(pow2<Real>(bound.exponent)), wraps_(bound.wraps) {}
  Product<Real> operator()(const Product<Real>& x) const {
    if (wraps_) return x;
    if (x.high > bound_) return {bound_, 0};
    if (x.high < -bound_) return {-bound_, 0};
    return x;
  }

 private:
  Real bound_ = 0;
  bool wraps_ = true;
};

// One format's Q. Values are in the format's unit; `raw` and `value` carry them to and from records.
template <class Real>
class Quantizer {
 public:
  Quantizer() = default;
  explicit Quantizer(const Format& format)
      : scale_(pow2<Real>(format.fraction())),
        ulp_(pow2<Real>(-format.fraction())),
        modulus_(pow2<Real>(format.word)),
        half_modulus_(pow2<Real>(format.word - 1)),
        rounding_(format.rounding),
        overflow_(format.overflow),
        is_signed_(format.is_signed),
        own_range_(FarBound(format, {})) {
    using Base = typename RealTraits<Real>::Base;
    // Rounded where Real does not hold the format: it is then one that the stage never narrows to.
    too_wide_ = format.word - (is_signed_ ? 1 : 0) > real_bits<Real>;
    max_ = pow2<Base>(is_signed_ ? format.word - 1 : format.word) - 1;
    min_ = !is_signed_ ? Real(0) : overflow_ == Overflow::sat_sym ? -max_ : -half_modulus_;
  }

  Real operator()(Real x) const { return narrow(whole_of(x * scale_)); }

  template <class... Terms>
  Real sum(Terms... terms) const {
    WholeSum<Real> all;
    (all.add(scaled(terms)), ...);
    return narrow(all.get());
  }

  // Of a b, which one Real need not hold.
  Real product(Real a, Real b) const { return sum(own_range_(exact_product(a, b))); }
  Real product(const Product<Real>& x) const { return sum(own_range_(x)); }

  // Of n / d; n and d may have either sign, d != 0.
  Real quotient(Real n, Real d) const { return narrow(whole_of_quotient(n * scale_, d)); }

  std::int64_t raw(Real value) const { return to_integer(value * scale_); }
  Real value(std::int64_t raw) const { return Real(raw) * ulp_; }
  Real ulp() const { return ulp_; }

 private:
  Real scaled(Real x) const { return x * scale_; }
  Product<Real> scaled(const Product<Real>& x) const { return x.scaled(scale_); }
  Real narrow(const Whole<Real>& x) const { return fit(round_whole(x, rounding_)) * ulp_; }

  // n in ulps, an integer.
  Real fit(Real n) const {
    if constexpr (RealTraits<Real>::checked) {
      if (too_wide_) throw_inexact("format's limit");
    }
    if (n >= min_ && n <= max_) return n;
    switch (overflow_) {
      case Overflow::sat:
      case Overflow::sat_sym:
        return n < min_ ? min_ : max_;
      case Overflow::sat_zero:
        return 0;
      case Overflow::wrap: {
        const Real low = modulo(n, modulus_);
        return is_signed_ && low >= half_modulus_ ? low - modulus_ : low;
      }
      case Overflow::wrap_sm: {
        // The bit above the kept ones becomes the sign; where the old sign bit differs, the rest is inverted.
        const bool sign = is_odd(floor_of(n * pow2_inverse(modulus_)));
        const bool old_sign = is_odd(floor_of(n * pow2_inverse(half_modulus_)));
        Real low = modulo(n, half_modulus_);
        if (sign != old_sign) low = half_modulus_ - 1 - low;
        return sign ? low - half_modulus_ : low;
      }
    }
    return 0;
  }
  static Real pow2_inverse(Real power) { return pow2<Real>(-exponent_of(power)); }
  static Real modulo(Real n, Real power) { return n - floor_of(n * pow2_inverse(power)) * power; }

  Real scale_ = 1, ulp_ = 1, modulus_ = 2, half_modulus_ = 1, min_ = 0, max_ = 1;
  Rounding rounding_ = Rounding::trn;
  Overflow overflow_ = Overflow::sat;
  bool is_signed_ = false;
  bool too_wide_ = false;
  FarProduct<Real> own_range_;
};

}  // namespace bitspan::golden
