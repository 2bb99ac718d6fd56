// SPDX-License-Identifier: Apache-2.0
// How wide the exact values in front of each quantisation are, by worst-case growth from the formats.
#pragma once

#include <string>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// One expression of docs/numeric-spec.md that stands in front of a Q.
struct ExactIntermediate {
  std::string key;         // where it is narrowed to: "formats.span.f", "depth", "reciprocal.row", "raster"
  std::string stage;       // "setup", "setup.edge", "edge_walk", "plane_walk", "span_setup", ...
  std::string expression;  // as in the specification
  std::string formats;  // the formats it is made of, such as "span.f s41.8, reciprocal.pixel.output u19.18"
  int bits = 0;         // of a signed integer that holds the value on its own grid, or on the register's
                        // where that one is finer; of a quotient: of the scaled numerator or divisor
};

// Signed integer bits that model and RTL hold an exact value in.
inline constexpr int exact_bits_limit = 127;

// All expressions that the configured modes use, in the order of the stages.
std::vector<ExactIntermediate> exact_intermediates(const Config& config);

}  // namespace bitspan
