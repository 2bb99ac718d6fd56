// SPDX-License-Identifier: Apache-2.0
// Exact growth: integers with a binary point, whose sums and products lose nothing.
//
// An Exact stands for raw 2^-fraction; fraction may be negative. Every operation is exact while its result
// fits 127 bits and a sign, which a legal configuration guarantees (docs/numeric-spec.md, "Exactness").
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace bitspan::model {

using int128 = __int128;
using uint128 = unsigned __int128;

// The number of bits of v without leading zeros; 0 for 0.
constexpr int bit_length(std::uint64_t v) { return 64 - std::countl_zero(v); }
constexpr int bit_length(uint128 v) {
  const auto high = static_cast<std::uint64_t>(v >> 64);
  return high != 0 ? 64 + bit_length(high) : bit_length(static_cast<std::uint64_t>(v));
}

struct Exact {
  int128 raw = 0;
  int fraction = 0;
};

// a with at least `fraction` fraction bits, as a raw value on that grid; a.fraction <= fraction.
constexpr int128 on_grid(Exact a, int fraction) { return a.raw << (fraction - a.fraction); }

constexpr Exact operator+(Exact a, Exact b) {
  const int fraction = std::max(a.fraction, b.fraction);
  return {on_grid(a, fraction) + on_grid(b, fraction), fraction};
}
constexpr Exact operator-(Exact a) { return {-a.raw, a.fraction}; }
constexpr Exact operator-(Exact a, Exact b) { return a + -b; }
constexpr Exact operator*(Exact a, Exact b) { return {a.raw * b.raw, a.fraction + b.fraction}; }

// a 2^-exponent.
constexpr Exact scaled(Exact a, int exponent) { return {a.raw, a.fraction + exponent}; }

constexpr int sign_of(Exact a) { return (a.raw > 0 ? 1 : 0) - (a.raw < 0 ? 1 : 0); }

// Largest integer <= n / d and the rest n - floor d, 0 <= rest < d; d > 0.
struct FloorQuotient {
  int128 floor;
  int128 rest;
};
constexpr FloorQuotient floor_divide(int128 n, int128 d) {
  int128 q = n / d;
  int128 r = n % d;
  if (r < 0) {
    r += d;
    --q;
  }
  return {q, r};
}

// floor(a), ceil(a).
constexpr int128 floor_of(Exact a) { return a.fraction <= 0 ? a.raw << -a.fraction : a.raw >> a.fraction; }
constexpr int128 ceil_of(Exact a) { return -floor_of(-a); }

}  // namespace bitspan::model
