// SPDX-License-Identifier: Apache-2.0
// Rays from the eye to points of edges: whether a triangle stands between them. They judge an oracle of
// edges, with nothing of its algorithm. [V2, H2]
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "golden/eye_space.hpp"

namespace bitspan::golden {

// Moved by so much of its distance from the eye, a point that is near a crossing may be seen or not.
inline constexpr long double near_crossing = 1e-9L;

enum class Sight {
  seen,    // no triangle is between the eye and the point
  hidden,  // one is
  near,    // one is, or is not, by no more than near_crossing
};

class EdgeRays {
 public:
  // triangles: input indices of those that hide something.
  EdgeRays(const Scene& scene, std::span<const std::int32_t> triangles);
  ~EdgeRays();
  EdgeRays(const EdgeRays&) = delete;
  EdgeRays& operator=(const EdgeRays&) = delete;
  // on: triangles that the point lies on, ascending; they do not hide it.
  Sight at(const EyePoint& point, std::span<const std::int32_t> on) const;

 private:
  // A point is hidden where it is on the inner side of all four planes, which have normals of length 1: of
  // the triangle's plane, whose inner side is behind it, and of those through the eye and a side.
  struct Screen {
    std::int32_t triangle = 0;
    EyePoint plane;
    long double offset = 0;  // the triangle's plane is where plane p + offset = 0
    std::array<EyePoint, 3> side{};
    long double error = 0;  // by which a point may be off from a plane, as a share of its distance
  };
  struct Tree;
  std::vector<Screen> screens_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace bitspan::golden
