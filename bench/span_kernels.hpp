// SPDX-License-Identifier: Apache-2.0
// Every way of computing a span that the benchmark compares, by name.
#pragma once

#include <string_view>
#include <vector>

#include "bench/span_case.hpp"

namespace bitspan::bench {

struct NamedKernel {
  std::string_view name;
  SpanKernel (*make)(const SpanCase& c);  // throws InputError where it cannot run this configuration
  bool exact = true;                      // bit-identical to the model
};
std::vector<NamedKernel> span_kernels();

}  // namespace bitspan::bench
