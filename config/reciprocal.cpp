// SPDX-License-Identifier: Apache-2.0
#include "config/reciprocal.hpp"

#include <algorithm>

#include "config/modes.hpp"

namespace bitspan {

std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit) {
  using Wide = __int128;
  const Wide segments = Wide{1} << unit.index_bits;
  std::vector<std::int64_t> table;
  // n / d to the nearest.
  const auto add = [&](Wide n, Wide d) {
    table.push_back(static_cast<std::int64_t>(((n << (unit.table_bits + 1)) + d) / (2 * d)));
  };
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      break;
    case ReciprocalKind::lut_linear:
      for (Wide i = 0; i <= segments; ++i) add(segments, segments + i);
      break;
    case ReciprocalKind::lut_newton:
      for (Wide j = 0; j < segments; ++j) add(2 * segments, 2 * segments + 2 * j + 1);
      break;
    case ReciprocalKind::lut_quadratic: {  // with k = 2^(index_bits + 1) + 2 j
      const Wide first = 2 * segments;
      const Wide last = 4 * segments;
      for (Wide k = first; k < last; k += 2) add(first, k);
      for (Wide k = first; k < last; k += 2) add(2 * first * (k + 3), k * (k + 1) * (k + 2));
      for (Wide k = first; k < last; k += 2) add(4 * first, k * (k + 1) * (k + 2));
      break;
    }
  }
  return table;
}

std::vector<std::int64_t> root_table(const RootUnit& unit) {
  std::vector<std::int64_t> out;
  const std::int64_t entries = std::int64_t{1} << unit.index_bits;
  for (int octave = 0; octave < 2; ++octave) {
    for (std::int64_t j = 0; j < entries; ++j) {
      // 2^table_bits / sqrt(x 2^-(index_bits + 1)), of the interval's middle; twice that, squared, and its
      // root.
      const std::int64_t x = (2 * (entries + j) + 1) << octave;
      const unsigned __int128 square =
          (static_cast<unsigned __int128>(1) << (2 * unit.table_bits + 2 + unit.index_bits + 1)) /
          static_cast<std::uint64_t>(x);
      unsigned __int128 twice = 0;
      for (int bit = unit.table_bits + 2; bit >= 0; --bit) {
        const unsigned __int128 more = twice | static_cast<unsigned __int128>(1) << bit;
        if (more * more <= square) twice = more;
      }
      out.push_back(static_cast<std::int64_t>((twice + 1) / 2));
    }
  }
  return out;
}

ReciprocalParts parts_of(const Reciprocal& unit) {
  const Grid nq{1, unit.operand_bits, false};
  const Grid entry{1, unit.table_bits, false};
  const Grid y{1, unit.internal_bits, false};
  const int t = unit.operand_bits - unit.index_bits;
  const ReciprocalParts::Width table_entry{"table entry", unit.table_bits + unit.index_bits + 3};
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      return {};
    case ReciprocalKind::lut_linear:
      return {.registers = {{"nq", nq.bits(), 1}, {"c", entry.bits(), 2}, {"y", y.bits(), 1}},
              .products = {{"(c(j) - c(j+1)) t", entry.bits(), t}},
              .exact = {table_entry,
                        {"c(j) - (c(j) - c(j+1)) t", std::max(unit.table_bits + t, unit.internal_bits) + 2}},
              .table_bits = table_entries(unit) * entry.bits(),
              .fraction = unit.internal_bits,
              .differences = 1};
    case ReciprocalKind::lut_newton: {
      ReciprocalParts parts{.registers = {{"nq", nq.bits(), 1}, {"y(0)", entry.bits(), 1}},
                            .products = {},
                            .exact = {table_entry},
                            .table_bits = table_entries(unit) * entry.bits(),
                            .fraction = unit.table_bits,
                            .differences = unit.steps};
      if (unit.steps == 0) return parts;
      const Grid a{2, unit.internal_bits, false};
      parts.registers.push_back({"a", a.bits(), unit.steps});
      parts.registers.push_back({"y", y.bits(), unit.steps});
      for (int step = 0; step < unit.steps; ++step) {
        const Grid before = step == 0 ? entry : y;
        parts.products.push_back({"nq y", nq.bits(), before.bits()});
        parts.products.push_back({"y (2 - a)", before.bits(), a.bits()});
      }
      const int widest = std::max(unit.table_bits, unit.internal_bits);
      parts.exact.push_back({"nq y", std::max(unit.operand_bits + widest, unit.internal_bits) + 3});
      parts.exact.push_back({"y (2 - a)", widest + unit.internal_bits + 4});
      parts.fraction = unit.internal_bits;
      return parts;
    }
    case ReciprocalKind::lut_quadratic: {
      // The leading zeros of c1 <= 2^-index_bits, c2 <= 2^-(2 index_bits) and g <= 2^-index_bits are not
      // kept.
      const int c1 = std::max(1, entry.bits() - unit.index_bits);
      const int c2 = std::max(1, entry.bits() - 2 * unit.index_bits);
      const int g = std::max(1, y.bits() - unit.index_bits);
      const std::int64_t segments = std::int64_t{1} << unit.index_bits;
      return {.registers = {{"nq", nq.bits(), 1},
                            {"c0", entry.bits(), 1},
                            {"c1", c1, 1},
                            {"c2", c2, 1},
                            {"g", g, 1},
                            {"y", y.bits(), 1}},
              .products = {{"c2 t", c2, t}, {"g t", g, t}},
              .exact = {{"table entry",
                         std::max(unit.table_bits + 2 * unit.index_bits + 8, 3 * unit.index_bits + 11)},
                        {"c1 - c2 t", std::max(unit.table_bits + t, unit.internal_bits) + 2},
                        {"c0 - g t", std::max(unit.table_bits, unit.internal_bits + t) + 2}},
              .table_bits = segments * (entry.bits() + c1 + c2),
              .fraction = unit.internal_bits,
              .differences = 2};
    }
  }
  unreachable();
}

}  // namespace bitspan
