// SPDX-License-Identifier: Apache-2.0
#include "scene/room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "config/modes.hpp"
#include "scene/light.hpp"
#include "scene/plan.hpp"
#include "scene/project.hpp"
#include "scene/relief.hpp"
#include "scene/shadow.hpp"
#include "scene/shapes.hpp"

namespace bitspan {
namespace {

constexpr Vec3 eye{0.4, 2.1, 6.6}, target{0, 1.05, 0};
constexpr Light lamp{
    .is_point = true, .place = {2.6, 3.9, 3.2}, .ambient = 0.25, .specular = 0.25, .exponent = 24};

enum RoomTexture { boards_texture, bricks_texture, normals_texture };

// A repeatable number 0..1.
double grain(int i, int j) { return static_cast<double>(texel_hash(i, j) % 4096) / 4095; }

using Rgb = std::array<double, 3>;
Texture texture_of(const char* name, int width, int height, Rgb (*texel)(int, int)) {
  return painted(name, width, height, [texel](int i, int j) {
    const Rgb value = texel(i, j);
    const auto code = [&](std::size_t c) {
      return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value[c], 0.0, 1.0)));
    };
    return Rgba{code(0), code(1), code(2), 255};
  });
}

Rgb board(int i, int j) {
  const int plank = j / 32;
  const double tone = 0.75 + 0.15 * grain(plank, 7) + 0.08 * grain(i / 9, j) - (j % 32 < 1 ? 0.4 : 0);
  return {0.62 * tone, 0.44 * tone, 0.28 * tone};
}

constexpr int wall_width = 256, wall_height = 96, brick_width = 32, brick_height = 16;

// Of the wall, in texels: mortar, and bricks with slopes at their edges; it repeats.
double height_at(int i, int j) {
  i = (i + wall_width) % wall_width;
  j = (j + wall_height) % wall_height;
  const int along = (i + (j / brick_height % 2) * brick_width / 2) % brick_width;
  const int down = j % brick_height;
  const int inside =
      std::min(std::min(along, brick_width - 1 - along), std::min(down, brick_height - 1 - down));
  return std::clamp((inside - 0.5) / 2, 0.0, 1.0) * 2.5 + 0.7 * grain(i, j);
}
Rgb brick(int i, int j) {
  const double share = std::clamp((height_at(i, j) - 0.7) / 1.2, 0.0, 1.0);
  const int course = j / brick_height;
  const double tone =
      0.85 +
      0.3 * grain((i + (course % 2) * brick_width / 2) / brick_width % (wall_width / brick_width), course);
  const auto mixed = [&](double of_brick, double of_mortar) {
    return share * of_brick * tone + (1 - share) * of_mortar;
  };
  return {mixed(0.66, 0.7), mixed(0.33, 0.67), mixed(0.24, 0.62)};
}
Rgb brick_normal(int i, int j) {
  const Vec3 n = of_length_1(
      {(height_at(i - 1, j) - height_at(i + 1, j)) / 2, (height_at(i, j - 1) - height_at(i, j + 1)) / 2, 1});
  return {0.5 + n.x / 2, 0.5 + n.y / 2, 0.5 + n.z / 2};
}

using Color = std::array<double, 4>;

// p: counterclockwise seen from outside, from the corner at texel (0, v) on; u, v: its texels.
void add_quad(std::vector<Face>& faces, const std::array<Vec3, 4>& p, double u, double v, const Color& color,
              int texture) {
  const Vec3 n = of_length_1(cross(p[1] - p[0], p[2] - p[0]));
  constexpr std::array<std::array<double, 2>, 4> at{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  std::array<Corner, 4> q;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = Corner{{on_grid(p[i])}, {u * at[i][0], v * at[i][1], color}};
    q[i].u2 = q[i].u;
    q[i].v2 = q[i].v;
    set_normal(q[i], n);
  }
  add_quad(faces, q, texture);
}

// A body of revolution about an axis through `middle`, of a circle of radius `thick` whose centre goes round
// at `around`, 0 for a ball.
void add_round(std::vector<Face>& faces, const Vec3& middle, double around, double thick, int columns,
               int rows, const Color& color) {
  add_surface(faces, columns, rows, -1, [&](int i, int j) {
    const double a = 2 * std::numbers::pi * i / columns;
    const double b = around > 0 ? 2 * std::numbers::pi * j / rows
                                : std::numbers::pi * (static_cast<double>(j) / rows - 0.5);
    const Vec3 out{std::sin(a), 0, std::cos(a)};
    const Vec3 n = out * std::cos(b) + Vec3{0, std::sin(b), 0};
    Corner c{{on_grid(middle + out * around + n * thick)}, {0, 0, color}};
    set_normal(c, n);
    return c;
  });
}

std::vector<Face> solids() {
  std::vector<Face> out;
  add_quad(out, {Vec3{-5, 0, 5}, {5, 0, 5}, {5, 0, -3}, {-5, 0, -3}}, 640, 512, {1, 1, 1, 1}, boards_texture);
  add_round(out, {-1.35, 0.8, -0.2}, 0, 0.8, 72, 36, {0.95, 0.93, 0.86, 1});
  for (const std::array<Vec3, 4>& side : box_sides({1.35, 0, -1}, 0.55, 0.55, 1.1, 0.5)) {
    add_quad(out, side, 0, 0, {0.35, 0.62, 0.5, 1}, -1);
  }
  add_round(out, {0.35, 0.22, 1}, 0.45, 0.22, 48, 20, {0.9, 0.62, 0.16, 1});
  return out;
}
std::vector<Face> wall() {
  std::vector<Face> out;
  add_quad(out, {Vec3{-5, 0, -3}, {5, 0, -3}, {5, 3.75, -3}, {-5, 3.75, -3}}, wall_width, wall_height,
           {1, 1, 1, 1}, bricks_texture);
  return out;
}
std::vector<Face> glass() {
  std::vector<Face> out;
  add_quad(out, {Vec3{0.55, 0, 0.3}, {2.1, 0, 1.3}, {2.1, 1.7, 1.3}, {0.55, 1.7, 0.3}}, 0, 0,
           {0.55, 0.85, 0.95, 0.3}, -1);
  return out;
}

}  // namespace

RoomOptions room_options(const Config& config) {
  return {.lamp = has_light_points(config),
          .shadow = has_project(config.project),
          .lamp_takes_shadow = has_light_shadow(config),
          .relief = has_light_points(config) && has_relief(config),
          .depth_bits = config.depth_bits,
          .depth_code = config.depth_code};
}

Scene room_scene(const RoomOptions& options, int width, int height) {
  Scene scene = empty_scene("room", width, height);
  scene.s_max = 16;
  scene.focal = std::max(1.3 * height, 0.9 * width);
  scene.background = {24, 26, 32};
  scene.textures = {texture_of("boards.png", 128, 64, board),
                    texture_of("bricks.png", wall_width, wall_height, brick),
                    texture_of("normals.png", wall_width, wall_height, brick_normal)};
  Viewpoint view = viewer_of(scene);
  look_at(view, eye, target, {0, 1, 0});
  std::vector<Face> bodies = solids(), bricks = wall(), pane = glass();
  const Light light = light_of({.light = lamp}, view, target);
  if (options.lamp) {
    scene.light = light;
  } else {
    for (std::vector<Face>* faces : {&bodies, &bricks, &pane}) {
      light_corners(*faces, light, view);
      for (Face& face : *faces) {
        for (Corner& corner : face.corner) set_normal(corner, {});
      }
    }
  }
  if (options.relief) give_relief(bricks, place_of(lamp));

  ProjectReport report;
  const auto draw = [&](const std::vector<Face>& faces, bool cull) {
    // Normals are those of the viewer's space.
    project(faces, view, {.cull = cull, .clip_sides = true}, scene.triangles, report);
  };
  std::vector<Face> casters = bodies;
  draw(bodies, true);
  if (!options.relief) {
    // The second texture unit has either the shadow or the relief.
    draw(bricks, true);
    casters.insert(casters.end(), bricks.begin(), bricks.end());
  }
  if (options.shadow) {
    const ShadowOptions shadow{.light = place_of(lamp),
                               .at = Vec3{0, 0.3, 0},
                               .degrees = 60,
                               .size = width > 400 ? 1024 : 512,
                               .depth_bits = options.depth_bits,
                               .depth_code = options.depth_code,
                               .light_takes = options.lamp_takes_shadow};
    scene = shadowed(std::move(scene), casters, shadow, view);
  }
  const auto from_here = [&](const std::vector<StateSetting>& settings) {
    scene.commands.push_back({.before = scene.triangles.size(), .what = StateChange{.settings = settings}});
  };
  if (options.relief) {
    std::vector<StateSetting> settings = relief_state().settings;
    settings.push_back(state_setting("texture1", normals_texture));
    settings.push_back(state_setting("texture1.coordinates", TextureCoordinates::uv));
    settings.push_back(state_setting("texture1.wrap.u", TextureWrap::cyclic));
    settings.push_back(state_setting("texture1.wrap.v", TextureWrap::cyclic));
    settings.push_back(state_setting("texture1.compare", 0));
    from_here(settings);
    draw(bricks, true);
  }
  if (options.shadow || options.relief) from_here({state_setting("texture1", -1)});
  draw(pane, false);
  return scene;
}

}  // namespace bitspan
