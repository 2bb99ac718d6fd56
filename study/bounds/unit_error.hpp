// SPDX-License-Identifier: Apache-2.0
// Proves from a reciprocal unit's formats and table how far its m 2^-e is from 1 / d.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "study/bounds/interval.hpp"

namespace bitspan::bounds {

// m 2^-e = (1 + relative) / d.
struct UnitError {
  Interval relative = 0;
  bool any = false;  // m may be anything its format holds
};

// A run of a table's entries. `restoring` has one run, of all operands.
struct TablePart {
  Interval operand;   // n, within 1..2
  Interval table;     // y nq - 1 of an entry, or of the curve through entries, whose value is then cut
  Interval relative;  // y n - 1 in front of the output's rounding
};

class Unit {
 public:
  explicit Unit(const Reciprocal& unit);
  // Returns at most 16 runs, in the order of n.
  const std::vector<TablePart>& parts() const { return parts_; }
  // Returns the error over the operands `d`, which are above 0.
  UnitError error(Interval d) const;

 private:
  Interval segment(std::int64_t j) const;
  double table_value(std::int64_t i) const;
  Interval computed(Interval nq, Interval e) const;
  Interval with_rest(Interval e) const;

  Reciprocal r_;
  std::vector<std::int64_t> table_;
  std::vector<TablePart> parts_;
  std::optional<int> fraction_;  // of y, before the output's rounding
};

}  // namespace bitspan::bounds
