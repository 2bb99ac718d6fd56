// Reciprocal units: R_edge, R_row, R_pixel of docs/numeric-spec.md, "Reciprocal".
#pragma once

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

// A configured unit with its table. Cheap to copy: copies share the table.
class ReciprocalUnit {
 public:
  ReciprocalUnit() = default;
  // id: the register that observers see the output under.
  ReciprocalUnit(const Reciprocal& config, RegisterId id);

  // 1 / (d 2^-fraction). d <= 0 is taken as 1, one ulp of the operand's grid.
  template <class Watch>
  Inverse operator()(int128 d, int fraction, Watch watch) const;
  template <class Watch>
  Inverse operator()(Exact d, Watch watch) const {
    return (*this)(d.raw, d.fraction, watch);
  }

  // The value of a result, exactly.
  Exact value(Inverse r) const { return {r.m, output_.fraction + r.e}; }
  const Register& output() const { return output_; }
  const Reciprocal& config() const { return config_; }
  // Table entries, raw on table_bits fraction bits; empty for restoring.
  const std::vector<std::int64_t>& table() const { return *table_; }

 private:
  // y, an approximation of 1/n, and its fraction bits; d's highest set bit is `top`.
  template <class Int>
  Int approximate(Int d, int top, int& fraction) const;

  Reciprocal config_;
  Register output_;
  bool narrow_ = false;  // every intermediate fits int64
  std::shared_ptr<const std::vector<std::int64_t>> table_;
};

}  // namespace bitspan::model
