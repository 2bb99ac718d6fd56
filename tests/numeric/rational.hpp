// SPDX-License-Identifier: Apache-2.0
// The quantisation once more, slowly and differently: on exact rationals, by the sentences of SystemC's
// standard (nearest with a rule for ties; a range and what happens outside it), without shifts, guard or
// sticky bits.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>

#include "config/format.hpp"

namespace bitspan::reference {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

inline Integer power_of_two(int n) { return Integer{1} << n; }
inline Rational two_to(int n) {
  return n >= 0 ? Rational{power_of_two(n)} : Rational{Integer{1}, power_of_two(-n)};
}

inline Integer floor_of(const Rational& x) {
  const Integer n = numerator(x);
  const Integer d = denominator(x);
  Integer q = n / d;
  if (n % d < 0) {
    q -= 1;
  }
  return q;
}

// The integer that x, in ulp, is rounded to.
inline Integer rounded(const Rational& x, Rounding mode) {
  const Integer below = floor_of(x);
  const Rational part = x - below;
  if (part == 0) {
    return below;
  }
  const Integer above = below + 1;
  const Integer toward_zero = x < 0 ? above : below;
  const Integer away = x < 0 ? below : above;
  if (mode == Rounding::trn) {
    return below;
  }
  if (mode == Rounding::trn_zero) {
    return toward_zero;
  }
  const Rational half{1, 2};
  if (part != half) {
    return part < half ? below : above;
  }
  switch (mode) {
    case Rounding::rnd:
      return above;
    case Rounding::rnd_zero:
      return toward_zero;
    case Rounding::rnd_min_inf:
      return below;
    case Rounding::rnd_inf:
      return away;
    default:
      return below % 2 == 0 ? below : above;
  }
}

inline Integer modulo(const Integer& x, const Integer& n) {
  Integer r = x % n;
  if (r < 0) {
    r += n;
  }
  return r;
}

inline std::int64_t limited(const Integer& x, const Format& f) {
  const Integer max = power_of_two(f.is_signed ? f.word - 1 : f.word) - 1;
  const Integer lowest = f.is_signed ? Integer{-max - 1} : Integer{0};
  const Integer min = f.is_signed && f.overflow == Overflow::sat_sym ? Integer{-max} : lowest;
  if (x >= min && x <= max) {
    return static_cast<std::int64_t>(x);
  }
  const Integer all = power_of_two(f.word);
  const auto as_signed = [&](const Integer& code) {
    return static_cast<std::int64_t>(f.is_signed && code > max ? Integer{code - all} : code);
  };
  switch (f.overflow) {
    case Overflow::sat:
    case Overflow::sat_sym:
      return static_cast<std::int64_t>(x < min ? min : max);
    case Overflow::sat_zero:
      return 0;
    case Overflow::wrap:
      return as_signed(modulo(x, all));
    case Overflow::wrap_sm:
      break;
  }
  // The new sign is the bit above the kept ones; where the kept sign differs, the other kept bits are
  // inverted.
  const Integer half = all / 2;
  const Integer kept = modulo(x, all);
  const bool above = modulo(x, 2 * all) >= all;
  const bool sign = kept >= half;
  Integer rest = modulo(x, half);
  if (above != sign) {
    rest = half - 1 - rest;
  }
  return as_signed(above ? Integer{rest + half} : rest);
}

inline std::int64_t quantize(const Rational& x, const Format& f) {
  return limited(rounded(x * two_to(f.fraction()), f.rounding), f);
}

template <class Int>
Integer to_integer(Int v) {
  // __int128 goes in by halves.
  const auto wide = static_cast<__int128>(v);
  const bool negative = wide < 0;
  auto magnitude = static_cast<unsigned __int128>(wide);
  if (negative) {
    magnitude = 0 - magnitude;
  }
  Integer out = static_cast<std::uint64_t>(magnitude >> 64);
  out = (out << 64) + static_cast<std::uint64_t>(magnitude);
  return negative ? Integer{-out} : out;
}

}  // namespace bitspan::reference
