// SPDX-License-Identifier: Apache-2.0
// The span kernel in SystemC's fixed-point types. Free of SystemC itself.
#pragma once

#include "bench/span_case.hpp"

namespace bitspan::bench {

// Uses sc_fix and sc_ufix; takes any configuration of delta_f with a restoring reciprocal or lut_newton.
SpanKernel make_sc_fix(const SpanCase& c);
// Does the same in sc_fix_fast: it has doubles underneath, so products beyond 53 bits may round early.
SpanKernel make_sc_fix_fast(const SpanCase& c);
// Uses sc_fixed_fast with widths as template arguments, for depth16 alone. Throws InputError for other
// configurations.
SpanKernel make_sc_fixed_fast(const SpanCase& c);

}  // namespace bitspan::bench
