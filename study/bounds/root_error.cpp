// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/root_error.hpp"

#include <algorithm>
#include <cmath>

#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {
namespace {

// An entry of the table, of the operand in the middle of its interval.
Interval entry_of(double middle, int bits) {
  const double one = std::ldexp(1.0, bits);
  const Interval nearest = Interval(one) / root_of(middle) + 0.5;
  return Interval(std::floor(nearest.lo), std::floor(nearest.hi)) * std::ldexp(1.0, -bits);
}

}  // namespace

// A root in double precision is correctly rounded.
Interval root_of(Interval x) {
  return {std::max(0.0, next_down(std::sqrt(std::max(0.0, x.lo)))), next_up(std::sqrt(std::max(0.0, x.hi)))};
}

// With z = y sqrt(n) - 1, a step without truncations gives -z^2 (3 + z) / 2. Its three truncations are a = n
// y - t1, c = a y - t2 and y' = y (3 - c) / 2 - t3. They add (1 + z) (t1 y + t2) / 2 - t3 sqrt(n).
UnitError root_error(const Config& config) {
  const RootUnit& unit = config.light_root;
  const Format& output = config.format(FormatId::light_root);
  const Interval cut(0, std::ldexp(1.0, -unit.internal_bits));
  // n is cut, and the operand is up to 2^-operand_bits of it larger.
  const Interval rest = 1 + Interval(0, std::ldexp(1.0, -unit.operand_bits - 1));
  const Interval step = rounding(output, unit.steps > 0 ? unit.internal_bits : unit.table_bits);
  const Interval range = values(output);
  const int entries = 1 << unit.index_bits;
  UnitError out;
  bool first = true;
  const auto join = [&](Interval z) {
    const Interval relative = (1 + z) * rest - 1;
    out.relative = first ? relative : hull(out.relative, relative);
    first = false;
  };
  for (const double octave : {1.0, 2.0}) {
    for (int j = 0; j < entries; ++j) {
      const auto at = [&](double place) { return octave * (1 + (j + place) / entries); };
      const Interval root = root_of({at(0), at(1)});
      Interval z = entry_of(at(0.5), unit.table_bits) * root - 1;
      for (int i = 0; i < unit.steps; ++i) {
        const Interval y = (1 + z) / root;
        z = -(square(z) * (3 + z)) * 0.5 + (1 + z) * (cut * y + cut) * 0.5 - cut * root;
      }
      join(z + step * root);
      if (((1 + z) / root).hi <= range.hi) continue;
      if (!saturates(output)) {
        out.any = true;
        return out;
      }
      join({(Interval(range.hi) * root.lo - 1).lo, z.hi});
    }
  }
  return out;
}

}  // namespace bitspan::bounds
