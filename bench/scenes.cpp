// SPDX-License-Identifier: Apache-2.0
#include "bench/scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/project.hpp"
#include "scene/shadow.hpp"

namespace bitspan::bench {
namespace {

constexpr int frame_width = 1024;
constexpr int frame_height = 768;
constexpr int texture_size = 256;
constexpr std::string_view back_suffix = "-back", mip_suffix = "-mip", blend_suffix = "-blend",
                           shadow_suffix = "-shadow", phong_suffix = "-phong";
constexpr double mip_texels = 4;    // per pixel
constexpr double far_viewer = 1e6;  // focal length, pixels
constexpr std::array<Cloud, 3> all_clouds{Cloud{"big", 200, 40000}, Cloud{"medium", 20000, 400},
                                          Cloud{"small", 500000, 16}};

// Smooth waves with a little noise from texel to texel: a renderer that takes the wrong texel shows, one that
// takes the neighbour does not. Of noise alone, one that leaves levels out shows, too.
Texture make_texture(double height, int noise) {
  Texture t;
  t.name = "waves";
  t.width = texture_size;
  t.height = texture_size;
  Random random(7);
  const auto wave = [](int i) {
    return std::sin(2 * std::numbers::pi * static_cast<double>(i) / texture_size);
  };
  const auto code = [&](double level) {
    return static_cast<std::uint8_t>(std::lround(128 + height * level) + random.integer(-noise, noise));
  };
  for (int y = 0; y < texture_size; ++y) {
    for (int x = 0; x < texture_size; ++x) {
      t.rgba.push_back(code(wave(2 * x)));
      t.rgba.push_back(code(wave(x + y)));
      t.rgba.push_back(code(wave(3 * y)));
      t.rgba.push_back(255);
    }
  }
  return t;
}

// A code from 64 to 191, so that every triangle of the scene shows the ones behind it.
double translucent_alpha(std::size_t index) { return static_cast<double>(64 + index * 37 % 128) / 255; }

// Where a lamp stands, as the viewer sees.
constexpr Vec3 lamp_place{-6, -9, -2};

// Lit by the lamp per pixel. A face has one normal, towards the viewer: OpenGL 2.1 interpolates no other one
// linearly in the picture.
void light_by_lamp(Scene& scene) {
  scene.light = Light{.is_point = true,
                      .place = {lamp_place.x, lamp_place.y, lamp_place.z},
                      .ambient = 0.2,
                      .specular = 0.3,
                      .exponent = 32};
  for (Triangle& t : scene.triangles) {
    const auto place = [&](const Vertex& v) {
      const double per_pixel = v.s / scene.focal;
      return Vec3{(v.x - scene.width / 2.0) * per_pixel, (v.y - scene.height / 2.0) * per_pixel, v.s};
    };
    const Vec3 first = place(t.v[0]);
    Vec3 normal = of_length_1(cross(place(t.v[1]) - first, place(t.v[2]) - first));
    if (dot(normal, first) > 0) normal = normal * -1;
    for (Vertex& v : t.v) set_normal(v, normal);
  }
}

// In the light of a lamp beside the viewer, who stands near enough to have a depth of the picture's size.
// Without fog, whose distances differ there.
Scene in_lamp_light(Scene scene, bool per_pixel) {
  scene.focal = scene.width;
  scene.fog.reset();
  if (per_pixel) light_by_lamp(scene);
  ShadowOptions lamp{.light = lamp_place, .bias = 2, .dark = shadow_dark};
  const std::vector<Face> casters = faces_of(scene);
  return shadowed(std::move(scene), casters, lamp);
}

Scene mesh_frame(const std::string& path, const std::string& texture) {
  const std::optional<std::string> skin = texture.empty() ? std::nullopt : std::optional(texture);
  MeshOptions options;
  options.width = frame_width;
  options.height = frame_height;
  options.background = {96, 112, 128};
  ProjectReport report;
  Scene scene = mesh_scene(read_mesh(path, skin), options, report);
  scene.fog = Fog{options.background, scene.s_max};
  scene.focal = far_viewer;
  return scene;
}

}  // namespace

std::span<const Cloud> clouds() { return all_clouds; }

Scene empty_scene(std::string_view name, int width, int height) {
  Scene s;
  s.name = name;
  s.width = width;
  s.height = height;
  s.s_min = 1;
  s.s_max = 20;
  s.focal = far_viewer;
  s.background = {96, 112, 128};
  s.fog = Fog{s.background, 6};
  s.textures.push_back(make_texture(96, 16));
  return s;
}

CloudStream::CloudStream(std::uint64_t seed, const Scene& scene, double pixels)
    : random_(seed),
      width_(scene.width),
      height_(scene.height),
      s_min_(scene.s_min),
      s_max_(scene.s_max),
      pixels_(pixels) {}

Triangle CloudStream::next() {
  // Three directions that are never nearer than 60 degrees, scaled to the area.
  std::array<double, 3> x{}, y{};
  const double turn = random_.uniform(0, 2 * std::numbers::pi);
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = turn + 2 * std::numbers::pi / 3 * static_cast<double>(i) +
                         random_.uniform(-std::numbers::pi / 6, std::numbers::pi / 6);
    x[i] = std::cos(angle);
    y[i] = std::sin(angle);
  }
  const double area = std::abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])) / 2;
  const double scale = std::sqrt(pixels_ / area);
  const auto [x_low, x_high] = std::ranges::minmax(x);
  const auto [y_low, y_high] = std::ranges::minmax(y);
  const double left = random_.uniform(-x_low * scale, width_ - x_high * scale);
  const double top = random_.uniform(-y_low * scale, height_ - y_high * scale);

  const double middle = random_.log_uniform(s_min_ * 1.5, s_max_ / 1.5);
  const double texture_turn = random_.uniform(0, 2 * std::numbers::pi);
  const double u = random_.uniform(0, texture_size);
  const double v = random_.uniform(0, texture_size);
  Triangle t;
  t.texture = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    Vertex& out = t.v[i];
    out.x = left + scale * x[i];
    out.y = top + scale * y[i];
    out.s = random_.log_uniform(middle / 1.4, middle * 1.4);
    out.u = u + scale * (x[i] * std::cos(texture_turn) - y[i] * std::sin(texture_turn));
    out.v = v + scale * (x[i] * std::sin(texture_turn) + y[i] * std::cos(texture_turn));
    // Codes of 8 bits, which both renderers hold exactly.
    for (std::size_t c = 0; c < 3; ++c) {
      out.c[c] = static_cast<double>(random_.integer(64, 255)) / 255;
    }
  }
  return t;
}

Scene frame_scene(const std::string& name, const std::string& texture) {
  const bool mip = name.ends_with(mip_suffix);
  const bool blend = name.ends_with(blend_suffix);
  const bool phong = name.ends_with(phong_suffix);
  const bool shadow = phong || name.ends_with(shadow_suffix);
  const bool back = name.ends_with(back_suffix) || blend;
  const std::string cloud_name = back || mip || shadow ? name.substr(0, name.rfind('-')) : name;
  for (const Cloud& cloud : all_clouds) {
    if (cloud_name == cloud.name) {
      Scene scene = empty_scene(name, frame_width, frame_height);
      CloudStream stream(1, scene, cloud.pixels);
      for (std::int64_t i = 0; i < cloud.triangles; ++i) {
        scene.triangles.push_back(stream.next());
      }
      if (mip) scene.textures.front() = make_texture(0, 127);
      for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        for (Vertex& v : scene.triangles[i].v) {
          if (mip) std::tie(v.u, v.v) = std::pair(v.u * mip_texels, v.v * mip_texels);
          if (blend) v.c[3] = translucent_alpha(i);
        }
      }
      if (back) {
        const auto distance = [](const Triangle& t) { return t.v[0].s + t.v[1].s + t.v[2].s; };
        std::ranges::stable_sort(scene.triangles, std::greater{}, distance);
      }
      return shadow ? in_lamp_light(std::move(scene), phong) : scene;
    }
  }
  if (name == "demo") {
    Scene scene = demo_scene(frame_width, frame_height);
    scene.focal = far_viewer;
    return scene;
  }
  return mesh_frame(name, texture);
}

}  // namespace bitspan::bench
