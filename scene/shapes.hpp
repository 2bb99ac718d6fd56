// SPDX-License-Identifier: Apache-2.0
// What the scenes that need no file are made of.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "scene/transform.hpp"

namespace bitspan {

using Rgba = std::array<std::uint8_t, 4>;
Texture painted(std::string name, int width, int height, const std::function<Rgba(int, int)>& texel);
// Repeatable, and different from texel to texel.
std::uint32_t texel_hash(int i, int j);

// Rounds to 2^-16 of a unit, so that the last bits of a mathematical library do not show.
double on_grid(double x);
Vec3 on_grid(const Vec3& p);

// q: counterclockwise seen from outside.
void add_quad(std::vector<Face>& faces, const std::array<Corner, 4>& q, int texture);
// The sides of a box that stands on the floor, turned about its upright axis, and its top behind them. Each
// begins at the bottom left, and is counterclockwise seen from outside.
std::array<std::array<Vec3, 4>, 5> box_sides(const Vec3& foot, double half_x, double half_z, double height,
                                             double turn);
// A surface of columns times rows quads between corners; halves without an area, as at the poles of a ball,
// are left out.
void add_surface(std::vector<Face>& faces, int columns, int rows, int texture,
                 const std::function<Corner(int column, int row)>& corner);

// A scene without triangles: the picture, and the range of s and the sky of the demo. width and height: 1 to
// 16384, and the width at most 2.4 times the height. Throws InputError for others.
Scene empty_scene(const char* name, int width, int height);

}  // namespace bitspan
