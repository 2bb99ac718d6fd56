// SPDX-License-Identifier: Apache-2.0
// The plane through three vertices: how much a value rises per pixel along x and along y.
#pragma once

#include <array>

#include "golden/quantize.hpp"
#include "golden/values.hpp"

namespace bitspan::golden {

template <class Real>
struct Gradient {
  Real x = 0, y = 0;
};

// A triangle's shape. nx and ny are the rises times its area.
template <class Real>
struct PlaneShape {
  Real x1, y1, x2, y2;  // from vertex 0
  Real area;            // twice the triangle's

  explicit PlaneShape(const std::array<VertexValues<Real>, 3>& v)
      : x1(v[1].x - v[0].x),
        y1(v[1].y - v[0].y),
        x2(v[2].x - v[0].x),
        y2(v[2].y - v[0].y),
        area(x1 * y2 - x2 * y1) {}

  PairOf<Real> nx(Real w0, Real w1, Real w2) const {
    return ExactSum(exact_product(w1 - w0, y2)).add(exact_product(w0 - w2, y1)).get();
  }
  PairOf<Real> ny(Real w0, Real w1, Real w2) const {
    return ExactSum(exact_product(w2 - w0, x1)).add(exact_product(w0 - w1, x2)).get();
  }
  Gradient<Real> gradient(const std::array<Real, 3>& w, const Quantizer<Real>& q) const {
    if (w[0] == w[1] && w[0] == w[2]) return {};
    const PairOf<Real> divisor{base_of(area), 0};
    return {q.quotient(nx(w[0], w[1], w[2]), divisor), q.quotient(ny(w[0], w[1], w[2]), divisor)};
  }
};

// Returns what a line is at the vertices.
template <class Real>
std::array<Real, 3> at_vertices(const std::array<VertexValues<Real>, 3>& v, LineId id) {
  return {v[0][id], v[1][id], v[2][id]};
}

// The same as numerators, Q(w (h + B)); b: B.
template <class Real>
std::array<Real, 3> numerators_at(const std::array<VertexValues<Real>, 3>& v, LineId id, Real b,
                                  const Quantizer<Real>& q) {
  std::array<Real, 3> out;
  for (std::size_t i = 0; i < v.size(); ++i) out[i] = q.product(v[i][id], v[i][LineId::h] + b);
  return out;
}

}  // namespace bitspan::golden
