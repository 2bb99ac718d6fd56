// SPDX-License-Identifier: Apache-2.0
// Quadrics that triangles of a scene stand for. No engine looks at them: rays do, beside the triangles.
// docs/formats.md, "Quadrics". [V2]
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace bitspan {

// A linear function of a point: x, y, z and the constant.
using LinearForm = std::array<double, 4>;

// The part of a quadric between two planes: from <= axis(p) <= to.
struct QuadricClip {
  LinearForm axis{};
  double from = 0, to = 0;
  bool cap_from = false, cap_to = false;  // whether the body is closed by a flat face there

  bool operator==(const QuadricClip&) const = default;
};

// All points with f(p) = 0. f is below 0 inside the body.
struct Quadric {
  std::size_t first = 0, count = 0;  // triangles, or faces, that stand for it, its caps included
  // Of the symmetric form f(p) = (x y z 1) M (x y z 1)^T: the rows of M, each from its diagonal on.
  std::array<double, 10> matrix{};
  // What f may be on the triangles, but for the caps': low <= 0 <= high.
  double low = 0, high = 0;
  bool two_sided = false;  // else its triangles are seen from outside alone
  std::optional<QuadricClip> clip{};

  bool operator==(const Quadric&) const = default;
};
inline constexpr std::size_t quadrics_limit = 1000;

// Why a quadric is not legal, without its range of triangles: ".matrix: ..."; empty where it is.
std::string quadric_fault(const Quadric& quadric);
// Why the ranges of triangles are not legal: they are in order, none is empty, and they end by `triangles`.
// Begins with the index, "[2].triangles: ..."; empty where they are.
std::string ranges_fault(std::span<const Quadric> quadrics, std::size_t triangles);

// Moves the ranges of triangles by `by`, where as many have been put in front of all others.
void move_ranges(std::vector<Quadric>& quadrics, std::size_t by);

}  // namespace bitspan
