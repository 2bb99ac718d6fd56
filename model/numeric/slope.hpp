// Slope(n, d, form, R, name) of docs/numeric-spec.md: the one way an edge's or a row's slope is formed.
#pragma once

#include "config/config.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"

namespace bitspan::model {

// A length that slopes are divided by, with its reciprocal where the form takes one (m = e = 0 with divide).
struct Length {
  Exact d;           // > 0
  Exact reciprocal;  // m 2^-e
  Inverse inverse;
  SlopeForm form = SlopeForm::divide;
};

template <class Watch>
Length make_length(Exact d, SlopeForm form, const ReciprocalUnit& unit, Watch watch);

template <class Watch>
std::int64_t slope(Exact n, const Length& length, const Register& r, Watch watch);

}  // namespace bitspan::model
