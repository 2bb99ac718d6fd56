// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/from_double.hpp"

#include <bit>
#include <cstdint>

namespace bitspan::model {

Exact exact_of(double x) {
  constexpr int mantissa_bits = 52;
  constexpr int bias = 1023;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const int field = static_cast<int>((bits >> mantissa_bits) & 0x7ff);
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << mantissa_bits) - 1);
  if (field != 0) {
    mantissa |= std::uint64_t{1} << mantissa_bits;
  }
  if (mantissa == 0) {
    return {};
  }
  const int zeros = std::countr_zero(mantissa);
  const auto raw = static_cast<int128>(mantissa >> zeros);
  const int exponent = (field != 0 ? field : 1) - bias - mantissa_bits + zeros;
  return {(bits >> 63) != 0 ? -raw : raw, -exponent};
}

int ceil_log2(double x) {
  const Exact e = exact_of(x);
  return bit_length(static_cast<uint128>(e.raw)) - (e.raw == 1 ? 1 : 0) - e.fraction;
}

}  // namespace bitspan::model
