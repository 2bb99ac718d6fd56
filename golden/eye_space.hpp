// SPDX-License-Identifier: Apache-2.0
// Points as the eye has them: the eye is at 0, x runs to the right, y down, z along the view axis, all in the
// unit of s. What is done there with scenes is exact but for the rounding of long doubles.
#pragma once

#include <algorithm>
#include <cmath>

#include "scene/scene.hpp"

namespace bitspan::golden {

struct EyePoint {
  long double x = 0, y = 0, z = 0;
};
inline EyePoint operator+(const EyePoint& a, const EyePoint& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline EyePoint operator-(const EyePoint& a, const EyePoint& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline EyePoint operator*(const EyePoint& a, long double k) { return {a.x * k, a.y * k, a.z * k}; }
inline long double dot(const EyePoint& a, const EyePoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline EyePoint cross(const EyePoint& a, const EyePoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline long double length(const EyePoint& a) { return std::sqrt(dot(a, a)); }

inline EyePoint eye_point(const ScreenPoint& p, const View& view) {
  const long double per_pixel = static_cast<long double>(p.s) / view.focal;
  return {(p.x - view.width / 2.0L) * per_pixel, (p.y - view.height / 2.0L) * per_pixel, p.s};
}
// Where the eye sees a point that lies before it, in pixels from the left and from the top.
struct SeenPlace {
  double x = 0, y = 0;
};
inline SeenPlace seen_place(const EyePoint& p, const View& view) {
  return {static_cast<double>(view.focal * p.x / p.z + view.width / 2.0L),
          static_cast<double>(view.focal * p.y / p.z + view.height / 2.0L)};
}

// A part of a segment, in shares of the way along it.
struct SharePart {
  long double low = 0, high = 1;
  // Leaves where a linear value is positive that is `first` at 0 and `last` at 1; false where that is
  // nothing.
  bool keep_positive(long double first, long double last) {
    if (first <= 0 && last <= 0) return false;
    if (first > 0 && last > 0) return true;
    const long double share = first / (first - last);
    if (first > 0) {
      high = std::min(high, share);
    } else {
      low = std::max(low, share);
    }
    return low < high;
  }
};

}  // namespace bitspan::golden
