#include "model/numeric/reciprocal.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/ratio.hpp"
#include "model/numeric/reciprocal-inl.hpp"

namespace bitspan::model {
namespace {

// floor(2^table_bits n / d + 1/2)
std::int64_t entry(int128 n, int128 d, int table_bits) {
  return static_cast<std::int64_t>(floor_divide((n << (table_bits + 1)) + d, 2 * d).floor);
}

std::vector<std::int64_t> make_table(const Reciprocal& c) {
  std::vector<std::int64_t> table;
  const int128 size = int128{1} << c.index_bits;
  switch (c.kind) {
    case ReciprocalKind::restoring:
      break;
    case ReciprocalKind::lut_linear:
      for (int128 i = 0; i <= size; ++i) {
        table.push_back(entry(size, size + i, c.table_bits));
      }
      break;
    case ReciprocalKind::lut_newton:
      for (int128 j = 0; j < size; ++j) {
        table.push_back(entry(2 * size, 2 * size + 2 * j + 1, c.table_bits));
      }
      break;
    case ReciprocalKind::lut_quadratic:  // value, slope and curvature: powers 0, 1 and 2 of t
      for (int power = 0; power <= 2; ++power) {
        for (int128 j = 0; j < size; ++j) {
          const int128 k = 2 * (size + j);
          const int128 cubic = k * (k + 1) * (k + 2);
          table.push_back(power == 0   ? entry(2 * size, k, c.table_bits)
                          : power == 1 ? entry(4 * size * (k + 3), cubic, c.table_bits)
                                       : entry(8 * size, cubic, c.table_bits));
        }
      }
      break;
  }
  return table;
}

}  // namespace

ReciprocalUnit::ReciprocalUnit(const Reciprocal& config, RegisterId id)
    : formats_(reciprocal_formats(config, id)),
      table_(std::make_shared<const std::vector<std::int64_t>>(make_table(config))) {}

template <class Watch>
Inverse reciprocal(const ReciprocalFormats& formats, const std::int64_t* table, int128 d, int fraction,
                   Watch watch) {
  const Reciprocal& config = formats.config;
  d = std::max<int128>(d, 1);
  const int top = bit_length(static_cast<uint128>(d)) - 1;
  const int exponent = top - fraction;
  if (!has_table(config.kind)) {
    return config.normalize ? Inverse{quantize_ratio(int128{1} << top, d, 0, formats.output, watch), exponent}
                            : Inverse{quantize_ratio(1, d, fraction, formats.output, watch), 0};
  }
  int y_fraction = 0;
  const auto leading = [&](auto wide) {
    return HWY_NAMESPACE::shifted_down(wide, top - config.operand_bits);
  };
  const int128 y = formats.fits_int64 && top < 62
                       ? int128{HWY_NAMESPACE::approximate(formats, table,
                                                           leading(static_cast<std::int64_t>(d)), y_fraction)}
                       : HWY_NAMESPACE::approximate(formats, table, leading(d), y_fraction);
  return config.normalize ? Inverse{quantize(y, y_fraction, formats.output, watch), exponent}
                          : Inverse{quantize(y, y_fraction + exponent, formats.output, watch), 0};
}

template Inverse reciprocal(const ReciprocalFormats&, const std::int64_t*, int128, int, NoObserve);
template Inverse reciprocal(const ReciprocalFormats&, const std::int64_t*, int128, int, Observe);

}  // namespace bitspan::model
