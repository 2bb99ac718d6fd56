// SPDX-License-Identifier: Apache-2.0
// World space to view space, and the normalised view volume (B6).
#pragma once

#include <optional>

#include "scene/geometry.hpp"
#include "scene/view.hpp"

namespace bitspan {

// A parallel projection: the lines of sight do not meet in the viewer.
struct Parallel {
  double distance = 1;              // where the picture is as large as the central one
  double shear_x = 0, shear_y = 0;  // what x and y grow by with s: 0 where the lines of sight are forward's
};

// A viewer. right, down and forward are orthonormal; distances along forward are s.
struct Viewpoint {
  Vec3 position;
  Vec3 right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};
  int width = 640, height = 480;  // pixels
  double focal = 500;             // pixels
  double s_min = 1, s_max = 1000;
  std::optional<Parallel> parallel{};  // none: the projection is central
};

// The viewer of such a picture, in its own space.
Viewpoint viewer_of(const View& view);

// Sets the axes so that the viewer looks from `position` at `target`, `up` pointing up in the picture. Throws
// InputError where the two coincide or `up` lies along the line of sight.
void look_at(Viewpoint& view, const Vec3& position, const Vec3& target, const Vec3& up);

// The line of sight through a point of the world, away from the viewer.
Vec3 line_of_sight(const Vec3& point, const Viewpoint& view);

// A point of the world in the viewer's space: x to the right, y downward, z along the view axis.
Vec3 in_view(const Vec3& point, const Viewpoint& view);

// In the normalised volume the visible part of space is -s <= x <= s, -s <= y <= s, s_min <= s <= s_max,
// whatever the picture's shape; y points down. In a parallel projection its distance bounds x and y, not s.
struct ClipPoint {
  double x = 0, y = 0, s = 0;
};
struct ClipVertex : ClipPoint, Attributes {};

ClipVertex to_normalised(const Corner& corner, const Viewpoint& view);

}  // namespace bitspan
