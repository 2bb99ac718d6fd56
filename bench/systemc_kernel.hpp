// The span kernel in SystemC's fixed-point types. Free of SystemC itself.
#pragma once

#include "bench/span_case.hpp"

namespace bitspan::bench {

// sc_fix and sc_ufix, any configuration of delta_f with a restoring reciprocal or lut_newton.
SpanKernel make_sc_fix(const SpanCase& c);
// The same in sc_fix_fast: doubles underneath, so products beyond 53 bits may round early.
SpanKernel make_sc_fix_fast(const SpanCase& c);
// sc_fixed_fast, its widths the template arguments; depth16's alone. Throws InputError for others.
SpanKernel make_sc_fixed_fast(const SpanCase& c);

}  // namespace bitspan::bench
