// SPDX-License-Identifier: Apache-2.0
#include "golden/edge_rays.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "golden/box_tree.hpp"

namespace bitspan::golden {

struct EdgeRays::Tree : BoxTree {
  using BoxTree::BoxTree;
};

EdgeRays::EdgeRays(const Scene& scene, std::span<const std::int32_t> triangles) {
  std::vector<BoxTree::Entry> entries;
  for (const std::int32_t index : triangles) {
    std::array<EyePoint, 3> v;
    double x_low = HUGE_VAL, x_high = -HUGE_VAL, y_low = HUGE_VAL, y_high = -HUGE_VAL;
    for (std::size_t i = 0; i < 3; ++i) {
      v[i] = eye_point(scene.triangles[static_cast<std::size_t>(index)].v[i], scene);
      const auto x = static_cast<double>(v[i].x / v[i].z);
      const auto y = static_cast<double>(v[i].y / v[i].z);
      x_low = std::min(x_low, x);
      x_high = std::max(x_high, x);
      y_low = std::min(y_low, y);
      y_high = std::max(y_high, y);
    }
    Screen screen;
    screen.triangle = index;
    const EyePoint along = v[1] - v[0];
    const EyePoint across = v[2] - v[0];
    const EyePoint normal = cross(along, across);
    const long double volume = dot(normal, v[0]);
    if (volume == 0) continue;  // seen from its side, it hides nothing
    // The rounding of the corners turns a plane by so much.
    constexpr long double rounding = 0x1p-60L;
    const long double farthest = std::max({length(v[0]), length(v[1]), length(v[2])});
    screen.error = rounding * farthest * (length(along) + length(across)) / length(normal);
    screen.plane = normal * ((volume > 0 ? 1 : -1) / length(normal));
    screen.offset = -dot(screen.plane, v[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const EyePoint& a = v[(i + 1) % 3];
      const EyePoint& b = v[(i + 2) % 3];
      const EyePoint side = cross(a, b);
      screen.side[i] = side * ((dot(side, v[i]) > 0 ? 1 : -1) / length(side));
      screen.error = std::max(screen.error, rounding * length(a) * length(b) / length(side));
    }
    // Far more than what near_crossing moves a point by, and doubles round.
    const double more = 1e-8 * (1 + std::max({-x_low, x_high, -y_low, y_high}));
    entries.emplace_back(BoxTree::Box{{x_low - more, y_low - more}, {x_high + more, y_high + more}},
                         static_cast<std::uint32_t>(screens_.size()));
    screens_.push_back(screen);
  }
  tree_ = std::make_unique<Tree>(entries);
}
EdgeRays::~EdgeRays() = default;

Sight EdgeRays::at(const EyePoint& point, std::span<const std::int32_t> on) const {
  const BoxTree::Place place(static_cast<double>(point.x / point.z), static_cast<double>(point.y / point.z));
  const long double distance = length(point);
  Sight out = Sight::seen;
  for (const auto& [box, index] : tree_->touching(place)) {
    const Screen& screen = screens_[index];
    if (std::ranges::binary_search(on, screen.triangle)) continue;
    long double least = dot(screen.plane, point) + screen.offset;
    for (const EyePoint& side : screen.side) least = std::min(least, dot(side, point));
    const long double margin = (near_crossing + screen.error) * distance;
    if (least > margin) return Sight::hidden;
    if (least >= -margin) out = Sight::near;
  }
  return out;
}

}  // namespace bitspan::golden
