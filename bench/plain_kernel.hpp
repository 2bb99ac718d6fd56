// SPDX-License-Identifier: Apache-2.0
// The span kernel as one writes it by hand for one configuration: int64, every width a constant.
#pragma once

#include "bench/span_case.hpp"

namespace bitspan::bench {

// Makes the kernel for depth16, with its own pixel reciprocal or with a restoring one of the same output. Its
// values are right where h + B is 1/2 or more. Throws InputError for other configurations.
SpanKernel make_plain(const SpanCase& c);

// Returns depth16 with a restoring pixel reciprocal: one integer division per pixel.
Config restoring_of(Config depth16);

}  // namespace bitspan::bench
