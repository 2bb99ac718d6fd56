// SPDX-License-Identifier: Apache-2.0
#include "scene/light_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/config.hpp"
#include "scene/plan.hpp"
#include "scene/shapes.hpp"

namespace bitspan {
namespace {

constexpr int most_texels = 4096;

// (1 + (r / G)^2)^(-3/2) = 1/255
double radius_of(int side) { return 0.5 * side / std::sqrt(std::cbrt(255.0 * 255.0) - 1); }

// Across the normal: from the axis that it is farthest from, as the source's M1 to M3.
Vec3 across(const Vec3& n) {
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x <= y && x <= z) return of_length_1({0, -n.z, n.y});
  if (y <= z) return of_length_1({n.z, 0, -n.x});
  return of_length_1({-n.y, n.x, 0});
}

// Less than half a code.
constexpr double dark = 0.5 / 255;

double cubed(double x) { return x * x * x; }

// No more than the distance of the face from a point.
double nearest(const Face& face, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity(), longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& p = face.corner[i].position;
    least = std::min(least, length(p - point));
    longest = std::max(longest, length(face.corner[(i + 1) % 3].position - p));
  }
  return std::max(least - longest, 0.0);
}

}  // namespace

Texture light_texture(int side) {
  const double g = radius_of(side);
  return painted("light.png", side, side, [&](int i, int j) {
    const double x = i + 0.5 - 0.5 * side, y = j + 0.5 - 0.5 * side;
    const double eta = std::pow(1 + (x * x + y * y) / (g * g), -1.5);
    const auto code = static_cast<std::uint8_t>(std::lround(255 * eta));
    return Rgba{code, code, code, 255};
  });
}

StateChange light_map_state() {
  return {.settings = {state_setting("texture1.op", TextureOp::modulate_scaled),
                       state_setting("texture1.scale", light_map_octaves),
                       state_setting("texture1.filter", TextureFilter::bilinear),
                       state_setting("texture1.wrap.u", TextureWrap::clamp),
                       state_setting("texture1.wrap.v", TextureWrap::clamp)}};
}

void check_light_map(const LightMapOptions& options, const std::string& name) {
  const Vec3& at = options.place;
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z)) {
    throw InputError(name + ": the light's place is not finite; expected three finite numbers");
  }
  if (!std::isfinite(options.reach) || !(options.reach > 0)) {
    throw InputError(
        fmt::format("{}: a reach of {} is not legal; expected a number above 0", name, options.reach));
  }
  if (options.side < 2 || options.side > most_texels) {
    throw InputError(
        fmt::format("{}: {} texels are not legal; expected 2..{}", name, options.side, most_texels));
  }
}

void map_light(std::span<Face> faces, const LightMapOptions& options) {
  check_light_map(options);
  const double g = radius_of(options.side);
  for (Face& face : faces) {
    const Vec3 n = of_length_1(area_vector(face));
    const double height = dot(n, options.place - face.corner[0].position);
    const bool is_lit =
        height > 0 && options.reach * options.reach * height > dark * cubed(nearest(face, options.place));
    const double lit = is_lit ? options.reach / height : 0;
    const double share = std::min(std::ldexp(lit * lit, -light_map_octaves), 1.0);
    const Vec3 foot = options.place - n * height;
    const Vec3 e1 = across(n), e2 = cross(n, e1);
    for (Corner& corner : face.corner) {
      const Vec3 at = is_lit ? (corner.position - foot) * (g / height) : Vec3{};
      corner.u2 = dot(e1, at) + 0.5 * options.side;
      corner.v2 = dot(e2, at) + 0.5 * options.side;
      for (std::size_t c = 0; c < 3; ++c) corner.c[c] *= share;
    }
  }
}

}  // namespace bitspan
