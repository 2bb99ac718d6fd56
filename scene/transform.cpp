// SPDX-License-Identifier: Apache-2.0
#include "scene/transform.hpp"

#include "config/config.hpp"

namespace bitspan {

Viewpoint viewer_of(const View& view) {
  Viewpoint out;
  out.width = view.width;
  out.height = view.height;
  out.focal = view.focal;
  out.s_min = view.s_min;
  out.s_max = view.s_max;
  return out;
}

void look_at(Viewpoint& view, const Vec3& position, const Vec3& target, const Vec3& up) {
  const Vec3 line = target - position;
  const double distance = length(line);
  if (!(distance > 0) || !std::isfinite(distance)) {
    throw InputError("camera: position and target coincide; expected two different finite points");
  }
  view.position = position;
  view.forward = line * (1 / distance);
  const Vec3 side = cross(view.forward, up);
  const double side_length = length(side);
  if (!(side_length > 1e-9 * length(up)) || !std::isfinite(side_length)) {
    throw InputError("camera: the up vector lies along the line of sight; expected another direction");
  }
  view.right = side * (1 / side_length);
  view.down = cross(view.forward, view.right);
}

Vec3 line_of_sight(const Vec3& point, const Viewpoint& view) {
  if (!view.parallel) return point - view.position;
  return view.forward - view.right * view.parallel->shear_x - view.down * view.parallel->shear_y;
}

Vec3 in_view(const Vec3& point, const Viewpoint& view) {
  const Vec3 d = point - view.position;
  return {dot(view.right, d), dot(view.down, d), dot(view.forward, d)};
}

ClipVertex to_normalised(const Corner& corner, const Viewpoint& view) {
  Vec3 p = in_view(corner.position, view);
  if (view.parallel) {
    const double behind = p.z - view.parallel->distance;
    p.x += view.parallel->shear_x * behind;
    p.y += view.parallel->shear_y * behind;
  }
  ClipVertex out{{p.x * (2 * view.focal / view.width), p.y * (2 * view.focal / view.height), p.z},
                 static_cast<const Attributes&>(corner)};
  if (const Vec3 n = normal_of(corner); n != Vec3{}) {
    set_normal(out, {dot(view.right, n), dot(view.down, n), dot(view.forward, n)});
  }
  return out;
}

}  // namespace bitspan
