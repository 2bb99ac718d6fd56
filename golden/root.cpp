// SPDX-License-Identifier: Apache-2.0
#include "golden/root.hpp"

namespace bitspan::golden {

std::vector<std::int64_t> root_table(const RootUnit& unit) {
  std::vector<std::int64_t> out;
  const Quad entries = pow2<Quad>(unit.index_bits);
  const Quad one = pow2<Quad>(unit.table_bits);
  for (const Quad octave : {Quad(1), Quad(2)}) {
    for (Quad j = 0; j < entries; j += 1) {
      const Quad x = octave * (1 + (j + Quad(0.5)) / entries);
      // The root is a candidate. t is one too large where t - 1/2 is above one / sqrt(x): by the squares,
      // which are exact.
      Quad t = floorq(one / sqrtq(x) + Quad(0.5));
      const auto is_above = [&](Quad half) { return half * half * x > one * one; };
      while (is_above(t - Quad(0.5))) t -= 1;
      while (!is_above(t + Quad(0.5))) t += 1;
      out.push_back(to_integer(t));
    }
  }
  return out;
}

}  // namespace bitspan::golden
