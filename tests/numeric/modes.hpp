// SPDX-License-Identifier: Apache-2.0
// Every pair of a rounding and an overflow mode, and formats over them.
#pragma once

#include <array>
#include <random>

#include "config/format.hpp"

namespace bitspan {

inline constexpr std::array all_roundings{Rounding::rnd,     Rounding::rnd_zero, Rounding::rnd_min_inf,
                                          Rounding::rnd_inf, Rounding::rnd_conv, Rounding::trn,
                                          Rounding::trn_zero};
inline constexpr std::array all_overflows{Overflow::wrap, Overflow::sat, Overflow::sat_zero,
                                          Overflow::sat_sym, Overflow::wrap_sm};
static_assert(all_roundings.size() == rounding_modes && all_overflows.size() == overflow_modes);

// SC_WRAP_SM exists for signed formats only.
inline bool legal(const Format& f) { return f.is_signed || f.overflow != Overflow::wrap_sm; }

// Calls run(format) for every legal combination of modes with this shape.
template <class Run>
void for_all_modes(int word, int integer, bool is_signed, Run run) {
  for (const Rounding rounding : all_roundings) {
    for (const Overflow overflow : all_overflows) {
      const Format f{word, integer, is_signed, rounding, overflow, false};
      if (legal(f)) {
        run(f);
      }
    }
  }
}

inline int random_int(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

// Any number of bits up to max_bits, so that small values are as likely as large ones; either sign.
inline __int128 random_value(std::mt19937_64& random, int max_bits) {
  const int bits = random_int(random, 0, max_bits);
  if (bits == 0) {
    return 0;
  }
  auto v = static_cast<unsigned __int128>(random()) << 64 | random();
  v >>= 128 - bits;
  // Half of them with a long run of equal bits below: ties, and all but ties.
  if (random_int(random, 0, 1) == 0) {
    const int run = random_int(random, 0, bits);
    const unsigned __int128 mask = (static_cast<unsigned __int128>(1) << run) - 1;
    v &= ~mask;
    const int kind = random_int(random, 0, 3);
    if (kind == 1 && run > 0) {
      v |= static_cast<unsigned __int128>(1) << (run - 1);
    } else if (kind == 2) {
      v |= mask;
    } else if (kind == 3 && run > 0) {
      v |= mask >> 1;
    }
  }
  const auto value = static_cast<__int128>(v);
  return random_int(random, 0, 1) == 0 ? value : -value;
}

inline Format random_format(std::mt19937_64& random) {
  for (;;) {
    Format f;
    f.is_signed = random_int(random, 0, 1) != 0;
    f.word = random_int(random, 1, f.is_signed ? 64 : 63);
    f.integer = random_int(random, -20, f.word + 20);
    f.rounding = all_roundings[static_cast<std::size_t>(random_int(random, 0, rounding_modes - 1))];
    f.overflow = all_overflows[static_cast<std::size_t>(random_int(random, 0, overflow_modes - 1))];
    if (legal(f)) {
      return f;
    }
  }
}

}  // namespace bitspan
