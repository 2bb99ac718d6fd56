// SPDX-License-Identifier: Apache-2.0
// Finds the error of a register that follows a line by adding a slope: h, f and the edge's x.
#pragma once

#include <string_view>

#include "config/config.hpp"
#include "study/bounds/error_sum.hpp"
#include "study/bounds/interval.hpp"
#include "study/bounds/unit_error.hpp"

namespace bitspan::bounds {

struct Slopes {
  SlopeForm form;
  UnitError unit;
  double shortest;  // the least length that is divided by
};

// The line through two registers that are `change` apart. acc = Q(start + step p + offset), then acc = Q(acc
// + step).
struct Line {
  FormatId step, acc;
  int start_grid;     // fraction bits of the value at the line's start
  int position_grid;  // fraction bits of p
  std::string_view offset_name;
  double offset;
  double distance;  // from the line's start, at most
  int additions;    // at most
  double change;    // |n|, at most
  double gradient;  // |n| <= gradient length + slack
  double slack;
};

struct WalkError {
  ErrorSum small;            // what roundings add
  double lost = 0;           // a saturated slope loses up to this much on the way from one end to the other
  Interval slope_error = 0;  // of the slope, relative
  double overshoot = 0;      // past the far end, by slope_error
  bool any = false;          // a slope may be anything
  bool capped = false;       // a slope's rounding counts by the change, not by the distance walked
  bool adds_up() const { return !any && !capped && lost == 0; }
};

WalkError walk_error(const Config& c, const Line& line, const Slopes& slopes);

}  // namespace bitspan::bounds
