// SPDX-License-Identifier: Apache-2.0
#include "scene/planar_shadow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/config.hpp"
#include "scene/plan.hpp"
#include "scene/project.hpp"

namespace bitspan {
namespace {

// A caster as near to the light as this share of the light's height above the plane throws its shadow so far
// that nothing of it is seen.
constexpr double nearest_light = 1e-6;

// What of a convex polygon lies where f is not negative; f is linear.
template <class F>
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const F& f) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double fa = f(a);
    const double fb = f(b);
    if (fa >= 0) out.push_back(a);
    if ((fa < 0) != (fb < 0)) out.push_back(a + (b - a) * (fa / (fa - fb)));
  }
  return out;
}

bool lies_in(const Plane& plane, const Triangle& triangle, const View& view, double thickness) {
  return std::ranges::all_of(triangle.v, [&](const Vertex& v) {
    return std::abs(height(plane, position_of(v, view))) <= thickness;
  });
}

// Of the light above the plane, times w.
double height(const Plane& plane, const PlanarLight& light) {
  return dot(plane.normal, light.place - plane.point * light.w);
}

}  // namespace

Vec3 shadow_of(const Vec3& p, const PlanarLight& light, const Plane& plane) {
  const double zp = height(plane, p);
  const double zs = height(plane, light);
  return (light.place * zp - p * zs) * (1 / (light.w * zp - zs));
}

std::vector<Face> flattened(std::span<const Face> faces, const PlanarLight& light, const Plane& plane,
                            double thickness) {
  std::vector<Face> out;
  const double top = height(plane, light) * (1 - nearest_light);
  if (!(top > 0)) return out;
  for (const Face& face : faces) {
    std::vector<Vec3> polygon{face.corner[0].position, face.corner[1].position, face.corner[2].position};
    polygon = clipped(polygon, [&](const Vec3& p) { return height(plane, p) - thickness; });
    polygon = clipped(polygon, [&](const Vec3& p) { return top - light.w * height(plane, p); });
    for (Vec3& p : polygon) p = shadow_of(p, light, plane);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      Face& part = out.emplace_back();
      part.two_sided = true;
      part.corner[0].position = polygon[0];
      part.corner[1].position = polygon[i - 1];
      part.corner[2].position = polygon[i];
    }
  }
  return out;
}

Scene with_planar_shadows(Scene scene, std::span<const Face> casters, std::span<const PlanarLight> lights,
                          const Plane& plane, double dark, double thickness) {
  if (!scene.commands.empty()) {
    throw InputError(scene.name + ": a planar shadow is for a scene without commands; leave it out");
  }
  if (lights.empty() || lights.size() > planar_light_limit) {
    throw InputError(fmt::format("planar shadow: {} lights are not legal; expected 1..{}", lights.size(),
                                 planar_light_limit));
  }
  if (!(length(plane.normal) > 0) || !(dark >= 0 && dark <= 1)) {
    throw InputError("planar shadow: the plane's normal is 0, or `dark` is not 0..1");
  }
  if (scene.triangles.empty()) return scene;
  const Viewpoint viewer = viewer_of(scene);
  // Bit 0 of the stencil: the plane's surface is seen here. Bit 1 + i: light i has darkened the pixel.
  constexpr std::int64_t surface = 1;
  std::vector<Pass> passes;
  for (const Triangle& triangle : scene.triangles) {
    const bool is_surface = lies_in(plane, triangle, scene, thickness);
    const std::string name = is_surface ? "surface" : "solids";
    if (passes.empty() || passes.back().name != name) {
      passes.push_back({.name = name,
                        .states = {{.settings = {state_setting("depth.when", DepthWhen::late),
                                                 state_setting("stencil.test", 1),
                                                 state_setting("stencil.pass", StencilOp::replace),
                                                 state_setting("stencil.ref", is_surface ? surface : 0)}}}});
    }
    passes.back().triangles.push_back(triangle);
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::int64_t bit = std::int64_t{2} << i;
    Pass pass{
        .name = "shadow",
        .states = {
            {.reset = true,
             .settings = {state_setting("depth.when", DepthWhen::late),
                          state_setting("depth.func", DepthFunc::always), state_setting("depth.write", 0),
                          state_setting("stencil.test", 1), state_setting("stencil.func", CompareFunc::equal),
                          state_setting("stencil.ref", surface), state_setting("stencil.mask", surface | bit),
                          state_setting("stencil.write", bit),
                          state_setting("stencil.pass", StencilOp::invert)}}}};
    ProjectReport report;
    project(flattened(casters, lights[i], plane, thickness), viewer, {.cull = false}, pass.triangles, report);
    for (Triangle& triangle : pass.triangles) {
      triangle.texture = -1;
      for (Vertex& v : triangle.v) v.c = {0, 0, 0, 1 - dark};
    }
    if (!pass.triangles.empty()) passes.push_back(std::move(pass));
  }
  scene.triangles.clear();
  flatten(passes, scene);
  return scene;
}

}  // namespace bitspan
