// SPDX-License-Identifier: Apache-2.0
#include "scene/light.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "config/config.hpp"

namespace bitspan {
namespace {

bool has_normal(const Corner& corner) { return normal_of(corner) != Vec3{}; }

// A place among the corners of all faces.
std::size_t face_of(std::size_t corner) { return corner / 3; }

// More faces than this at one point have one normal for all on a side of the crease; their pairs are too
// many.
constexpr std::size_t fan_limit = 64;

double brightness(const Light& light, const Vec3& normal, const Vec3& at) {
  const Vec3 place = place_of(light);
  const Vec3 to = of_length_1(light.is_point ? place - at : place);
  const Vec3 n = of_length_1(normal);
  const double cosine = dot(n, to);
  if (!(cosine > 0)) return light.ambient;
  const double mirrored = to.z - 2 * cosine * n.z;
  const double highlight = mirrored > 0 ? std::pow(std::min(mirrored, 1.0), light.exponent) : 0;
  const double scattered = cosine / (1 + light.lunar * std::max(-n.z, 0.0));
  return light.ambient + (1 - light.ambient - light.specular) * scattered + light.specular * highlight;
}

}  // namespace

Vec3 place_of(const Light& light) { return {light.place[0], light.place[1], light.place[2]}; }

Vec3 area_vector(const Face& face) {
  const auto& c = face.corner;
  return cross(c[1].position - c[0].position, c[2].position - c[0].position);
}

void check_light(const LightOptions& options, const std::string& name) {
  // A direction is one only beside what the viewer looks at.
  Light light = options.light;
  light.is_point = true;
  if (light.reach > 0 && !options.by_unit) {
    throw InputError(name +
                     ".reach: no unit is there that knows the distance; expected light.at other than none");
  }
  if (const std::string fault = light_fault(light); !fault.empty()) throw InputError(name + fault);
}

void give_normals(std::span<Face> faces, double crease) {
  const auto corner = [&](std::size_t i) -> Corner& { return faces[face_of(i)].corner[i % 3]; };
  std::vector<std::size_t> by_place(3 * faces.size());
  std::iota(by_place.begin(), by_place.end(), std::size_t{0});
  const auto place = [&](std::size_t i) {
    const Vec3& p = corner(i).position;
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::stable_sort(by_place, {}, place);
  std::vector<Vec3> area(faces.size());
  std::ranges::transform(faces, area.begin(), area_vector);
  std::vector<Vec3> unit(faces.size());
  std::ranges::transform(area, unit.begin(), of_length_1);
  const double least = std::cos(radians(crease));
  for (std::size_t first = 0; first < by_place.size();) {
    std::size_t end = first + 1;
    while (end < by_place.size() && place(by_place[end]) == place(by_place[first])) ++end;
    const std::span meeting = std::span(by_place).subspan(first, end - first);
    first = end;
    Vec3 all{};
    if (meeting.size() > fan_limit) {
      for (const std::size_t i : meeting) all = all + area[face_of(i)];
    }
    for (const std::size_t i : meeting) {
      if (has_normal(corner(i))) continue;
      const Vec3& own = unit[face_of(i)];
      Vec3 sum{};
      if (meeting.size() > fan_limit) {
        const Vec3 mean = of_length_1(all);
        sum = dot(mean, own) >= least ? mean : own;
      } else {
        for (const std::size_t other : meeting) {
          if (dot(unit[face_of(other)], own) >= least) sum = sum + area[face_of(other)];
        }
      }
      const Vec3 n = of_length_1(sum);
      set_normal(corner(i), n == Vec3{} ? own : n);
    }
  }
}

void turn_to_viewer(std::span<Face> faces, const Viewpoint& view, bool all) {
  for (Face& face : faces) {
    if (!face.two_sided && !all) continue;
    if (dot(area_vector(face), line_of_sight(face.corner[0].position, view)) <= 0) continue;
    for (Corner& corner : face.corner) set_normal(corner, normal_of(corner) * -1);
  }
}

Light light_of(const LightOptions& options, const Viewpoint& view, const Vec3& target) {
  Light light = options.light;
  const Vec3 place = in_view(place_of(light), view);
  const Vec3 to = light.is_point ? place : place - in_view(target, view);
  if (!light.is_point && to == Vec3{}) {
    throw InputError(
        "light: stands at what the viewer looks at, and so has no direction; expected another place");
  }
  light.place = {to.x, to.y, to.z};
  return light;
}

Light shoulder_light() { return {.place = {-0.5, -0.7, -1}, .ambient = 0.25}; }

void light_corners(std::span<Face> faces, const Light& light, const Viewpoint& view) {
  for (Face& face : faces) {
    for (Corner& corner : face.corner) {
      const Vec3 n = normal_of(corner);
      const Vec3 seen{dot(view.right, n), dot(view.down, n), dot(view.forward, n)};
      const double value = std::min(brightness(light, seen, in_view(corner.position, view)), 1.0);
      for (std::size_t c = 0; c < 3; ++c) corner.c[c] *= value;
    }
  }
}

}  // namespace bitspan
