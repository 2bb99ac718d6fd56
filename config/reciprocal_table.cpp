#include "config/reciprocal_table.hpp"

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
  }
  return table;
}

}  // namespace bitspan
