// SPDX-License-Identifier: Apache-2.0
// The model's vector forms of the span stage, as kernels of the benchmark.
#pragma once

#include "bench/span_case.hpp"

namespace bitspan::bench {

// Reads formats at run time; throws InputError where the configuration has no vector form.
SpanKernel make_vector(const SpanCase& c);
// Does the same with statistics of every register.
SpanKernel make_vector_observed(const SpanCase& c);
// Has formats compiled in; throws InputError where the configuration is not a shipped one.
SpanKernel make_specialised(const SpanCase& c);

}  // namespace bitspan::bench
