// SPDX-License-Identifier: Apache-2.0
// The reciprocal square root RS of docs/numeric-spec.md, "Reciprocal square root": a table, and Newton steps.
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {

struct ReciprocalRoot {
  RootUnit unit;
  Register output;
  std::vector<std::int64_t> table;  // in 2^-table_bits; first for n below 2

  ReciprocalRoot() = default;
  explicit ReciprocalRoot(const Config& config);
};

// Stands for m 2^-e; m is a raw value of the output.
struct Root {
  std::int64_t m = 0;
  int e = 0;
};
// 1 / sqrt(d) of d > 0.
template <class Watch>
Root reciprocal_root(const ReciprocalRoot& root, Exact d, Watch watch);

}  // namespace bitspan::model
