// SPDX-License-Identifier: Apache-2.0
#include "scene/demo.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "config/config.hpp"
#include "scene/geometry.hpp"
#include "scene/plan.hpp"
#include "scene/project.hpp"
#include "scene/shapes.hpp"
#include "scene/transform.hpp"

namespace bitspan {
namespace {

constexpr Rgba transparent_code{255, 0, 255, 255};

// Returns a repeatable speckle in -range..range.
int speckle(int i, int j, int range) {
  return static_cast<int>(texel_hash(i, j) % static_cast<std::uint32_t>(2 * range + 1)) - range;
}

Rgba tone(int r, int g, int b, int change) {
  const auto code = [change](int c) { return static_cast<std::uint8_t>(std::clamp(c + change, 0, 255)); };
  return {code(r), code(g), code(b), 255};
}

Rgba floor_texel(int i, int j) {
  const bool light = (i / 16 + j / 16) % 2 == 0;
  const int change = speckle(i, j, 10);
  return light ? tone(222, 214, 196, change) : tone(70, 84, 96, change);
}

Rgba brick_texel(int i, int j) {
  const int course = j / 10;
  const int along = (i + (course % 2) * 12) % 24;
  if (j % 10 == 0 || along == 0) return tone(196, 190, 178, speckle(i, j, 6));
  return tone(164, 74, 52, speckle(i, j, 16) + speckle((i + (course % 2) * 12) / 24, course, 14));
}

Rgba wood_texel(int i, int j) {
  const int ring = (i * 5 + (j * j) / 40) % 37;
  return tone(150 + ring, 104 + ring, 58 + ring / 2, speckle(i, j, 8));
}

Rgba globe_texel(int i, int j) {
  if (i % 8 == 0 || j % 8 == 0) return tone(236, 232, 210, 0);
  return (i / 8 + j / 8) % 2 == 0 ? tone(40, 96, 170, speckle(i, j, 12))
                                  : tone(58, 142, 96, speckle(i, j, 12));
}

Rgba grille_texel(int i, int j) {
  const bool bar = (i + j) % 10 < 3 || (i + 20 - j) % 10 < 3;
  return bar ? tone(64, 62, 60, speckle(i, j, 14)) : transparent_code;
}

// The alpha plane runs from clear in the middle of a pane to opaque at its lead frame.
Rgba glass_texel(int i, int j) {
  const int x = i % 13, y = j % 12;
  if (x == 0 || y == 0) return {52, 52, 58, 255};
  const int pane = (i / 13 + 2 * (j / 12)) % 4;
  constexpr std::array<Rgba, 4> panes{
      {{214, 60, 48, 0}, {240, 188, 50, 0}, {52, 110, 204, 0}, {66, 160, 88, 0}}};
  Rgba value = panes[static_cast<std::size_t>(pane)];
  value[3] = static_cast<std::uint8_t>(60 + 12 * std::max(std::abs(2 * x - 13), std::abs(2 * y - 12)));
  return value;
}

enum DemoTexture { floor_texture, brick_texture, wood_texture, globe_texture, grille_texture, glass_texture };

using Color = std::array<double, 4>;
constexpr Color white{1, 1, 1, 1};

// L1 of the lecture notes: Lambert with an ambient share.
Color lit(const Vec3& normal, const Color& color) {
  const Vec3 light{0.48, 0.8, 0.36};  // length 1
  const double n = length(normal);
  const double shade = on_grid(0.35 + 0.65 * std::max(0.0, dot(normal, light) / (n > 0 ? n : 1)));
  return {color[0] * shade, color[1] * shade, color[2] * shade, color[3]};
}

// p: counter-clockwise seen from outside, beginning with the corner that carries texel (u0, v1): bottom left,
// bottom right, top right, top left.
void add_quad(std::vector<Face>& faces, const std::array<Vec3, 4>& p, double u0, double v0, double u1,
              double v1, const std::array<Color, 4>& c, int texture) {
  add_quad(faces,
           {{{{p[0]}, {u0, v1, c[0]}},
             {{p[1]}, {u1, v1, c[1]}},
             {{p[2]}, {u1, v0, c[2]}},
             {{p[3]}, {u0, v0, c[3]}}}},
           texture);
}

void add_flat_quad(std::vector<Face>& faces, const std::array<Vec3, 4>& p, double u, double v, int texture) {
  const Color c = lit(cross(p[1] - p[0], p[2] - p[0]), white);
  add_quad(faces, p, 0, 0, u, v, {c, c, c, c}, texture);
}

// u, v: texels of a side; the top is as deep as it is wide.
void add_box(std::vector<Face>& faces, const Vec3& foot, double half_x, double half_z, double height,
             double turn, double u, double v, int texture) {
  auto sides = box_sides(foot, half_x, half_z, height, turn);
  for (std::array<Vec3, 4>& side : sides) {
    for (Vec3& p : side) p = on_grid(p);
    add_flat_quad(faces, side, u, &side == &sides.back() ? u : v, texture);
  }
}

void add_pyramid(std::vector<Face>& faces, const Vec3& foot, double half, double height, double turn,
                 int texture) {
  const Vec3 apex = foot + Vec3{0, height, 0};
  std::array<Vec3, 4> base;
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = turn + std::numbers::pi / 2 * (static_cast<double>(i) + 0.5);
    base[i] = on_grid(foot + Vec3{half * std::cos(a), 0, -half * std::sin(a)});
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& a = base[i];
    const Vec3& b = base[(i + 1) % 4];
    const Color c = lit(cross(b - a, apex - a), white);
    faces.push_back({{{{{a}, {0, 53, c}}, {{b}, {74, 53, c}}, {{apex}, {37, 0, c}}}}, texture, false});
  }
}

// A surface of quads over parameters a (columns, around) and b (rows, upward); normal and colour by
// functions.
void add_surface(std::vector<Face>& faces, int columns, int rows, double u, double v, int texture,
                 const std::function<std::pair<Vec3, Vec3>(double, double)>& point_and_normal,
                 const std::function<Color(double, double)>& color) {
  add_surface(faces, columns, rows, texture, [&](int i, int j) {
    const double a = static_cast<double>(i) / columns, b = static_cast<double>(j) / rows;
    const auto [position, normal] = point_and_normal(a, b);
    return Corner{{on_grid(position)}, {u * a, v * (1 - b), lit(normal, color(a, b))}};
  });
}

void add_sphere(std::vector<Face>& faces, const Vec3& centre, double radius, int texture) {
  add_surface(
      faces, 24, 12, 128, 48, texture,
      [&](double a, double b) {
        const double longitude = 2 * std::numbers::pi * a, latitude = std::numbers::pi * (b - 0.5);
        const Vec3 n{std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                     -std::cos(latitude) * std::sin(longitude)};
        return std::pair{centre + n * radius, n};
      },
      [](double, double) { return white; });
}

// Untextured, coloured around both circles.
void add_torus(std::vector<Face>& faces, const Vec3& centre, double large, double small, double tilt) {
  add_surface(
      faces, 28, 14, 0, 0, -1,
      [&](double a, double b) {
        const double p = 2 * std::numbers::pi * a, q = 2 * std::numbers::pi * b;
        const auto turned = [tilt](const Vec3& r) {
          return Vec3{r.x, r.y * std::cos(tilt) - r.z * std::sin(tilt),
                      r.y * std::sin(tilt) + r.z * std::cos(tilt)};
        };
        const Vec3 out{std::cos(p), 0, -std::sin(p)};
        const Vec3 n = out * std::cos(q) + Vec3{0, std::sin(q), 0};
        return std::pair{centre + turned(out * large + n * small), turned(n)};
      },
      [](double a, double b) {
        const auto wave = [](double t) { return on_grid(0.6 + 0.4 * std::cos(2 * std::numbers::pi * t)); };
        return Color{wave(a), wave(a + 1.0 / 3), wave(b), 1};
      });
}

// A pane standing on the floor, seen from both sides.
void add_pane(std::vector<Face>& faces, const Vec3& left, const Vec3& right, double height, double u,
              double v, const Color& color, int texture) {
  const Vec3 up{0, height, 0};
  add_quad(faces, {left, right, right + up, left + up}, 0, 0, u, v, {color, color, color, color}, texture);
}

Rgba checker_texel(int i, int j) {
  return (i / 8 + j / 8) % 2 == 0 ? Rgba{240, 240, 240, 255} : Rgba{16, 16, 16, 255};
}

// One quad from below the viewer to beyond the horizon, with 4 texels per unit.
void add_floor(std::vector<Face>& faces, int texture) {
  const double half = 960, far = -1010;
  add_quad(faces, {Vec3{-half, 0, 2}, Vec3{half, 0, 2}, Vec3{half, 0, far}, Vec3{-half, 0, far}}, -4 * half,
           4 * far, 4 * half, 8, {white, white, white, white}, texture);
}

Viewpoint view_of(const Scene& scene, const Vec3& target) {
  Viewpoint view = viewer_of(scene);
  look_at(view, {0, 7, 0}, target, {0, 1, 0});
  return view;
}

// The textures of the demo, by the numbers above.
std::vector<Texture> demo_textures() {
  return {painted("floor.png", 32, 32, floor_texel),   painted("brick.png", 48, 30, brick_texel),
          painted("wood.png", 37, 53, wood_texel),     painted("globe.png", 64, 48, globe_texel),
          painted("grille.png", 20, 20, grille_texel), painted("glass.png", 52, 24, glass_texel)};
}

std::vector<Face> demo_solids() {
  std::vector<Face> solids;
  add_floor(solids, floor_texture);
  add_box(solids, {-7, 0, -29}, 4, 4, 8, 0.5, 48, 30, brick_texture);
  add_pyramid(solids, {-4, 0, -26}, 6, 10, 0.2, wood_texture);
  add_sphere(solids, {7.5, 4.5, -27}, 4.5, globe_texture);
  add_torus(solids, {7.5, 4.5, -27}, 5.2, 1.4, 0.6);
  for (const double z : {-50.0, -80.0, -130.0, -210.0, -340.0, -550.0}) {
    add_box(solids, {-14, 0, z}, 2, 2, 18, 0, 24, 90, brick_texture);
    add_box(solids, {14, 0, z}, 2, 2, 18, 0, 24, 90, brick_texture);
  }
  return solids;
}

// Seen from both sides, and drawn last.
std::vector<Face> demo_sheets() {
  std::vector<Face> sheets;
  add_pane(sheets, {-9, 0, -19}, {-1, 0, -15}, 3, 90, 30, white, grille_texture);
  add_pane(sheets, {2, 0, -17}, {9, 0, -19}, 5.5, 52, 24, {1, 1, 1, 0.875}, glass_texture);
  return sheets;
}

}  // namespace

Scene floor_scene(int width, int height) {
  Scene scene = empty_scene("floor", width, height);
  scene.textures = {painted("checker.png", 64, 64, checker_texel)};
  const Viewpoint view = view_of(scene, {3, 4, -24});
  std::vector<Face> faces;
  add_floor(faces, 0);
  ProjectReport report;
  project(faces, view, {.cull = true, .clip_sides = true}, scene.triangles, report);
  return scene;
}

Scene demo_scene(int width, int height, const std::optional<ShadowOptions>& shadow) {
  Scene scene = empty_scene("demo", width, height);
  scene.fog = Fog{{176, 196, 214}, 240};
  scene.textures = demo_textures();
  const Viewpoint view = view_of(scene, {0, 4, -24});
  ProjectReport report;
  std::vector<Face> faces = demo_solids();
  const std::vector<Face> sheets = demo_sheets();
  project(faces, view, {.cull = true, .clip_sides = true}, scene.triangles, report);
  project(sheets, view, {.cull = false, .clip_sides = true}, scene.triangles, report);
  if (!shadow) return scene;
  faces.insert(faces.end(), sheets.begin(), sheets.end());
  return shadowed(std::move(scene), faces, *shadow, view);
}

Scene mirror_scene(int width, int height) {
  Scene scene = empty_scene("mirror", width, height);
  scene.fog = Fog{{176, 196, 214}, 240};
  scene.textures = demo_textures();
  constexpr int size = 256;  // of the mirror's picture, pixels
  const auto mirror_texture = static_cast<int>(scene.textures.size());
  scene.textures.push_back(painted("mirror.png", size, size, [](int, int) { return Rgba{}; }));
  const Vec3 eye{0, 7, 0};
  constexpr double at = -36, half = 7.5, low = 1, high = 13;  // z, and the ends of x and y

  // The eye behind the mirror, which looks through it: nothing in front of the mirror's plane is seen.
  Viewpoint behind;
  behind.width = behind.height = size;
  behind.focal = 16 * -at;  // a unit of the mirror is 16 pixels
  behind.s_min = -at;
  behind.s_max = scene.s_max;
  const Vec3 image{eye.x, eye.y, 2 * at - eye.z};
  look_at(behind, image, image + Vec3{0, 0, 1}, {0, 1, 0});
  Pass reflection{
      .name = "reflection",
      .target = 1,
      .view = ViewChange{.width = size, .height = size, .s_min = behind.s_min, .focal = behind.focal}};
  ProjectReport report;
  project(demo_solids(), behind, {.cull = true, .clip_sides = true}, reflection.triangles, report);
  project(demo_sheets(), behind, {.cull = false, .clip_sides = true}, reflection.triangles, report);

  // Where a point of the mirror lies in that picture.
  const auto u = [](double x) { return size / 2.0 - 16 * x; };
  const auto v = [&](double y) { return size / 2.0 - 16 * (y - eye.y); };
  std::vector<Face> solids = demo_solids();
  constexpr double border = 0.75, behind_it = 0.25;
  add_flat_quad(
      solids,
      {Vec3{-half - border, low - border, at - behind_it}, Vec3{half + border, low - border, at - behind_it},
       Vec3{half + border, high + border, at - behind_it},
       Vec3{-half - border, high + border, at - behind_it}},
      37, 53, wood_texture);
  add_quad(solids, {Vec3{-half, low, at}, Vec3{half, low, at}, Vec3{half, high, at}, Vec3{-half, high, at}},
           u(-half), v(high), u(half), v(low), {white, white, white, white}, mirror_texture);
  Pass picture{.name = "picture", .copies = {{1, CopyPlane::color, mirror_texture}}};
  const Viewpoint view = view_of(scene, {0, 4, -24});
  project(solids, view, {.cull = true, .clip_sides = true}, picture.triangles, report);
  project(demo_sheets(), view, {.cull = false, .clip_sides = true}, picture.triangles, report);
  flatten(std::array{reflection, picture}, scene);
  return scene;
}

}  // namespace bitspan
