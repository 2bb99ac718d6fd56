// SPDX-License-Identifier: Apache-2.0
// forward_difference: the points of a cubic by three adders (C2).
#pragma once

#include <array>

#include "config/curve.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

struct ForwardDifferenceStage {
  std::array<Register, 4> d;
  int k = 0;
};
// Throws InputError as check_curve.
ForwardDifferenceStage prepare_forward_difference(const CurveFormats& formats, int fraction, int k);

// The registers at the first point.
CurveRegisters start_curve(const ForwardDifferenceStage& stage, const CurveCoefficients& curve);
// From one point to the next.
void forward_difference(const ForwardDifferenceStage& stage, CurveRegisters& d);

}  // namespace bitspan::model
