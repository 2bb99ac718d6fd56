// SPDX-License-Identifier: Apache-2.0
// The plane through a value at the three vertices: what it rises by along x and along y, as exact quotients
// over the triangle's area.
#pragma once

#include <array>

#include "model/numeric/exact.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {

using VertexTriple = std::array<Exact, 3>;  // of a quantity at the vertices

struct TriangleShape {
  VertexTriple x, y;
  Exact area;
};

inline TriangleShape shape_of(const std::array<SetupVertex, 3>& v, int subpixel_bits) {
  TriangleShape s;
  for (std::size_t i = 0; i < 3; ++i) {
    s.x[i] = {v[i].x, subpixel_bits};
    s.y[i] = {v[i].y, subpixel_bits};
  }
  s.area = (s.x[1] - s.x[0]) * (s.y[2] - s.y[0]) - (s.x[2] - s.x[0]) * (s.y[1] - s.y[0]);
  return s;
}

struct Rises {
  Exact nx, ny;  // over area
};

inline Rises rises(const TriangleShape& s, const VertexTriple& w) {
  return {(w[1] - w[0]) * (s.y[2] - s.y[0]) - (w[2] - w[0]) * (s.y[1] - s.y[0]),
          (w[2] - w[0]) * (s.x[1] - s.x[0]) - (w[1] - w[0]) * (s.x[2] - s.x[0])};
}

}  // namespace bitspan::model
