// SPDX-License-Identifier: Apache-2.0
// Counts what a configuration costs in bits, from its formats alone. The counts are exact, and need neither
// synthesis nor a run.
//
// They describe a pipeline that has every stage of docs/numeric-spec.md once. Each stage takes one item at a
// time: a vertex, an edge, an end of a row, a row, a pixel. u and v stand side by side, and so do the four
// shades and the three colours. docs/search.md has both tables in full and says what is left out.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"
#include "study/metrics.hpp"

namespace bitspan {

// One row of docs/search.md's table of registers: a quantisation Q[...], and in how many places its value
// stands at once. A value that waits for others counts for each of them (three vertices, three edges, two
// ends of a row). A value that only passes through counts for the item that its stage is at.
struct RegisterRule {
  std::string_view stage;      // "setup", "setup.edge", ... as in the specification
  std::string_view name;       // "span.h", "coordinate", "depth.z", "reciprocal.row.output"
  int times;                   // where the condition holds
  std::string_view condition;  // "always", "dda", "delta_f, hyperbolic" ...
  bool (*used)(const Config&);
  int (*word)(const Config&);
};
const std::vector<RegisterRule>& register_rules();

// A register of one configuration, or a value that a table reciprocal rounds on its way.
struct RegisterPlace {
  std::string stage, name;
  int word = 0;
  int times = 0;
};
// Returns the registers of the configured modes, by stage. What is inside the reciprocal units follows at the
// end.
std::vector<RegisterPlace> register_places(const Config& config);

// A product of two numbers that are not constants, as one item of its stage needs it.
struct Multiplier {
  std::string stage, product;  // "span", "fu m"
  int a = 0, b = 0;  // widths of the operands: exact sums and differences in full, a sign bit where signed
  int times = 0;
};
std::vector<Multiplier> multipliers(const Config& config);

// Returns the sum of word times places over register_places, in bits: a whole number.
double register_bits(const Config& config);
// Returns the sum of a b times over multipliers, in square bits: a whole number.
double product_bits(const Config& config);
// Returns the bits of the fog table and of the tables of the reciprocal units. Each unit has a table of its
// own.
double table_bits(const Config& config);
// Adds the three by metric name: "cost.register_bits", "cost.product_bits", "cost.table_bits".
void add_costs(const Config& config, Metrics& metrics);
// Adds what the scenes take in memory under a configuration, "memory.*": the buffers of one picture of the
// scene that takes most, the texels that a textured pixel reads at most, and the caches.
void add_memory(const Config& config, std::span<const Scene> scenes, Metrics& metrics);
// Adds the clocks of the RTL, "timing.*", where the mode has RTL.
void add_timing(const Config& config, Metrics& metrics);

}  // namespace bitspan
