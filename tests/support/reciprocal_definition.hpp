// The reciprocal units by the text of docs/numeric-spec.md, "Reciprocal", on exact rationals. It shares
// nothing with the engines, which the tests of the model, of golden and of the RTL compare with it.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdlib>

#include "config/config.hpp"
#include "config/names.hpp"

namespace bitspan {

inline constexpr int reciprocal_kinds = static_cast<int>(enum_names<ReciprocalKind>.size());

struct ReciprocalByDefinition {
  boost::multiprecision::cpp_rational value;  // in front of Q[output]
  int e = 0;                                  // as it is delivered
};

// d > 0.
inline ReciprocalByDefinition reciprocal_by_definition(const Reciprocal& unit,
                                                       const boost::multiprecision::cpp_rational& d) {
  using Integer = boost::multiprecision::cpp_int;
  using Rational = boost::multiprecision::cpp_rational;
  const auto two_to = [](int exponent) {
    const Integer p = Integer(1) << std::abs(exponent);
    return exponent >= 0 ? Rational(p) : Rational(Integer(1), p);
  };
  const auto floor_of = [](const Rational& x) {
    const Integer n = numerator(x);
    const Integer q = n / denominator(x);
    return n < 0 && Rational(q) != x ? Integer(q - 1) : q;
  };
  const auto cut = [&](const Rational& x, int bits) {
    return Rational(floor_of(x * two_to(bits))) * two_to(-bits);
  };
  const Rational half(1, 2);

  int e = 0;
  while (two_to(e + 1) <= d) ++e;
  while (two_to(e) > d) --e;
  const Rational n = d * two_to(-e);
  const Rational nq = cut(n, unit.operand_bits);
  const Rational place = (nq - 1) * two_to(unit.index_bits);
  const Rational j(floor_of(place));
  const auto entry = [&](const Rational& i) {
    const Rational exact = two_to(unit.table_bits) / (1 + i * two_to(-unit.index_bits));
    return Rational(floor_of(exact + half)) * two_to(-unit.table_bits);
  };

  Rational y;
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      y = 1 / n;
      break;
    case ReciprocalKind::lut_linear: {
      const Rational from = entry(j);
      const Rational to = entry(j + 1);
      y = cut(from - (from - to) * (place - j), unit.internal_bits);
      break;
    }
    case ReciprocalKind::lut_quadratic: {
      // The parabola through both ends and the middle of the segment.
      const auto exact = [&](const Rational& i) { return 1 / (1 + i * two_to(-unit.index_bits)); };
      const auto rounded = [&](const Rational& x) {
        return Rational(floor_of(x * two_to(unit.table_bits) + half)) * two_to(-unit.table_bits);
      };
      const Rational from = exact(j);
      const Rational middle = exact(j + half);
      const Rational to = exact(j + 1);
      const Rational slope = rounded(3 * from - 4 * middle + to);
      const Rational curvature = rounded(2 * from - 4 * middle + 2 * to);
      const Rational t = place - j;
      const Rational g = cut(slope - curvature * t, unit.internal_bits);
      y = cut(rounded(from) - g * t, unit.internal_bits);
      break;
    }
    case ReciprocalKind::lut_newton:
      y = entry(j + half);
      for (int step = 0; step < unit.steps; ++step) {
        const Rational a = cut(nq * y, unit.internal_bits);
        y = cut(y * (2 - a), unit.internal_bits);
      }
      break;
  }
  if (unit.normalize) return {y, e};
  return {y * two_to(-e), 0};
}

}  // namespace bitspan
