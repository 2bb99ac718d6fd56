// SPDX-License-Identifier: Apache-2.0
// Observers of registers: what each named quantisation saw in a run. A template parameter of everything that
// quantises; with NoObserve the calls compile to nothing.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "model/numeric/exact.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

// Unit of FieldStatistics::bias, in ulp of the register: 2^-bias_fraction.
inline constexpr int bias_fraction = 32;

// One register's history. Values are raw, on the register's grid, after rounding and BEFORE overflow, clamped
// to int64: so min and max say what range the register would have needed.
struct FieldStatistics {
  std::uint64_t count = 0;
  std::uint64_t wraps = 0;        // out of range in the modes SC_WRAP, SC_WRAP_SM
  std::uint64_t saturations = 0;  // out of range in the other modes
  std::int64_t min = 0;           // meaningless while count is 0
  std::int64_t max = 0;
  // Sum of (rounded - exact), in 2^-32 ulp; each exact value is taken to 2^-32 ulp downward.
  std::int64_t bias = 0;
  bool operator==(const FieldStatistics&) const = default;
};

// Word length that holds min..max: with the sign bit where is_signed. A register that never saw a value: 0.
int used_bits(const FieldStatistics& s, bool is_signed);

// All registers of a pipeline.
struct Statistics {
  std::array<FieldStatistics, register_count> fields{};
  const FieldStatistics& of(RegisterId id) const { return fields[static_cast<std::size_t>(id)]; }
  const FieldStatistics& of(FormatId id) const { return fields[static_cast<std::size_t>(id)]; }
};

struct NoObserve {
  static constexpr bool enabled = false;
};

struct Observe {
  static constexpr bool enabled = true;
  Statistics* statistics;
  // rounded: before overflow; in_range: the overflow mode had nothing to do; error: rounded - exact, 2^-32
  // ulp
  void note(const Register& r, int128 rounded, bool in_range, std::int64_t error) const;
};

}  // namespace bitspan::model
