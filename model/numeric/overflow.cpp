// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/overflow.hpp"

namespace bitspan::model {
namespace {

// The low `word` bits of v, the highest of them a sign where is_signed.
std::int64_t keep(uint128 v, int word, bool is_signed) {
  const auto bits = static_cast<std::uint64_t>(v) << (64 - word);
  return is_signed ? static_cast<std::int64_t>(bits) >> (64 - word)
                   : static_cast<std::int64_t>(bits >> (64 - word));
}

}  // namespace

std::int64_t overflow(uint128 low, bool negative, const Register& r) {
  switch (r.overflow) {
    case Overflow::wrap:
      return keep(low, r.word, r.is_signed);
    case Overflow::sat:
    case Overflow::sat_sym:
      return negative ? r.min : r.max;
    case Overflow::sat_zero:
      return 0;
    case Overflow::wrap_sm: {
      const bool sign = ((low >> r.word) & 1) != 0;
      const bool old_sign = ((low >> (r.word - 1)) & 1) != 0;
      const uint128 sign_bit = uint128{1} << (r.word - 1);
      const uint128 rest = (sign == old_sign ? low : ~low) & (sign_bit - 1);
      return keep(rest | (sign ? sign_bit : 0), r.word, true);
    }
  }
  return 0;
}

}  // namespace bitspan::model
