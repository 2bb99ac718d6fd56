// SPDX-License-Identifier: Apache-2.0
// extreme_scenes() and triangles_scene() of scene/demo.hpp: legal triangles at the ends of every range, and
// of a size.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "scene/demo.hpp"
#include "scene/exact.hpp"
#include "scene/random.hpp"

namespace bitspan {
namespace {

// Two textures of odd sizes: opaque, and one with holes (transparent code) and a coarse alpha plane.
std::vector<Texture> test_textures() {
  Texture opaque{"opaque.png", 13, 7, {}};
  Texture sheer{"sheer.png", 5, 3, {}};
  for (Texture* texture : {&opaque, &sheer}) {
    for (int j = 0; j < texture->height; ++j) {
      for (int i = 0; i < texture->width; ++i) {
        const bool hole = texture == &sheer && (i + j) % 4 == 3;
        const auto code = [](int x) { return static_cast<std::uint8_t>(x & 255); };
        texture->rgba.insert(
            texture->rgba.end(),
            {hole ? std::uint8_t{255} : code(i * 19 + 8), hole ? std::uint8_t{0} : code(j * 36 + 4),
             hole ? std::uint8_t{255} : code((i * j * 11) ^ 90),
             texture == &sheer ? code(85 * (1 + (i + 2 * j) % 3)) : std::uint8_t{255}});
      }
    }
  }
  return {std::move(opaque), std::move(sheer)};
}

Scene frame(const char* name, int width, int height) {
  Scene scene;
  scene.name = name;
  scene.width = width;
  scene.height = height;
  scene.s_min = 1;
  scene.s_max = 1000;
  scene.focal = 0.9 * width;
  scene.background = {20, 24, 40};
  scene.textures = test_textures();
  return scene;
}

using Point = std::array<double, 2>;

// Depth, texture and colour follow from the position and the running number, so that every register has work
// to do.
void add(Scene& scene, const std::array<Point, 3>& p, int texture = 0) {
  const auto index = static_cast<double>(scene.triangles.size());
  Triangle t;
  t.texture = texture;
  for (std::size_t i = 0; i < 3; ++i) {
    const double k = static_cast<double>(i);
    Vertex& v = t.v[i];
    v.x = p[i][0];
    v.y = p[i][1];
    v.s = std::clamp(scene.s_min * (2 + std::fmod(index * 5 + k * 3, 17)), scene.s_min, scene.s_max);
    v.u = std::fmod(index * 7 + k * 11, 40) - 12.25;
    v.v = std::fmod(index * 3 + k * 13, 40) - 9.75;
    v.c = {std::fmod(index + k, 5) / 4, std::fmod(index * 2 + k, 3) / 2, std::fmod(index + k * 2, 9) / 8, 1};
  }
  if (orientation(t) != 0) scene.triangles.push_back(t);
}

Scene slivers() {
  Scene scene = frame("slivers", 320, 200);
  for (int i = 0; i < 40; ++i) {
    const double y = 3.0 + 4.7 * i;
    add(scene, {{{2.0, y}, {318.0, y + 0.07 * i}, {160.0, y + 0.0625 + 0.02 * i}}});
  }
  for (int i = 0; i < 40; ++i) {
    const double x = 5.5 + 7.8 * i;
    add(scene, {{{x, 1.0}, {x + 0.09, 100.0}, {x + 0.05 * i, 199.0}}});
  }
  for (int i = 0; i < 16; ++i) {  // along the diagonals, thinner than a pixel
    add(scene, {{{10.0 + i, 10.0}, {190.0 + i, 190.0}, {190.3 + i, 189.9}}});
  }
  add(scene, {{{0.0, 100.0}, {320.0, 100.0}, {160.0, 100.0 + 0x1p-40}}});  // none left after the snap
  return scene;
}

Scene one_pixel() {
  Scene scene = frame("one-pixel", 64, 64);
  Random random(1);
  for (int i = 0; i < 400; ++i) {
    const double x = random.uniform(0, 64), y = random.uniform(0, 64);
    std::array<Point, 3> p;
    for (Point& q : p) q = {x + random.uniform(-0.8, 0.8), y + random.uniform(-0.8, 0.8)};
    add(scene, p, i % 3 - 1);
  }
  return scene;
}

Scene outside() {
  Scene scene = frame("outside", 160, 120);
  // Wholly outside on each side, then reaching in from each side and corner, then around the whole screen.
  add(scene, {{{-90, 10}, {-5, 60}, {-60, 110}}});
  add(scene, {{{165, 10}, {260, 60}, {170, 110}}});
  add(scene, {{{10, -80}, {150, -60}, {70, -1}}});
  add(scene, {{{10, 121}, {150, 130}, {70, 300}}});
  add(scene, {{{-200, 20}, {60, 40}, {-150, 90}}});
  add(scene, {{{400, 30}, {100, 70}, {300, 100}}});
  add(scene, {{{40, -300}, {90, 30}, {120, -250}}});
  add(scene, {{{30, 400}, {80, 80}, {140, 500}}});
  add(scene, {{{-50, -50}, {40, -20}, {-20, 40}}});
  add(scene, {{{210, 170}, {130, 118}, {158, 90}}});
  add(scene, {{{-3000, -2000}, {3500, -1900}, {80, 4000}}}, 1);
  add(scene, {{{160, 0}, {160, 120}, {300, 60}}});  // touches the right border without covering a centre
  add(scene, {{{0, 120}, {160, 120}, {80, 240}}});
  return scene;
}

Scene depth_ends() {
  Scene scene = frame("depth-ends", 200, 150);
  for (int i = 0; i < 27; ++i) {
    const int column = i % 9, row = i / 9;
    const double x = 8 + 20 * column, y = 5 + 45 * row;
    add(scene, {{{x, y}, {x + 18.3, y + 6.1}, {x + 4.4, y + 40.2}}}, i % 2);
    const std::array<double, 3> ends{scene.s_min, std::sqrt(scene.s_min * scene.s_max), scene.s_max};
    int digits = i;
    for (Vertex& v : scene.triangles.back().v) {
      v.s = ends[static_cast<std::size_t>(digits % 3)];
      digits /= 3;
    }
  }
  add(scene, {{{0, 0}, {200, 0}, {100, 150}}});
  scene.triangles.back().v[0].s = scene.s_min;
  scene.triangles.back().v[1].s = scene.s_min;
  scene.triangles.back().v[2].s = scene.s_max;
  return scene;
}

Scene wide() {
  Scene scene = frame("wide", 16384, 24);
  scene.focal = 9000;
  add(scene, {{{0, 0}, {16384, 1}, {8000, 24}}});
  add(scene, {{{0, 24}, {16384, 23.5}, {16384, 12}}}, 1);
  add(scene, {{{-8000, 4}, {16384, 6}, {16384, 11}}});
  add(scene, {{{0, 8.3}, {16384, 8.9}, {0, 9.4}}}, 1);
  return scene;
}

// Closed fans: every inner edge is shared by two triangles, and the outline by none. Opaque, one depth, so
// that a pixel drawn twice or never shows in the counts.
Scene fans() {
  Scene scene = frame("shared-edges", 256, 256);
  Random random(2);
  const std::array<Point, 4> centres{{{64, 64}, {192.5, 64.5}, {63.40625, 191.71875}, {192.5, 192}}};
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const int spokes = 5 + 9 * static_cast<int>(k);
    std::vector<Point> rim;
    for (int i = 0; i < spokes; ++i) {
      const double angle = 2 * std::numbers::pi * i / spokes;
      const double radius = random.uniform(35, 62);
      rim.push_back({std::round((centres[k][0] + radius * std::cos(angle)) * 64) / 64,
                     std::round((centres[k][1] + radius * std::sin(angle)) * 64) / 64});
    }
    for (std::size_t i = 0; i < rim.size(); ++i)
      add(scene, {centres[k], rim[i], rim[(i + 1) % rim.size()]}, -1);
  }
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.s = 10;
  }
  return scene;
}

Scene windings() {
  Scene scene = frame("both-windings", 200, 100);
  for (int i = 0; i < 6; ++i) {  // every order of the same three corners
    const double x = 4 + 33 * i;
    const std::array<Point, 3> p{{{x, 10.3}, {x + 28.2, 44.7}, {x + 9.6, 91.1}}};
    constexpr std::array<std::array<std::size_t, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    const auto& order = orders[static_cast<std::size_t>(i)];
    add(scene, {p[order[0]], p[order[1]], p[order[2]]});
  }
  return scene;
}

Scene flats() {
  Scene scene = frame("flat-top-bottom", 200, 100);
  for (int i = 0; i < 8; ++i) {
    const double x = 3 + 24 * i, y = 5 + 0.125 * i;
    add(scene, {{{x, y}, {x + 20, y}, {x + 7.3, y + 40}}}, i % 2);
    add(scene, {{{x + 7.3, y + 46}, {x, y + 86}, {x + 20, y + 86}}}, i % 2);
  }
  add(scene, {{{10, 49.5}, {190, 49.5}, {100, 50.5}}});  // flat edge through pixel centres
  add(scene, {{{10, 48.5}, {190, 49.5}, {100, 49.5}}});
  return scene;
}

Scene centres() {
  Scene scene = frame("pixel-centres", 96, 96);
  Random random(3);
  for (int i = 0; i < 150; ++i) {
    std::array<Point, 3> p;
    for (Point& q : p) {
      q = {static_cast<double>(random.integer(-4, 99)) + 0.5,
           static_cast<double>(random.integer(-4, 99)) + 0.5};
    }
    add(scene, p, static_cast<int>(random.integer(-1, 1)));
  }
  for (int i = 0; i < 12; ++i) {  // right angles on centres: edges pass exactly through rows of centres
    const double a = 0.5 + 8 * i;
    add(scene, {{{a, 0.5}, {a, 8.5}, {a + 8, 8.5}}});
    add(scene, {{{a, 0.5}, {a + 8, 8.5}, {a + 8, 0.5}}});
  }
  return scene;
}

}  // namespace

Scene triangles_scene(int size, int width, int height) {
  Scene scene = frame("triangles", width, height);
  Random random(static_cast<std::uint64_t>(size));
  const auto area = static_cast<double>(size) * size;
  const double wanted = 8.0 * width * height / area;
  const std::size_t count = static_cast<std::size_t>(std::clamp(wanted, 200.0, 40000.0));
  while (scene.triangles.size() < count) {
    const double x = random.uniform(0, width), y = random.uniform(0, height);
    const double s = random.log_uniform(scene.s_min * 1.25, scene.s_max / 1.25);
    const double texels = size * random.log_uniform(0.25, 4);
    Triangle t;
    t.texture = 0;
    for (Vertex& v : t.v) {
      v.x = std::round((x + random.uniform(-0.5, 0.5) * size) * 1024) / 1024;
      v.y = std::round((y + random.uniform(-0.5, 0.5) * size) * 1024) / 1024;
      v.s = s * random.uniform(0.875, 1.125);
      v.u = random.uniform(-0.5, 0.5) * texels;
      v.v = random.uniform(-0.5, 0.5) * texels;
      for (std::size_t i = 0; i < 3; ++i) v.c[i] = random.unit();
    }
    if (orientation(t) != 0) scene.triangles.push_back(t);
  }
  return scene;
}

std::vector<Scene> extreme_scenes() {
  std::vector<Scene> scenes;
  scenes.push_back(slivers());
  scenes.push_back(one_pixel());
  scenes.push_back(outside());
  scenes.push_back(depth_ends());
  scenes.push_back(wide());
  scenes.push_back(fans());
  scenes.push_back(windings());
  scenes.push_back(flats());
  scenes.push_back(centres());
  return scenes;
}

}  // namespace bitspan
