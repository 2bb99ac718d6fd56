// Reciprocal units: R_edge, R_row, R_pixel of docs/numeric-spec.md, "Reciprocal".
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "config/config.hpp"
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
  bool narrow = false;  // every intermediate of approximate() fits 62 bits
  bool operator==(const ReciprocalFormats&) const = default;
};
constexpr ReciprocalFormats reciprocal_formats(const Reciprocal& c, RegisterId id) {
  // Widest intermediates: the interpolation's product; nq y and y (2 - a) of a Newton step.
  const int y_bits = std::max(c.table_bits, c.internal_bits);
  const int t_bits = std::max(0, c.operand_bits - c.index_bits);
  return {c, make_register(c.output, id),
          c.table_bits + t_bits + 2 <= 62 && c.operand_bits + y_bits + 3 <= 62 &&
              y_bits + c.internal_bits + 3 <= 62};
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
