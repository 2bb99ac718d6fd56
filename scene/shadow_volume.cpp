// SPDX-License-Identifier: Apache-2.0
#include "scene/shadow_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "config/config.hpp"
#include "scene/plan.hpp"
#include "scene/project.hpp"

namespace bitspan {
namespace {

// The point xyz / w; with w = 0 infinitely far, in the direction xyz.
struct Homogeneous {
  Vec3 xyz;
  double w = 1;
};
Homogeneous operator+(const Homogeneous& a, const Homogeneous& b) { return {a.xyz + b.xyz, a.w + b.w}; }
Homogeneous operator*(const Homogeneous& a, double k) { return {a.xyz * k, a.w * k}; }

// What of a convex polygon lies where f is not negative; f is linear. An edge is cut at the same point, bit
// for bit, from whichever side it is walked and whichever part is kept.
template <class F>
std::vector<Homogeneous> kept(const std::vector<Homogeneous>& polygon, const F& f, double sign = 1) {
  std::vector<Homogeneous> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Homogeneous& a = polygon[i];
    const Homogeneous& b = polygon[(i + 1) % polygon.size()];
    const double fa = f(a);
    const double fb = f(b);
    if (sign * fa >= 0) out.push_back(a);
    if ((fa > 0 && fb < 0) || (fa < 0 && fb > 0)) {
      // From the end where f is larger.
      const double t = std::max(fa, fb) / (std::max(fa, fb) - std::min(fa, fb));
      out.push_back(fa > 0 ? a * (1 - t) + b * t : b * (1 - t) + a * t);
    }
  }
  return out;
}

// The share of an angle below which a direction counts as one along the picture's plane.
constexpr double along_picture = 1e-9;

void append(std::vector<Face>& out, const std::vector<Homogeneous>& corners, const View& view) {
  const auto in_front = kept(
      corners, [&](const Homogeneous& p) { return p.xyz.z - view.s_min * p.w - along_picture * (1 - p.w); });
  const auto fan = [&](const std::vector<Homogeneous>& polygon, const auto& place) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      Face& face = out.emplace_back();
      face.corner[0].position = place(polygon[0]);
      face.corner[1].position = place(polygon[i - 1]);
      face.corner[2].position = place(polygon[i]);
    }
  };
  const auto before_far = [&](const Homogeneous& p) { return view.s_max * p.w - p.xyz.z; };
  fan(kept(in_front, before_far), [](const Homogeneous& p) { return p.w == 1 ? p.xyz : p.xyz * (1 / p.w); });
  // What lies beyond is as far as the picture goes. There it is still behind every surface.
  fan(kept(in_front, before_far, -1), [&](const Homogeneous& p) {
    return Vec3{p.xyz.x * (view.s_max / p.xyz.z), p.xyz.y * (view.s_max / p.xyz.z), view.s_max};
  });
}

}  // namespace

std::vector<Face> shadow_volumes(std::span<const Face> faces, const Vec3& light, const View& view) {
  using Place = std::tuple<double, double, double>;
  std::map<Place, std::size_t> index_of;
  std::vector<Vec3> points;
  const auto index = [&](const Vec3& p) {
    const auto [at, is_new] = index_of.try_emplace({p.x, p.y, p.z}, points.size());
    if (is_new) points.push_back(p);
    return at->second;
  };
  // How often the bodies' ends run from the first to the second point, less how often they run back.
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  std::vector<Face> out;
  const auto far = [&](const Vec3& p) {
    const Vec3 d = p - light;
    return Homogeneous{d * (1 / length(d)), 0};
  };
  for (const Face& face : faces) {
    std::array<Vec3, 3> p{face.corner[0].position, face.corner[1].position, face.corner[2].position};
    const double side = dot(cross(p[1] - p[0], p[2] - p[0]), light - p[0]);
    if (side == 0 || !std::isfinite(side)) continue;
    if (side < 0) std::swap(p[1], p[2]);
    append(out, {{p[0]}, {p[1]}, {p[2]}}, view);
    append(out, {far(p[0]), far(p[2]), far(p[1])}, view);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t from = index(p[i]);
      const std::size_t to = index(p[(i + 1) % 3]);
      edges[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  for (const auto& [ends, count] : edges) {
    const Vec3& from = points[count > 0 ? ends.first : ends.second];
    const Vec3& to = points[count > 0 ? ends.second : ends.first];
    for (int i = 0; i < std::abs(count); ++i) append(out, {{to}, {from}, far(from), far(to)}, view);
  }
  return out;
}

Scene with_shadow_volumes(Scene scene, std::span<const Face> casters, const Vec3& light, double dark) {
  if (!scene.commands.empty()) {
    throw InputError(scene.name + ": shadow volumes are for a scene without commands; leave them out");
  }
  if (scene.triangles.empty()) return scene;
  // Bit 7 of the stencil: a surface is seen here. The others: in how many bodies it lies.
  constexpr std::int64_t surface = 128, count = 127;
  const Viewpoint viewer = viewer_of(scene);
  Pass bodies{
      .name = "shadow volumes",
      .states = {
          {.reset = true,
           // The end towards the light lies as far as the surface that it is the end of; it must count there.
           .settings = {state_setting("depth.when", DepthWhen::late),
                        state_setting("depth.func", DepthFunc::less), state_setting("depth.write", 0),
                        state_setting("color.write", 0), state_setting("stencil.test", 1),
                        state_setting("stencil.write", count), state_setting("stencil.two_sided", 1),
                        state_setting("stencil.zfail", StencilOp::decrement_wrap),
                        state_setting("stencil.back.zfail", StencilOp::increment_wrap)}}}};
  ProjectReport report;
  project(shadow_volumes(casters, light, scene), viewer, {.cull = false}, bodies.triangles, report);
  if (bodies.triangles.empty()) return scene;
  Pass picture{
      .name = "picture",
      .states = {{.settings = {state_setting("depth.when", DepthWhen::late), state_setting("stencil.test", 1),
                               state_setting("stencil.ref", surface),
                               state_setting("stencil.pass", StencilOp::replace)}}},
      .triangles = std::move(scene.triangles)};
  Pass shade{.name = "shadow",
             .states = {{.reset = true,
                         .settings = {state_setting("depth.when", DepthWhen::late),
                                      state_setting("depth.func", DepthFunc::always),
                                      state_setting("depth.write", 0), state_setting("stencil.test", 1),
                                      state_setting("stencil.ref", surface),
                                      state_setting("stencil.func", CompareFunc::less)}}}};
  const auto corner = [&](double x, double y) {
    Vertex v;
    v.x = x;
    v.y = y;
    v.s = scene.s_min;
    v.c = {0, 0, 0, 1 - dark};
    return v;
  };
  const double right = scene.width;
  const double bottom = scene.height;
  shade.triangles = {{.v = {corner(0, 0), corner(right, bottom), corner(right, 0)}},
                     {.v = {corner(0, 0), corner(0, bottom), corner(right, bottom)}}};
  scene.triangles.clear();
  const std::array passes{std::move(picture), std::move(bodies), std::move(shade)};
  flatten(passes, scene);
  return scene;
}

}  // namespace bitspan
