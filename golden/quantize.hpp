// SPDX-License-Identifier: Apache-2.0
// Q of docs/numeric-spec.md on floating point, with all rounding and overflow modes.
//
// Every value is brought into the form whole + fraction, 0 <= fraction < 1, in ulps of the format. The mode
// needs to know only how the fraction compares with 0 and 1/2. What a Quantizer narrows is exact whatever
// Real is: sums and products come as Pairs, quotients with their exact remainder, and each step that might
// lose a bit is checked by its rounding error. Where a step did lose one, or the value is too large for the
// quick floor, the operands are taken anew in quadruple precision, which holds them (golden/precision.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "config/format.hpp"
#include "golden/real.hpp"

namespace bitspan::golden {

template <class Real>
struct Whole {
  Real whole;         // floor of the value
  bool integer;       // nothing is left
  bool half_or_more;  // at least 1/2 is left
  bool above_half;    // more than 1/2 is left
};

// The comparison with whole + 1/2 stands in for a subtraction that might not be exact.
template <class Real>
Whole<Real> whole_of(Real x) {
  const Real whole = floor_of(x);
  if (whole == x) return {whole, true, false, false};
  const Real middle = whole + Real(0.5);
  return {whole, false, x >= middle, x > middle};
}

// Takes high + low, where low is what rounding to T left out of high.
template <class T>
Whole<T> whole_of(const Pair<T>& x) {
  const T whole = floor_of(x.high);
  if (whole != x.high) {
    const T middle = whole + T(0.5);
    const bool tie = x.high == middle;
    return {whole, false, x.high > middle || (tie && x.low >= 0), x.high > middle || (tie && x.low > 0)};
  }
  const T floor_low = floor_of(x.low);
  const T rest = x.low - floor_low;
  return {whole + floor_low, rest == 0, rest >= T(0.5), rest > T(0.5)};
}

// Takes n / d, d != 0. The rounded quotient is a candidate that the exact remainder corrects. The caller
// knows that Real holds the products and remainders.
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
  const Real twice = rest + rest;
  return {whole, rest == 0, twice >= d, twice > d};
}

// ceil(x - 1/2) and floor(x - 1/2): the first and last pixel whose centre is at or right, or left, of x.
template <class Real>
Real ceil_less_half(const Whole<Real>& x) {
  return x.above_half ? x.whole + 1 : x.whole;
}
template <class Real>
Real floor_less_half(const Whole<Real>& x) {
  return x.half_or_more ? x.whole : x.whole - 1;
}

template <class Real>
bool is_odd(Real integer) {
  const Real half = integer * Real(0.5);
  return floor_of(half) != half;
}

// Says whether the mode goes to whole + 1.
template <class Real>
[[gnu::always_inline]] inline bool rounds_up(const Whole<Real>& x, Rounding mode) {
  switch (mode) {
    case Rounding::trn:
      return false;
    case Rounding::rnd:
      return x.half_or_more;
    case Rounding::trn_zero:
      return x.whole < 0 && !x.integer;
    case Rounding::rnd_min_inf:
      return x.above_half;
    case Rounding::rnd_zero:
      return x.whole < 0 ? x.half_or_more : x.above_half;
    case Rounding::rnd_inf:
      return x.whole < 0 ? x.above_half : x.half_or_more;
    case Rounding::rnd_conv:
      return x.above_half || (x.half_or_more && is_odd(x.whole));
  }
  return false;
}

template <class Real>
[[gnu::always_inline]] inline Real round_whole(const Whole<Real>& x, Rounding mode) {
  return x.whole + (rounds_up(x, mode) ? Real(1) : Real(0));
}

// One format's Q. Values are in the format's unit; `raw` and `value` carry them to and from records.
template <class Real>
class Quantizer {
  using T = typename RealTraits<Real>::Base;

 public:
  Quantizer() = default;
  explicit Quantizer(const Format& format)
      : scale_(pow2<T>(format.fraction())),
        ulp_(pow2<T>(-format.fraction())),
        // Rounded where T does not hold the format: it is then one that the stage never narrows to.
        max_(pow2<T>(format.is_signed ? format.word - 1 : format.word) - 1),
        min_(!format.is_signed                      ? T(0)
             : format.overflow == Overflow::sat_sym ? -max_
                                                    : -pow2<T>(format.word - 1)),
        format_(format) {}

  [[gnu::always_inline]] Real operator()(Real x) const {
    const T in_ulps = base_of(x) * scale_;
    return is_small(in_ulps) ? narrow_small({in_ulps, 0}) : anew({pair_of(x)});
  }

  // Returns Q of the sum of the terms, each a Real or a Pair; quickest with the Pair first.
  [[gnu::always_inline]] Real sum(Real a, Real b) const {
    const TwoSum<T> both(base_of(a) * scale_, base_of(b) * scale_);
    return is_small(both.sum) ? narrow_small({both.sum, both.error}) : anew({pair_of(a), pair_of(b)});
  }
  template <class First, class... Terms>
  Real sum(First first, Terms... terms) const {
    ExactSum<T> all(scaled(first));
    (all.add(scaled(terms)), ...);
    const Pair<T> value = all.get();
    if (is_small(value.high) && all.exact()) [[likely]]
      return narrow_small(value);
    return anew({pair_of(first), pair_of(terms)...});
  }

  Real product(Real a, Real b) const { return sum(exact_product(a, b)); }
  Real product(const PairOf<Real>& x) const {
    return is_small(x.high * scale_) ? narrow_small(scaled(x)) : anew({x});
  }

  // Returns Q of n / d, d != 0. The candidate is at most one off, and its remainder is exact or noticed.
  Real quotient(Real n, Real d) const { return quotient(Pair<T>{base_of(n), 0}, Pair<T>{base_of(d), 0}); }
  Real quotient(Pair<T> n, Pair<T> d) const {
    const T sign = d.high < 0 ? T(-1) : T(1);
    d = d.scaled(sign);
    n = n.scaled(sign * scale_);
    const T candidate = n.high / d.high;
    if (is_small(candidate) && d.low == 0) [[likely]] {
      T whole = floor_of_small(candidate);
      const Pair<T> back = exact_product(whole, d.high);
      const TwoSum<T> high(n.high, -back.high);
      const TwoSum<T> low(n.low, -back.low);
      const TwoSum<T> both(high.sum, low.sum);
      if (high.error == 0 && low.error == 0 && both.error == 0) [[likely]] {
        T rest = both.sum;
        // Rounded only where -rest is below half of d (Sterbenz): no comparison below changes.
        const T step = rest < 0 ? T(-1) : rest >= d.high ? T(1) : T(0);
        whole += step;
        rest -= step * d.high;
        const T twice = rest + rest;
        return fit(round_whole(Whole<T>{whole, rest == 0, twice >= d.high, twice > d.high},
                               format_.rounding)) *
               ulp_;
      }
    }
    return quotient_anew(n, d);
  }

  // Says whether `count` additions of either step to a value of the format stay on its grid and in its range.
  bool holds_walk(Real value, const std::array<Real, 2>& step, std::int64_t count) const {
    const T first = base_of(step[0]) * scale_;
    const T second = base_of(step[1]) * scale_;
    const T start = base_of(value) * scale_;
    const T n = static_cast<T>(count);
    if (floor_of(first) != first || floor_of(second) != second) return false;
    // In range where both ends are: beyond 2^p a product may be rounded, and is out of range.
    const T low = start + n * std::min({T(0), first, second});
    const T high = start + n * std::max({T(0), first, second});
    return low >= min_ && high <= max_ && max_ < small_limit<T>;
  }

  std::int64_t raw(Real value) const { return to_integer(base_of(value) * scale_); }
  Real value(std::int64_t raw) const { return Real(raw) * Real(ulp_); }
  Real ulp() const { return ulp_; }

  // In ulps.
  T narrow_whole(const Whole<T>& x) const { return fit(round_whole(x, format_.rounding)); }
  // Whether what lies beyond 4 max may be any such value.
  bool saturates_at(T x) const {
    return (format_.overflow == Overflow::sat || format_.overflow == Overflow::sat_sym) &&
           magnitude(x) > 4 * (max_ + 1);
  }

 private:
  static bool is_small(T x) { return magnitude(x) < small_limit<T>; }
  Pair<T> scaled(const Pair<T>& x) const { return x.scaled(scale_); }
  T scaled(Real x) const { return base_of(x) * scale_; }
  static Pair<T> pair_of(Real x) { return {base_of(x), 0}; }
  static Pair<T> pair_of(const Pair<T>& x) { return x; }

  // x in ulps, |x| < small_limit; without a branch on the value.
  [[gnu::always_inline]] Real narrow_small(const Pair<T>& x) const {
    T whole = floor_of_small(x.high);
    const int no_fraction = whole == x.high;
    whole -= (no_fraction & (x.low < 0)) != 0 ? T(1) : T(0);
    const T middle = whole + T(0.5);
    const int tie = x.high == middle;
    const int above = x.high > middle;
    const Whole<T> parts{whole, (no_fraction & (x.low == 0)) != 0, (above | (tie & (x.low >= 0))) != 0,
                         (above | (tie & (x.low > 0))) != 0};
    return fit(round_whole(parts, format_.rounding)) * ulp_;
  }

  // Returns Q of the sum of the terms, taken in quadruple precision.
  [[gnu::noinline, gnu::cold]] Real anew(std::initializer_list<Pair<T>> terms) const {
    const Quantizer<Quad> wide(format_);
    ExactSum<Quad> all(Quad(0));
    for (const Pair<T>& term : terms) all.add(Pair<Quad>{term.high, term.low});
    const Pair<Quad> value = all.get().scaled(pow2<Quad>(format_.fraction()));
    if (!all.exact()) throw_inexact("sum in quadruple precision");
    if (wide.saturates_at(value.high)) return (value.high < 0 ? min_ : max_) * ulp_;
    return static_cast<T>(wide.narrow_whole(whole_of(value))) * ulp_;
  }
  // Returns Q of n / d in quadruple precision; n is in ulps.
  [[gnu::noinline, gnu::cold]] Real quotient_anew(const Pair<T>& n, const Pair<T>& d) const {
    const Quantizer<Quad> wide(format_);
    const Checked<Quad> top = Checked<Quad>(Quad(n.high)) + Checked<Quad>(Quad(n.low));
    const Checked<Quad> bottom = Checked<Quad>(Quad(d.high)) + Checked<Quad>(Quad(d.low));
    const Quad candidate = top.base() / bottom.base();
    if (wide.saturates_at(candidate)) return (candidate < 0 ? min_ : max_) * ulp_;
    const Whole<Checked<Quad>> x = whole_of_quotient(top, bottom);
    return static_cast<T>(wide.narrow_whole({x.whole.base(), x.integer, x.half_or_more, x.above_half})) *
           ulp_;
  }

  // Brings an integer n, in ulps, into the range.
  T fit(T n) const {
    if constexpr (RealTraits<Real>::checked) {
      if (format_.word - (format_.is_signed ? 1 : 0) > real_bits<Real>) throw_inexact("format's limit");
    }
    if (n >= min_ && n <= max_) [[likely]]
      return n;
    return overflow(n);
  }
  [[gnu::noinline]] T overflow(T n) const {
    const T modulus = pow2<T>(format_.word);
    const T half_modulus = pow2<T>(format_.word - 1);
    switch (format_.overflow) {
      case Overflow::sat:
      case Overflow::sat_sym:
        return n < min_ ? min_ : max_;
      case Overflow::sat_zero:
        return 0;
      case Overflow::wrap: {
        const T low = modulo(n, format_.word);
        return format_.is_signed && low >= half_modulus ? low - modulus : low;
      }
      case Overflow::wrap_sm: {
        // The bit above the kept ones becomes the sign; where the old sign bit differs, the rest is inverted.
        const bool sign = is_odd(floor_of(n * pow2<T>(-format_.word)));
        const bool old_sign = is_odd(floor_of(n * pow2<T>(1 - format_.word)));
        T low = modulo(n, format_.word - 1);
        if (sign != old_sign) low = half_modulus - 1 - low;
        return sign ? low - half_modulus : low;
      }
    }
    return 0;
  }
  // Returns n modulo 2^bits.
  static T modulo(T n, int bits) { return n - floor_of(n * pow2<T>(-bits)) * pow2<T>(bits); }

  T scale_ = 1, ulp_ = 1, max_ = 1, min_ = 0;
  Format format_;
};

}  // namespace bitspan::golden
