// SPDX-License-Identifier: Apache-2.0
#include "scene/shadow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "scene/plan.hpp"
#include "scene/planar_shadow.hpp"
#include "scene/project.hpp"
#include "scene/shadow_volume.hpp"

namespace bitspan {
namespace {

constexpr double widest_degrees = 70;   // from the projector's axis
constexpr double least_degrees = 0.01;  // of an angle that is given
constexpr double least_ratio = 1.5;     // of the distances that a light sees
constexpr double far_apart = 1.25;      // distances of a triangle that are given no common share
constexpr double most_codes = 1 << 30;  // that texture1.bias holds
constexpr int light_target = 1;

Projector range_of(const Viewpoint& view) { return {view.s_min, view.s_max}; }

void refuse_commands(const Scene& scene, const char* what) {
  if (scene.commands.empty() && !scene.projector) return;
  throw InputError(
      fmt::format("{}: {} is for a scene without commands and projector; leave it out", scene.name, what));
}

// As look_at, with another direction upward where `up` lies nearly along the axis.
void look_from(Viewpoint& view, const Vec3& from, const Vec3& at, const Vec3& up) {
  const Vec3 line = at - from;
  const bool is_along = length(cross(line, up)) < 1e-3 * length(line) * length(up);
  look_at(view, from, at, !is_along ? up : std::abs(up.z) < 0.5 * length(up) ? Vec3{0, 0, 1} : Vec3{1, 0, 0});
}

// Draws the triangles with the second unit's texture projected on them. At its border a filter takes no texel
// of the other side.
StateChange projected_texture(int texture) {
  return {.settings = {state_setting("texture1", texture),
                       state_setting("texture1.coordinates", TextureCoordinates::project),
                       state_setting("texture1.wrap.u", TextureWrap::clamp),
                       state_setting("texture1.wrap.v", TextureWrap::clamp),
                       state_setting("texture1.op", TextureOp::modulate)}};
}

double dark_of(const ShadowOptions& o, bool of_light = false) { return o.dark.value_or(of_light ? 0 : 0.35); }

}  // namespace

void check_shadow(const ShadowOptions& o, const ShadowNames& names) {
  const auto refuse = [](const std::string& name, double is, const std::string& expected) {
    throw InputError(fmt::format("{}: {} is not legal; expected {}", name, is, expected));
  };
  const auto check_point = [&](const std::string& name, const Vec3& point) {
    for (const double x : {point.x, point.y, point.z}) {
      if (!std::isfinite(x)) refuse(name, x, "finite numbers");
    }
  };
  check_point(names.light, o.light);
  if (o.at) check_point(names.at, *o.at);
  if (o.plane) {
    check_point(names.plane, o.plane->point);
    check_point(names.plane, o.plane->normal);
    if (o.plane->normal == Vec3{}) refuse(names.plane, 0, "a normal that is not 0,0,0");
    if (o.volumes)
      throw InputError(fmt::format("{}, {}: exclude each other; expected one", names.plane, names.volumes));
  }
  if (!(o.degrees == 0 || (o.degrees >= least_degrees && o.degrees < 160))) {
    refuse(names.degrees, o.degrees, fmt::format("0, or {} to below 160", least_degrees));
  }
  if (o.size < 1 || o.size > shadow_map_limit) {
    refuse(names.size, o.size, fmt::format("1..{} texels", shadow_map_limit));
  }
  if (o.bias && !(*o.bias >= 0 && *o.bias <= 64)) refuse(names.bias, *o.bias, "0..64 texels");
  if (o.dark && !(*o.dark >= 0 && *o.dark <= 1)) refuse(names.dark, *o.dark, "0..1");
}

Viewpoint view_of(std::span<const Face> casters, const ShadowOptions& options) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3 high = low * -1;
  for (const Face& face : casters) {
    for (const Corner& corner : face.corner) {
      const Vec3& p = corner.position;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  const Vec3& from = options.light;
  const bool is_empty = casters.empty();
  const Vec3 at = options.at ? *options.at : is_empty ? from + Vec3{0, 0, 1} : (low + high) * 0.5;
  Viewpoint view;
  view.width = view.height = options.size;
  const Vec3 line = at - from;
  if (!(length(line) > 0) || !std::isfinite(length(line))) {
    throw InputError("shadow: the light stands at what it looks at, or too far away; expected another point");
  }
  look_from(view, from, at, {0, -1, 0});
  double tangent = std::tan(radians(options.degrees / 2));
  if (options.degrees == 0) {
    const double widest = std::tan(radians(widest_degrees));
    for (const Face& face : casters) {
      for (const Corner& corner : face.corner) {
        const Vec3 d = corner.position - from;
        const double s = dot(view.forward, d);
        const double across = std::max(std::abs(dot(view.right, d)), std::abs(dot(view.down, d)));
        tangent = std::max(tangent, s > 0 ? std::min(across / s, widest) : widest);
      }
    }
    // A texel around what is seen, so that no shadow ends at the map's border.
    tangent = std::max(tangent, 1e-6) * (1 + 2.0 / options.size);
  }
  view.focal = options.size / 2.0 / tangent;
  view.s_min = length(line) * 1e-3;
  view.s_max = view.s_min + 2 * ((is_empty ? 0 : length(high - low)) + length(line));
  std::vector<Triangle> seen;
  ProjectReport report;
  project(casters, view, {.cull = false}, seen, report);
  if (seen.empty()) return view;
  view.s_max = 0;
  double nearest = HUGE_VAL;
  for (const Triangle& triangle : seen) {
    for (const Vertex& v : triangle.v) {
      nearest = std::min(nearest, v.s);
      view.s_max = std::max(view.s_max, 1.01 * v.s);
    }
  }
  // Ratios near 1 give a B that registers do not hold.
  view.s_min = std::min(0.99 * nearest, view.s_max / least_ratio);
  return view;
}

double code_step(const Projector& range, int depth_bits) {
  return (1 / range.s_min - 1 / range.s_max) / (std::exp2(depth_bits) - 1);
}

double lost_by_registers(const Projector& range, int depth_bits, double w) {
  const double share = 2 * std::exp2(-depth_bits);
  constexpr double vertex = 0x1p-22;
  return codes_lost * code_step(range, depth_bits) + (share + vertex * range.s_max / w) / w;
}

// Over the light's picture 1 / W is linear on a triangle's plane, and so is its code. A lookup takes a texel
// whose middle is at most `reach` texels off each way, so the plane there is nearer by at most
// reach (|d/dx| + |d/dy|) of 1 / W. On a convex body no other face is in front of a lit plane. So a point
// that comes nearer by that, and by what codes are rounded, is lit.
ShadowBias bias_of(const Triangle& triangle, const View& view, const Viewpoint& light, int depth_bits) {
  constexpr double reach = 1.125;  // bilinear: 1; map's corners and the lookup's place are rounded
  std::array<Vec3, 3> p;
  double farthest = light.s_min;
  double nearest = light.s_max;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = in_view(position_of(triangle.v[i], view), light);
    farthest = std::max(farthest, std::min(p[i].z, light.s_max));
    nearest = std::min(nearest, std::max(p[i].z, light.s_min));
  }
  const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
  const double from_light = -dot(normal, p[0]);
  const double from_eye = dot(normal, in_view({}, light) - p[0]);
  // Edge on, or without area, it comes as near as the range has it.
  const double slope = from_light == 0
                           ? HUGE_VAL
                           : (std::abs(normal.x) + std::abs(normal.y)) / (std::abs(from_light) * light.focal);
  // Nothing of the map is nearer than s_min.
  const Projector range = range_of(light);
  const double inverse =
      std::min(reach * slope + lost_by_registers(range, depth_bits, nearest), 1 / light.s_min);
  const bool is_seen = (from_light > 0) == (from_eye > 0);
  if (farthest > far_apart * nearest) {
    const auto whole =
        static_cast<std::int64_t>(std::ceil(std::min(inverse / code_step(range, depth_bits), most_codes)));
    return {.codes = is_seen ? whole : -whole};
  }
  const double nearer = inverse * farthest;
  return {.nearer = is_seen ? nearer / (1 + nearer) : -nearer};
}

void give_projection(std::span<Triangle> triangles, const View& view, const Viewpoint& projector,
                     double nearer) {
  for (Triangle& triangle : triangles) {
    for (Vertex& v : triangle.v) {
      const Vec3 d = (position_of(v, view) - projector.position) * (1 - nearer);
      v.project_w = dot(projector.forward, d);
      v.project_x = projector.focal * dot(projector.right, d) + projector.width / 2.0 * v.project_w;
      v.project_y = projector.focal * dot(projector.down, d) + projector.height / 2.0 * v.project_w;
    }
  }
}

Scene shadowed(Scene scene, std::span<const Face> casters, const ShadowOptions& options) {
  check_shadow(options);
  refuse_commands(scene, "a shadow");
  if (scene.triangles.empty()) return scene;
  if (options.plane) {
    // Corners that the perspective has rounded.
    constexpr double thickness = 1e-6;
    const double close = thickness * scene.s_max * length(options.plane->normal);
    const PlanarLight light{options.light};
    return with_planar_shadows(std::move(scene), casters, {&light, 1}, *options.plane, dark_of(options),
                               close);
  }
  if (options.volumes) return with_shadow_volumes(std::move(scene), casters, options.light, dark_of(options));
  const Viewpoint light = view_of(casters, options);
  Pass map{.name = "shadow map",
           .target = light_target,
           .view = ViewChange{.width = options.size,
                              .height = options.size,
                              .s_min = light.s_min,
                              .s_max = light.s_max,
                              .focal = light.focal,
                              .fog = std::optional<Fog>{},
                              .projector = std::optional<Projector>{}},
           .states = {{.settings = {state_setting("color.write", 0)}}}};
  if (scene.light) map.view->light.emplace();
  ProjectReport report;
  project(casters, light, {.cull = false, .clip_sides = true}, map.triangles, report);
  if (map.triangles.empty()) return scene;  // the light sees nothing, so that everything is lit

  const auto texture = static_cast<int>(scene.textures.size());
  const auto texels = static_cast<std::size_t>(options.size) * static_cast<std::size_t>(options.size);
  scene.textures.push_back({"shadow.png", options.size, options.size, std::vector<std::uint8_t>(4 * texels)});
  scene.projector = range_of(light);
  Pass picture{.name = "picture",
               .target = 0,
               .copies = {{.target = light_target, .plane = CopyPlane::depth, .texture = texture}},
               .states = {projected_texture(texture)},
               .triangles = std::move(scene.triangles)};
  const bool of_light = options.light_takes && scene.light;
  if (of_light) picture.states.front().settings.push_back(state_setting("texture1.op", TextureOp::shadow));
  const auto dark = std::lround(255 * dark_of(options, of_light));
  for (const StateSetting& more : {state_setting("texture1.compare", 1), state_setting("texture1.red", dark),
                                   state_setting("texture1.green", dark),
                                   state_setting("texture1.blue", dark), state_setting("color.write", 1)}) {
    picture.states.front().settings.push_back(more);
  }
  std::vector<Pass> passes{std::move(map), std::move(picture)};
  const std::vector<Triangle> seen = std::exchange(passes.back().triangles, {});
  std::int64_t codes = 0;
  for (const Triangle& triangle : seen) {
    // A texel that rises by `bias` texels has its middle by half of that beside its edge.
    const ShadowBias bias = options.bias ? ShadowBias{.nearer = 0.5 * *options.bias / light.focal}
                                         : bias_of(triangle, scene, light, options.depth_bits);
    if (bias.codes != codes) {
      codes = bias.codes;
      const StateChange change{.settings = {state_setting(
                                   "texture1.bias", nearer_is_larger(options.depth_code) ? codes : -codes)}};
      if (passes.back().triangles.empty()) {
        passes.back().states.push_back(change);
      } else {
        passes.push_back({.name = "picture", .states = {change}});
      }
    }
    passes.back().triangles.push_back(triangle);
    give_projection({&passes.back().triangles.back(), 1}, scene, light, bias.nearer);
  }
  scene.triangles.clear();
  move_ranges(scene.quadrics, passes.front().triangles.size());
  flatten(passes, scene);
  return scene;
}

Scene shadowed(Scene scene, std::span<const Face> casters, const ShadowOptions& options,
               const Viewpoint& view) {
  ShadowOptions seen = options;
  seen.light = in_view(options.light, view);
  if (options.at) seen.at = in_view(*options.at, view);
  if (options.plane) {
    seen.plane->point = in_view(options.plane->point, view);
    seen.plane->normal = in_view(view.position + options.plane->normal, view);
  }
  std::vector<Face> faces(casters.begin(), casters.end());
  for (Face& face : faces) {
    for (Corner& corner : face.corner) corner.position = in_view(corner.position, view);
  }
  return shadowed(std::move(scene), faces, seen);
}

Scene with_slide(Scene scene, const SlideOptions& slide) {
  refuse_commands(scene, "a slide");
  if (!(slide.degrees >= least_degrees && slide.degrees < 160)) {
    throw InputError(fmt::format("slide: {} degrees are not legal; expected {} to below 160", slide.degrees,
                                 least_degrees));
  }
  if (scene.triangles.empty()) return scene;
  Viewpoint projector;
  look_from(projector, slide.projector, slide.at, slide.up);
  projector.width = slide.image.width;
  projector.height = slide.image.height;
  projector.focal = slide.image.height / 2.0 / std::tan(radians(slide.degrees / 2));
  const auto texture = static_cast<int>(scene.textures.size());
  scene.textures.push_back(slide.image);
  give_projection(scene.triangles, scene, projector);
  // W is scaled by the range's end alone, and no depth code is looked at.
  double farthest = 0;
  for (const Triangle& triangle : scene.triangles) {
    for (const Vertex& v : triangle.v) farthest = std::max(farthest, v.project_w);
  }
  scene.projector = Projector{0.5 * (farthest > 0 ? farthest : 1), farthest > 0 ? farthest : 1};
  StateChange state = projected_texture(texture);
  state.settings.push_back(state_setting("texture1.outside", ProjectOutside::dark));
  scene.commands.push_back({.before = 0, .what = state});
  return scene;
}

Scene with_slide(Scene scene, const SlideOptions& slide, const Viewpoint& view) {
  SlideOptions seen = slide;
  seen.projector = in_view(slide.projector, view);
  seen.at = in_view(slide.at, view);
  seen.up = in_view(view.position + slide.up, view);
  return with_slide(std::move(scene), seen);
}

}  // namespace bitspan
