// SPDX-License-Identifier: Apache-2.0
// forward_difference of docs/numeric-spec.md: what stands in its registers, and which registers are wide
// enough.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "config/config.hpp"

namespace bitspan {

// curve.d0 to curve.d3.
using CurveFormats = std::array<Format, 4>;
CurveFormats curve_formats(const Config& config);

// d0 to d3, raw values of their formats.
using CurveRegisters = std::array<std::int64_t, 4>;

// A cubic of t, 0 <= t <= 1: the sum of power[i] 2^-fraction t^i.
struct CurveCoefficients {
  std::array<std::int64_t, 4> power{};
  int fraction = 0;
};

// A curve has 2^k steps, 0 <= k <= curve_k_limit.
inline constexpr int curve_k_limit = 12;

// Throws InputError where k or the fraction is not legal, or a sum may be wider than the views hold.
void check_curve(const CurveFormats& formats, int fraction, int k);

// The control points of cubics in Bezier's form: multiples of 2^-fraction, at most `largest` of them from 0.
struct ControlGrid {
  int fraction = 0;
  std::int64_t largest = 0;  // below 2^58
};

// The certificate. Returns nothing where no curve on the grid is ever rounded and none overflows: every point
// is that of the cubic, and the last one is the last control point, bit for bit. Else one line on the
// register that is too narrow and what it needs. 3 k fraction bits beyond the grid's are enough.
std::optional<std::string> curve_violation(const CurveFormats& formats, const ControlGrid& grid, int k);

// Of the error of each of the 2^k + 1 points, in coordinates, where nothing overflows; 0 where nothing is
// rounded.
double curve_error_bound(const CurveFormats& formats, int fraction, int k);

}  // namespace bitspan
