// SPDX-License-Identifier: Apache-2.0
// What a configuration costs in bits, from its formats alone: exact counts, without synthesis and without a
// run.
//
// The counts describe a pipeline that has every stage of docs/numeric-spec.md once, each of them taking one
// item at a time: a vertex, an edge, an end of a row, a row, a pixel. u and v, the four shades and the three
// colours stand side by side. docs/search.md has both tables in full and says what is left out.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// One row of docs/search.md's table of registers: a quantisation Q[...], and in how many places its value
// stands at once. A value that waits for others counts for each of them (three vertices, three edges, two
// ends of a row); one that only passes through counts for the item its stage is at.
struct RegisterRule {
  std::string_view stage;      // "setup", "setup.edge", ... as in the specification
  std::string_view name;       // "span.h", "coordinate", "depth.z", "reciprocal.row.output"
  int times;                   // where the condition holds
  std::string_view condition;  // "always", "dda", "delta_f, hyperbolic" ...
  bool (*used)(const Config&);
  int (*word)(const Config&);
};
const std::vector<RegisterRule>& register_rules();

// A register of one configuration; the values that a table reciprocal rounds on its way are among them.
struct RegisterPlace {
  std::string stage, name;
  int word = 0;
  int times = 0;
};
// Those of the configured modes, by stage; what is inside the reciprocal units follows at the end.
std::vector<RegisterPlace> register_places(const Config& config);

// A product of two numbers that are not constants, as one item of its stage needs it.
struct Multiplier {
  std::string stage, product;  // "span", "fu m"
  int a = 0, b = 0;  // widths of the operands: exact sums and differences in full, a sign bit where signed
  int times = 0;
};
std::vector<Multiplier> multipliers(const Config& config);

// Sum of word times places over register_places. Bits; a whole number.
double register_bits(const Config& config);
// Sum of a b times over multipliers. Square bits; a whole number.
double product_bits(const Config& config);
// Bits of the tables of the reciprocal units, each unit with a table of its own, and of the fog table.
double table_bits(const Config& config);
// The three by metric name: "cost.register_bits", "cost.product_bits", "cost.table_bits".
void add_costs(const Config& config, std::map<std::string, double, std::less<>>& metrics);

}  // namespace bitspan
