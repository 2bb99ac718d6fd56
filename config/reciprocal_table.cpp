#include "config/reciprocal_table.hpp"

namespace bitspan {

std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit) {
  const std::int64_t segments = std::int64_t{1} << unit.index_bits;
  std::vector<std::int64_t> table;
  // n / d, to the nearest; at most 40 + 13 + 2 bits.
  const auto add = [&](std::int64_t n, std::int64_t d) {
    const __int128 twice = (static_cast<__int128>(n) << (unit.table_bits + 1)) + d;
    table.push_back(static_cast<std::int64_t>(twice / (2 * d)));
  };
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      break;
    case ReciprocalKind::lut_linear:
      for (std::int64_t i = 0; i <= segments; ++i) add(segments, segments + i);
      break;
    case ReciprocalKind::lut_newton:
      for (std::int64_t j = 0; j < segments; ++j) add(2 * segments, 2 * segments + 2 * j + 1);
      break;
  }
  return table;
}

}  // namespace bitspan
