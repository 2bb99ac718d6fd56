// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/quadric_form.hpp"

namespace bitspan {
namespace {

using Matrix = std::array<std::array<double, 4>, 4>;

Matrix matrix_of(const std::array<double, 10>& rows) {
  Matrix out{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) out[i][j] = out[j][i] = rows[at++];
  }
  return out;
}

bool all_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

}  // namespace

std::string quadric_fault(const Quadric& q) {
  if (!all_finite(q.matrix)) return ".matrix: is not finite; expected 10 finite numbers";
  if (std::ranges::all_of(std::span(q.matrix).first(9), [](double x) { return x == 0; })) {
    return ".matrix: is constant; expected a form that depends on the point";
  }
  if (!std::isfinite(q.low) || !std::isfinite(q.high) || q.low > 0 || q.high < 0) {
    return fmt::format(".within: [{}, {}] is not legal; expected [low, high] with low <= 0 <= high", q.low,
                       q.high);
  }
  if (!q.clip) return "";
  if (!all_finite(q.clip->axis)) return ".clip.axis: is not finite; expected 4 finite numbers";
  if (!std::isfinite(q.clip->from) || !std::isfinite(q.clip->to) || !(q.clip->from < q.clip->to)) {
    return fmt::format(".clip.from: {} is not below to = {}; expected from < to", q.clip->from, q.clip->to);
  }
  return "";
}

std::string ranges_fault(std::span<const Quadric> quadrics, std::size_t triangles) {
  std::size_t least = 0;
  for (std::size_t i = 0; i < quadrics.size(); ++i) {
    const auto& [first, count] = std::pair(quadrics[i].first, quadrics[i].count);
    if (first < least || count == 0 || first >= triangles || count > triangles - first) {
      return fmt::format(
          "[{}].triangles: [{}, {}] is not legal; expected [first, last] in {}..{}, behind those in front of "
          "it",
          i, first, static_cast<std::int64_t>(first + count) - 1, least,
          static_cast<std::int64_t>(triangles) - 1);
    }
    least = first + count;
  }
  return "";
}

double value_at(const Quadric& q, const Vec3& p) {
  const auto& m = q.matrix;
  return p.x * (m[0] * p.x + 2 * (m[1] * p.y + m[2] * p.z + m[3])) +
         p.y * (m[4] * p.y + 2 * (m[5] * p.z + m[6])) + p.z * (m[7] * p.z + 2 * m[8]) + m[9];
}

Vec3 gradient_at(const Quadric& q, const Vec3& p) {
  const auto& m = q.matrix;
  return Vec3{m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[1] * p.x + m[4] * p.y + m[5] * p.z + m[6],
              m[2] * p.x + m[5] * p.y + m[7] * p.z + m[8]} *
         2;
}

Quadric seen_by(const MeshQuadric& quadric, const Viewpoint& view) {
  // p - origin = (right down forward) (what the viewer sees) + (position - origin).
  const Vec3 offset = view.position - quadric.origin;
  const Matrix to{{{view.right.x, view.down.x, view.forward.x, offset.x},
                   {view.right.y, view.down.y, view.forward.y, offset.y},
                   {view.right.z, view.down.z, view.forward.z, offset.z},
                   {0, 0, 0, 1}}};
  const Matrix m = matrix_of(quadric.matrix);
  Quadric out = quadric;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) {
      double sum = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < 4; ++b) sum += to[a][i] * m[a][b] * to[b][j];
      }
      out.matrix[at++] = sum;
    }
  }
  if (!out.clip) return out;
  const LinearForm axis = quadric.clip->axis;
  for (std::size_t j = 0; j < 4; ++j) {
    double sum = 0;
    for (std::size_t a = 0; a < 4; ++a) sum += axis[a] * to[a][j];
    out.clip->axis[j] = sum;
  }
  return out;
}

void move_ranges(std::vector<Quadric>& quadrics, std::size_t by) {
  for (Quadric& q : quadrics) q.first += by;
}

}  // namespace bitspan
