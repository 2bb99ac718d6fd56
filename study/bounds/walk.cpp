// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/modes.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

WalkError walk_error(const Config& c, const Line& line, const Slopes& slopes) {
  const Format& step = c.format(line.step);
  const Format& acc = c.format(line.acc);
  WalkError out;
  const bool by_unit = shares_reciprocal(slopes.form);
  if (by_unit) {
    out.slope_error = slopes.unit.relative;
    out.any = slopes.unit.any;
  }
  out.overshoot = (Interval(line.change) * std::max(0.0, out.slope_error.hi)).hi;
  // Rounded to nearest, a slope moves by no more than itself, because 0 is a value of its register. So it
  // moves by no more than the change over the whole way. This counts where the ends are nearly equal.
  Interval rounded_slope = rounding(step) * Interval(0, line.distance);
  const double all = ((1 + out.slope_error) * line.change).hi;
  if (step.rounding != Rounding::trn && rounded_slope.mag() > all) {
    rounded_slope = Interval::plus_minus(all);
    out.capped = true;
  }
  out.small.add(key_of(line.step), rounded_slope);
  int grid = std::max(line.start_grid, step.fraction() + line.position_grid);
  if (line.offset != 0) grid = std::max(grid, acc.fraction() + 1);
  const Interval start = rounding(acc, grid);
  const Interval again = rounding(acc, std::max(acc.fraction(), step.fraction()));
  out.small.add(key_of(line.acc), start + again * Interval(0, line.additions));
  out.small.add(line.offset_name, line.offset);

  // The largest slope belongs to the shortest line. What its register cannot hold of it shortens the walk.
  const Interval range = values(step);
  const double top = std::max(0.0, std::min(-range.lo, range.hi));
  const Interval scale = 1 + out.slope_error;
  const auto change_over = [&](double length) {
    const Interval limited = Interval(line.gradient) * length + line.slack;
    return (scale * std::min(line.change, limited.hi)).hi;
  };
  const double steepest = (Interval(change_over(slopes.shortest)) / slopes.shortest).hi;
  const Interval rounded = Interval(steepest) + rounding(step);
  if (rounded.hi > top) {
    if (!saturates(step)) {
      out.any = true;
    } else {
      const double longest = top > 0 ? (Interval((scale * line.change).hi) / top).hi
                                     : std::numeric_limits<double>::infinity();  // its slope saturates
      const double most = std::isinf(longest) ? (scale * line.change).hi : change_over(longest);
      out.lost = std::max(0.0, (Interval(most) - Interval(top) * slopes.shortest).hi);
    }
  }
  return out;
}

}  // namespace bitspan::bounds
