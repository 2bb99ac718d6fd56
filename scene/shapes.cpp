// SPDX-License-Identifier: Apache-2.0
#include "scene/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/config.hpp"
#include "scene/geometry.hpp"

namespace bitspan {

Texture painted(std::string name, int width, int height, const std::function<Rgba(int, int)>& texel) {
  Texture texture{std::move(name), width, height, {}};
  texture.rgba.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const Rgba value = texel(i, j);
      texture.rgba.insert(texture.rgba.end(), value.begin(), value.end());
    }
  }
  return texture;
}

std::uint32_t texel_hash(int i, int j) {
  auto h = static_cast<std::uint32_t>(i) * 0x9e3779b1U ^ static_cast<std::uint32_t>(j) * 0x85ebca77U;
  h ^= h >> 15;
  h *= 0x2c1b3c6dU;
  h ^= h >> 13;
  return h;
}

double on_grid(double x) { return std::round(x * 65536) / 65536; }
Vec3 on_grid(const Vec3& p) { return {on_grid(p.x), on_grid(p.y), on_grid(p.z)}; }

void add_quad(std::vector<Face>& faces, const std::array<Corner, 4>& q, int texture) {
  faces.push_back({{q[0], q[1], q[2]}, texture, false});
  faces.push_back({{q[0], q[2], q[3]}, texture, false});
}

std::array<std::array<Vec3, 4>, 5> box_sides(const Vec3& foot, double half_x, double half_z, double height,
                                             double turn) {
  const double c = std::cos(turn), s = std::sin(turn);
  const auto at = [&](double x, double y, double z) { return foot + Vec3{c * x + s * z, y, c * z - s * x}; };
  constexpr std::array<std::array<double, 2>, 4> ring{{{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}};
  std::array<std::array<Vec3, 4>, 5> out;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& a = ring[i];
    const auto& b = ring[(i + 1) % 4];
    out[i] = {at(a[0] * half_x, 0, a[1] * half_z), at(b[0] * half_x, 0, b[1] * half_z),
              at(b[0] * half_x, height, b[1] * half_z), at(a[0] * half_x, height, a[1] * half_z)};
    out[4][i] = at(a[0] * half_x, height, a[1] * half_z);
  }
  return out;
}

void add_surface(std::vector<Face>& faces, int columns, int rows, int texture,
                 const std::function<Corner(int column, int row)>& corner) {
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Corner p0 = corner(i, j), p1 = corner(i + 1, j), p2 = corner(i + 1, j + 1), p3 = corner(i, j + 1);
      if (p0.position != p1.position) faces.push_back({{p0, p1, p2}, texture, false});
      if (p2.position != p3.position) faces.push_back({{p0, p2, p3}, texture, false});
    }
  }
}

Scene empty_scene(const char* name, int width, int height) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384 || width > 2.4 * height) {
    throw InputError("size: " + std::to_string(width) + "x" + std::to_string(height) +
                     " is not legal for the " + name +
                     "; expected 1..16384 pixels, width at most 2.4 times height");
  }
  Scene scene;
  scene.name = name;
  scene.width = width;
  scene.height = height;
  scene.s_min = 1;
  scene.s_max = 1000;
  scene.focal = std::max(0.95 * height, 0.65 * width);
  scene.background = {176, 196, 214};
  return scene;
}

}  // namespace bitspan
