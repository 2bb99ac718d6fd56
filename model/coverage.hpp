// SPDX-License-Identifier: Apache-2.0
// The fill rule as three exact edge functions: whether a pixel's centre is inside a triangle.
// docs/numeric-spec.md, "plane_walk"; the scan of edge_walk gives the same pixels.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/exact.hpp"

namespace bitspan::model {

struct Coverage {
  // a x + b y + c >= 0 for pixel (x, y): its centre is on the inner side of the edge, or on it where the fill
  // rule gives the edge to this triangle. The unit is that of products of snapped coordinates, times 2.
  struct Side {
    int128 a, b, c;
  };
  std::array<Side, 3> sides;
};

Coverage make_coverage(const SetupRecord& setup, int subpixel_bits, FillRule fill_rule);

inline bool covers(const Coverage& coverage, std::int64_t x, std::int64_t y) {
  bool inside = true;
  for (const Coverage::Side& s : coverage.sides) {
    inside = inside && s.a * x + s.b * y + s.c >= 0;
  }
  return inside;
}

}  // namespace bitspan::model
