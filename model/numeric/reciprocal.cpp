#include "model/numeric/reciprocal.hpp"

#include <algorithm>

#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

// floor(2^table_bits n / d + 1/2)
std::int64_t entry(int128 n, int128 d, int table_bits) {
  return static_cast<std::int64_t>(floor_divide((n << (table_bits + 1)) + d, 2 * d).floor);
}

std::vector<std::int64_t> make_table(const Reciprocal& c) {
  std::vector<std::int64_t> table;
  if (c.kind == ReciprocalKind::restoring) {
    return table;
  }
  const int128 size = int128{1} << c.index_bits;
  if (c.kind == ReciprocalKind::lut_linear) {
    for (int128 i = 0; i <= size; ++i) {
      table.push_back(entry(size, size + i, c.table_bits));
    }
  } else {
    for (int128 j = 0; j < size; ++j) {
      table.push_back(entry(2 * size, 2 * size + 2 * j + 1, c.table_bits));
    }
  }
  return table;
}

// v 2^-shift, rounded down; shift of either sign.
template <class Int>
Int shift_down(Int v, int shift) {
  return shift >= 0 ? v >> shift : v << -shift;
}

}  // namespace

ReciprocalUnit::ReciprocalUnit(const Reciprocal& config, RegisterId id)
    : config_(config),
      output_(make_register(config.output, id)),
      table_(std::make_shared<const std::vector<std::int64_t>>(make_table(config))) {
  // Widest intermediates: the interpolation's product; nq y and y (2 - a) of a Newton step.
  const int y_bits = std::max(config.table_bits, config.internal_bits);
  const int t_bits = std::max(0, config.operand_bits - config.index_bits);
  narrow_ = config.table_bits + t_bits + 2 <= 62 && config.operand_bits + y_bits + 3 <= 62 &&
            y_bits + config.internal_bits + 3 <= 62;
}

template <class Int>
Int ReciprocalUnit::approximate(Int d, int top, int& fraction) const {
  const int p = config_.index_bits;
  const int operand = config_.operand_bits;
  const std::vector<std::int64_t>& table = *table_;
  const Int nq = shift_down(d, top - operand);
  const Int rest = nq - (Int{1} << operand);
  const auto j = static_cast<std::size_t>(shift_down(rest, operand - p));
  if (config_.kind == ReciprocalKind::lut_linear) {
    const int t_bits = std::max(0, operand - p);
    const Int t = rest & ((Int{1} << t_bits) - 1);
    const Int c = table[j];
    const Int y = (c << t_bits) - (c - table[j + 1]) * t;
    fraction = config_.internal_bits;
    return shift_down(y, config_.table_bits + t_bits - config_.internal_bits);
  }
  Int y = table[j];
  fraction = config_.table_bits;
  for (int i = 0; i < config_.steps; ++i) {
    const Int a = shift_down(nq * y, operand + fraction - config_.internal_bits);
    y = shift_down(y * ((Int{2} << config_.internal_bits) - a), fraction);
    fraction = config_.internal_bits;
  }
  return y;
}

template <class Watch>
Inverse ReciprocalUnit::operator()(int128 d, int fraction, Watch watch) const {
  d = std::max<int128>(d, 1);
  const int top = bit_length(static_cast<uint128>(d)) - 1;
  const int exponent = top - fraction;
  if (config_.kind == ReciprocalKind::restoring) {
    return config_.normalize ? Inverse{quantize_ratio(int128{1} << top, d, 0, output_, watch), exponent}
                             : Inverse{quantize_ratio(1, d, fraction, output_, watch), 0};
  }
  int y_fraction = 0;
  const bool narrow = narrow_ && top < 62;
  const int128 y = narrow ? int128{approximate(static_cast<std::int64_t>(d), top, y_fraction)}
                          : approximate(d, top, y_fraction);
  return config_.normalize ? Inverse{quantize(y, y_fraction, output_, watch), exponent}
                           : Inverse{quantize(y, y_fraction + exponent, output_, watch), 0};
}

template Inverse ReciprocalUnit::operator()(int128, int, NoObserve) const;
template Inverse ReciprocalUnit::operator()(int128, int, Observe) const;

}  // namespace bitspan::model
