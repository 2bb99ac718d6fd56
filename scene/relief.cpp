// SPDX-License-Identifier: Apache-2.0
#include "scene/relief.hpp"

#include <array>
#include <cmath>

#include "scene/plan.hpp"

namespace bitspan {
namespace {

// How a value of the corners rises in the face's plane; across: 2 area n.
Vec3 gradient(const Face& face, double Corner::*of, const Vec3& across) {
  const auto& c = face.corner;
  Vec3 sum{};
  for (std::size_t i = 0; i < 3; ++i) {
    sum = sum + cross(across, c[(i + 2) % 3].position - c[(i + 1) % 3].position) * (c[i].*of);
  }
  const double size = dot(across, across);
  return size > 0 ? sum * (1 / size) : Vec3{};
}

}  // namespace

void give_relief(std::span<Face> faces, const Vec3& light) {
  for (Face& face : faces) {
    const Vec3 across = area_vector(face);
    const Vec3 rise_u = gradient(face, &Corner::u2, across), rise_v = gradient(face, &Corner::v2, across);
    const double texels_per_unit = std::sqrt(length(cross(rise_u, rise_v)));
    const Vec3 own = of_length_1(across);
    for (Corner& corner : face.corner) {
      const Vec3 given = of_length_1(normal_of(corner));
      const Vec3& n = given == Vec3{} ? own : given;
      const Vec3 to = light - corner.position;
      const Vec3 along = to - n * dot(n, to);
      corner.lx = corner.u2 + dot(rise_u, along);
      corner.ly = corner.v2 + dot(rise_v, along);
      corner.lz = texels_per_unit * dot(n, to);
    }
  }
}

StateChange relief_state() {
  return {.settings = {state_setting("texture1.op", TextureOp::relief),
                       state_setting("texture1.filter", TextureFilter::bilinear)}};
}

}  // namespace bitspan
