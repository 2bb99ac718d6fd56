// SPDX-License-Identifier: Apache-2.0
// Gives the stages' make functions the Real that a run-time Arithmetic names. Clang's analyser loses a stage
// that is returned inside std::function and reports a leak; the address sanitizer, which sees the run, finds
// none.
#pragma once

#include "golden/arithmetic.hpp"
#include "golden/real.hpp"

namespace bitspan::golden {

// Calls make.operator()<Real>() with the type that `arithmetic` names.
template <class Make>
auto with_real(Arithmetic arithmetic, const Make& make) {
  switch (arithmetic.width) {
    case Width::f64:
      return arithmetic.checked ? make.template operator()<Checked<double>>()
                                : make.template operator()<double>();
    case Width::x87:
      return arithmetic.checked ? make.template operator()<Checked<long double>>()
                                : make.template operator()<long double>();
    case Width::quad:
      break;
  }
  return arithmetic.checked ? make.template operator()<Checked<Quad>>() : make.template operator()<Quad>();
}

}  // namespace bitspan::golden
