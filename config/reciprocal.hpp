// SPDX-License-Identifier: Apache-2.0
// What each kind of reciprocal unit with a table is made of, docs/numeric-spec.md, "Reciprocal": the table,
// and what the costs, the exact widths and the clocks count. model/ and golden/ compute their own tables.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "config/grid.hpp"

namespace bitspan {

// Raw on table_bits fraction bits, in the order in which the RTL's ROM holds the entries and the bounds
// enumerate them; empty for restoring.
std::vector<std::int64_t> reciprocal_table(const Reciprocal& unit);

// The same of RS: n in [1, 2), then n in [2, 4).
std::vector<std::int64_t> root_table(const RootUnit& unit);

struct ReciprocalParts {
  struct Held {
    std::string_view name;
    int bits = 0;
    int times = 0;
  };
  struct Product {
    std::string_view text;
    int a = 0, b = 0;  // bits of the operands
  };
  struct Width {
    std::string_view expression;
    int bits = 0;  // of a signed integer that holds it exactly
  };
  std::vector<Held> registers;
  std::vector<Product> products;
  std::vector<Width> exact;
  std::int64_t table_bits = 0;  // of the whole table
  int fraction = 0;             // of y
  int differences = 0;          // formed in a clock of their own, each behind a product
};
// Empty for restoring, whose parts depend on its operand.
ReciprocalParts parts_of(const Reciprocal& unit);

}  // namespace bitspan
