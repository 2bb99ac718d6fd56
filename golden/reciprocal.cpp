#include "golden/reciprocal.hpp"

namespace bitspan::golden {

void throw_inexact(const char* what) {
  throw InexactError(std::string("golden: a ") + what + " is not exact in the type chosen for its stage");
}
void throw_not_raw() { throw std::logic_error("golden: a value is not on its format's grid"); }

std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit) {
  if (unit.kind == ReciprocalKind::restoring) return {};
  const bool linear = unit.kind == ReciprocalKind::lut_linear;
  const std::int64_t segments = std::int64_t{1} << unit.index_bits;
  std::vector<std::int64_t> table;
  for (std::int64_t i = 0; i < segments + (linear ? 1 : 0); ++i) {
    const Quad at = Quad(i) + (linear ? Quad(0) : Quad(0.5));
    const Quad d = 1 + at * pow2<Quad>(-unit.index_bits);
    table.push_back(
        to_integer(round_whole(whole_of_quotient(pow2<Quad>(unit.table_bits), d), Rounding::rnd)));
  }
  return table;
}

template <class Real>
ReciprocalUnit<Real>::ReciprocalUnit(const Reciprocal& unit, int operand_fraction)
    : kind_(unit.kind),
      normalize_(unit.normalize),
      steps_(unit.steps),
      least_(pow2<Real>(-operand_fraction)),
      operand_scale_(pow2<Real>(unit.operand_bits)),
      operand_ulp_(pow2<Real>(-unit.operand_bits)),
      index_scale_(pow2<Real>(unit.index_bits)),
      internal_scale_(pow2<Real>(unit.internal_bits)),
      internal_ulp_(pow2<Real>(-unit.internal_bits)),
      output_(unit.output) {
  for (const std::int64_t entry : reciprocal_table(unit)) {
    table_.push_back(Real(entry) * pow2<Real>(-unit.table_bits));
  }
}

template class ReciprocalUnit<double>;
template class ReciprocalUnit<long double>;
template class ReciprocalUnit<Quad>;
template class ReciprocalUnit<Checked<double>>;
template class ReciprocalUnit<Checked<long double>>;
template class ReciprocalUnit<Checked<Quad>>;

}  // namespace bitspan::golden
