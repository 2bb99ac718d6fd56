#include "golden/reciprocal.hpp"

#include <algorithm>

#include "config/modes.hpp"

namespace bitspan::golden {

void throw_inexact(const char* what) {
  throw InexactError(std::string("golden: a ") + what + " is not exact in the type chosen for its stage");
}
void throw_not_raw() { throw std::logic_error("golden: a value is not on its format's grid"); }

std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit) {
  const std::int64_t segments = std::int64_t{1} << unit.index_bits;
  std::vector<std::int64_t> table;
  // 1 / (1 + at / segments)
  const auto add = [&](Quad at) {
    const Quad d = 1 + at * pow2<Quad>(-unit.index_bits);
    table.push_back(
        to_integer(round_whole(whole_of_quotient(pow2<Quad>(unit.table_bits), d), Rounding::rnd)));
  };
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      break;
    case ReciprocalKind::lut_linear:  // at both ends of each segment
      for (std::int64_t i = 0; i <= segments; ++i) add(Quad(i));
      break;
    case ReciprocalKind::lut_newton:  // in the middle of each segment
      for (std::int64_t i = 0; i < segments; ++i) add(Quad(i) + Quad(0.5));
      break;
    case ReciprocalKind::lut_quadratic: {
      // With x = 1 + i / segments and half a segment h: 1/x, and the differences of 1/x, 1/(x + h), 1/(x + 2
      // h).
      const Quad h = pow2<Quad>(-unit.index_bits - 1);
      const auto add_quotient = [&](Quad n, Quad d) {
        table.push_back(
            to_integer(round_whole(whole_of_quotient(n * pow2<Quad>(unit.table_bits), d), Rounding::rnd)));
      };
      const auto x = [&](std::int64_t i) { return 1 + Quad(2 * i) * h; };
      for (std::int64_t i = 0; i < segments; ++i) add(Quad(i));
      for (std::int64_t i = 0; i < segments; ++i) {
        add_quotient(2 * h * (x(i) + 3 * h), x(i) * (x(i) + h) * (x(i) + 2 * h));
      }
      for (std::int64_t i = 0; i < segments; ++i) {
        add_quotient(4 * h * h, x(i) * (x(i) + h) * (x(i) + 2 * h));
      }
      break;
    }
  }
  return table;
}

int lut_product_bits(const Reciprocal& unit) {
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      return 0;
    case ReciprocalKind::lut_linear:
      return unit.table_bits + 1 + std::max(unit.operand_bits - unit.index_bits, 0) + unit.table_bits;
    case ReciprocalKind::lut_newton:
      return std::max(unit.table_bits, unit.internal_bits + 1) + 1 +
             std::max(unit.operand_bits, unit.internal_bits);
    case ReciprocalKind::lut_quadratic:
      return std::max(unit.table_bits, unit.internal_bits) + 1 +
             std::max(unit.operand_bits - unit.index_bits, 0);
  }
  unreachable();
}

template <class Real>
ReciprocalUnit<Real>::ReciprocalUnit(const Reciprocal& unit, int operand_fraction)
    : kind_(unit.kind),
      normalize_(unit.normalize),
      steps_(unit.steps),
      single_(lut_product_bits(unit) <= real_bits<Real>),
      least_(pow2<Real>(-operand_fraction)),
      operand_scale_(pow2<Real>(unit.operand_bits)),
      operand_ulp_(pow2<Real>(-unit.operand_bits)),
      index_scale_(pow2<Real>(unit.index_bits)),
      internal_scale_(pow2<Real>(unit.internal_bits)),
      internal_ulp_(pow2<Real>(-unit.internal_bits)),
      output_(unit.output),
      quick_output_(unit.output) {
  for (const std::int64_t entry : reciprocal_table(unit)) {
    table_.push_back(Real(entry) * pow2<Real>(-unit.table_bits));
  }
}

template <class Real>
Real ReciprocalUnit<Real>::by_table(Real n) const {
  const Real nq = floor_of(n * operand_scale_) * operand_ulp_;
  const Real position = (nq - 1) * index_scale_;
  const Real j = floor_of(position);
  const Real t = position - j;
  switch (kind_) {
    case ReciprocalKind::restoring:  // has no table
      break;
    case ReciprocalKind::lut_linear: {
      const Real from = entry(j);
      const Real fall = from - entry(j + 1);
      if (single_) return cut(from - fall * t);
      return cut(ExactSum(-exact_product(fall, t)).add(base_of(from)).get());
    }
    case ReciprocalKind::lut_newton: {
      Real y = entry(j);
      for (int step = 0; step < steps_; ++step) {
        const Real a = single_ ? cut(nq * y) : cut(exact_product(nq, y));
        y = single_ ? cut(y * (2 - a)) : cut(exact_product(y, 2 - a));
      }
      return y;
    }
    case ReciprocalKind::lut_quadratic: {
      const Real segments = index_scale_;
      const Real value = entry(j);
      const Real slope = entry(segments + j);
      const Real curvature = entry(2 * segments + j);
      if (single_) return cut(value - cut(slope - curvature * t) * t);
      const Real g = cut(ExactSum(-exact_product(curvature, t)).add(base_of(slope)).get());
      return cut(ExactSum(-exact_product(g, t)).add(base_of(value)).get());
    }
  }
  unreachable();
}

template <class Real>
bool ReciprocalUnit<Real>::quick(const Column& d, std::size_t n, Column& m, Column& inverse_power,
                                 std::int64_t* e) const requires std::same_as<Real, double> {
  if (!normalize_ || !single_ || !quick_output_.usable) return false;
  const double to_ulps = 1 / output_.ulp();
  Column normal;
  lanes_split(d, n, normal, inverse_power, e);
  Column y;
  switch (kind_) {
    case ReciprocalKind::restoring:
      for (std::size_t i = 0; i < n; ++i) y.at[i] = 1;
      return lanes_narrow_quotient(y, normal, to_ulps, quick_output_, n, m) == 0;
    case ReciprocalKind::lut_linear:
    case ReciprocalKind::lut_quadratic:
      return false;
    case ReciprocalKind::lut_newton: {
      Column nq;
      lanes_cut(normal, operand_scale_, operand_ulp_, n, nq);
      lanes_position(nq, index_scale_, n, normal);
      for (std::size_t i = 0; i < n; ++i) y.at[i] = table_[static_cast<std::size_t>(normal.at[i])];
      for (int step = 0; step < steps_; ++step) lanes_newton(nq, internal_scale_, internal_ulp_, n, y);
      return lanes_narrow(y, to_ulps, quick_output_, n, m) == 0;
    }
  }
  unreachable();
}

// Member by member: clang 14 would take the whole class to include what Real excludes.
template ReciprocalUnit<double>::ReciprocalUnit(const Reciprocal&, int);
template double ReciprocalUnit<double>::by_table(double) const;
template ReciprocalUnit<long double>::ReciprocalUnit(const Reciprocal&, int);
template long double ReciprocalUnit<long double>::by_table(long double) const;
template ReciprocalUnit<Quad>::ReciprocalUnit(const Reciprocal&, int);
template Quad ReciprocalUnit<Quad>::by_table(Quad) const;
template ReciprocalUnit<Checked<double>>::ReciprocalUnit(const Reciprocal&, int);
template Checked<double> ReciprocalUnit<Checked<double>>::by_table(Checked<double>) const;
template ReciprocalUnit<Checked<long double>>::ReciprocalUnit(const Reciprocal&, int);
template Checked<long double> ReciprocalUnit<Checked<long double>>::by_table(Checked<long double>) const;
template ReciprocalUnit<Checked<Quad>>::ReciprocalUnit(const Reciprocal&, int);
template Checked<Quad> ReciprocalUnit<Checked<Quad>>::by_table(Checked<Quad>) const;
template bool ReciprocalUnit<double>::quick(const Column&, std::size_t, Column&, Column&,
                                            std::int64_t*) const;

}  // namespace bitspan::golden
