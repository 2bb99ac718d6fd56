// Reciprocal units: R_edge, R_row, R_pixel of docs/numeric-spec.md, "Reciprocal".
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {

// Stands for m 2^-e, m raw on the unit's output format.
struct Inverse {
  std::int64_t m = 0;
  int e = 0;
};

// What a unit computes by, its table apart: known from the configuration alone.
struct ReciprocalFormats {
  Reciprocal config;
  Register output;
  bool fits_int64 = false;  // every intermediate of approximate() fits 62 bits
  bool operator==(const ReciprocalFormats&) const = default;
};
// Bits of the widest intermediate of a unit with a table, and of its result.
constexpr int widest_bits(const Reciprocal& c) {
  switch (c.kind) {
    case ReciprocalKind::restoring:
      return 0;
    case ReciprocalKind::lut_linear:  // the interpolation's product
      return std::max(c.table_bits + std::max(0, c.operand_bits - c.index_bits), c.internal_bits) + 2;
    case ReciprocalKind::lut_quadratic:  // c1 - c2 t and c0 - g t
      return std::max(c.table_bits, c.internal_bits) + std::max(0, c.operand_bits - c.index_bits) + 2;
    case ReciprocalKind::lut_newton:  // nq y and y (2 - a) of a step
      return std::max(c.table_bits, c.internal_bits) + std::max(c.operand_bits, c.internal_bits) + 3;
  }
  unreachable();
}
constexpr ReciprocalFormats reciprocal_formats(const Reciprocal& c, RegisterId id) {
  return {c, make_register(c.output, id), widest_bits(c) <= 62};
}

// 1 / (d 2^-fraction). d <= 0 is taken as 1, one ulp of the operand's grid. table: of ReciprocalUnit.
template <class Watch>
Inverse reciprocal(const ReciprocalFormats& formats, const std::int64_t* table, int128 d, int fraction,
                   Watch watch);

// A configured unit with its table. Cheap to copy: copies share the table.
class ReciprocalUnit {
 public:
  ReciprocalUnit() = default;
  // id: the register that observers see the output under.
  ReciprocalUnit(const Reciprocal& config, RegisterId id);

  template <class Watch>
  Inverse operator()(int128 d, int fraction, Watch watch) const {
    return reciprocal(formats_, table_->data(), d, fraction, watch);
  }
  template <class Watch>
  Inverse operator()(Exact d, Watch watch) const {
    return (*this)(d.raw, d.fraction, watch);
  }

  // The value of a result, exactly.
  Exact value(Inverse r) const { return {r.m, formats_.output.fraction + r.e}; }
  const Register& output() const { return formats_.output; }
  const ReciprocalFormats& formats() const { return formats_; }
  const Reciprocal& config() const { return formats_.config; }
  // Table entries, raw on table_bits fraction bits; empty for restoring.
  const std::vector<std::int64_t>& table() const { return *table_; }

 private:
  ReciprocalFormats formats_;
  std::shared_ptr<const std::vector<std::int64_t>> table_;
};

}  // namespace bitspan::model
