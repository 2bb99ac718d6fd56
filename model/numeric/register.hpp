// SPDX-License-Identifier: Apache-2.0
// A register: a format prepared for quantising, with a name under which observers keep its history.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "config/config.hpp"
#include "config/format.hpp"
#include "model/numeric/exact.hpp"
#include "model/numeric/rounding.hpp"

namespace bitspan::model {

// First the configurable formats, by the numbers of FormatId, then the registers whose format has another
// key.
enum class RegisterId : std::uint8_t {
  coordinate = static_cast<std::uint8_t>(FormatId::count),
  depth_z,
  edge_reciprocal,
  row_reciprocal,
  pixel_reciprocal,
  count
};
inline constexpr int register_count = static_cast<int>(RegisterId::count);
constexpr RegisterId id_of(FormatId id) { return static_cast<RegisterId>(id); }
// "span.h" ..., "coordinate", "depth.z", "reciprocal.edge.output" ...
std::string_view name_of(RegisterId id);
// The format the configuration gives a register.
constexpr Format format_of(RegisterId id, const Config& config) {
  switch (id) {
    case RegisterId::coordinate:
      return config.coordinate_format();
    case RegisterId::depth_z:
      return config.depth_format();
    case RegisterId::edge_reciprocal:
      return config.edge_reciprocal.output;
    case RegisterId::row_reciprocal:
      return config.row_reciprocal.output;
    case RegisterId::pixel_reciprocal:
      return config.pixel_reciprocal.output;
    default:
      return config.format(static_cast<FormatId>(id));
  }
}

struct Register {
  std::int64_t min = 0;  // in range where min <= rounded <= max; SC_SAT_SYM excludes the lowest code
  std::int64_t max = 0;
  int fraction = 0;
  std::uint16_t rounding = 0;  // rounding_table of the mode
  Rounding mode = Rounding::trn;
  Overflow overflow = Overflow::sat;
  RegisterId id = RegisterId::count;
  int word = 1;
  bool is_signed = false;
  bool operator==(const Register&) const = default;
};

constexpr Register make_register(const Format& f, RegisterId id = RegisterId::count) {
  Register r;
  const int magnitude = f.is_signed ? f.word - 1 : f.word;
  r.max = static_cast<std::int64_t>((std::uint64_t{1} << magnitude) - 1);
  r.min = f.is_signed ? (f.overflow == Overflow::sat_sym ? -r.max : -r.max - 1) : 0;
  r.fraction = f.fraction();
  r.rounding = rounding_table(f.rounding);
  r.mode = f.rounding;
  r.overflow = f.overflow;
  r.id = id;
  r.word = f.word;
  r.is_signed = f.is_signed;
  return r;
}

constexpr Register make_register(const Config& config, FormatId id) {
  return make_register(config.format(id), id_of(id));
}

// Whether r rounds by adding a constant and saturates, so that quantising into it needs no branch.
constexpr bool is_branch_free(const Register& r) {
  return (r.mode == Rounding::trn || r.mode == Rounding::rnd || r.mode == Rounding::rnd_min_inf) &&
         (r.overflow == Overflow::sat || r.overflow == Overflow::sat_sym);
}

// The raw value of a register as an exact number.
constexpr Exact value_of(std::int64_t raw, const Register& r) { return {raw, r.fraction}; }

}  // namespace bitspan::model
