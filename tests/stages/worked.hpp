// SPDX-License-Identifier: Apache-2.0
// The scene of the worked examples: s from 1 to 2, so that E = 1, s_min' = 1/2, s_max' = 1, and with 16 bits
// B = 65535 and h = 65535 (2 / s - 1): h(2) = 0, h(1.5) = 21845, h(1) = 65535.
#pragma once

#include <array>
#include <random>

#include "model/stages/constants.hpp"
#include "scene/scene.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {

inline Scene worked_scene() {
  Scene s;
  s.name = "worked";
  s.width = 64;
  s.height = 48;
  s.s_min = 1;
  s.s_max = 2;
  s.focal = 50;
  return s;
}

inline Vertex vertex(double x, double y, double s = 2, double u = 0, double v = 0) {
  Vertex out;
  out.x = x;
  out.y = y;
  out.s = s;
  out.u = u;
  out.v = v;
  return out;
}

inline Triangle triangle(const Vertex& a, const Vertex& b, const Vertex& c) { return {{a, b, c}, -1}; }

// A triangle of up to `size` pixels around and over the edges of a w x h viewport, on the 1/16 grid often
// enough for centres to lie on edges.
inline Triangle random_triangle(std::mt19937_64& random, double w, double h, double size) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double x = unit(random) * (w + size) - size / 2;
  const double y = unit(random) * (h + size) - size / 2;
  Triangle t;
  for (Vertex& v : t.v) {
    v.x = x + (unit(random) - 0.5) * size;
    v.y = y + (unit(random) - 0.5) * size;
    if (random() % 2 == 0) {  // to halves of a pixel
      v.x = std::floor(v.x * 2) / 2;
      v.y = std::floor(v.y * 2) / 2;
    }
    v.s = 1 + unit(random);
    v.u = unit(random) * 100;
    v.v = unit(random) * 100;
    v.c = {unit(random), unit(random), unit(random), 1};
  }
  return t;
}

// Whether the centre of pixel (x, y) is inside, by signed areas of the snapped vertices in 1/32 pixel:
// nothing of the walk's arithmetic.
inline bool centre_inside(const Triangle& t, int subpixel_bits, FillRule rule, std::int64_t x,
                          std::int64_t y) {
  const double grid = std::ldexp(1.0, subpixel_bits);
  std::array<std::int64_t, 3> px{};
  std::array<std::int64_t, 3> py{};
  for (std::size_t i = 0; i < 3; ++i) {
    px[i] = 2 * static_cast<std::int64_t>(std::floor(t.v[i].x * grid + 0.5));
    py[i] = 2 * static_cast<std::int64_t>(std::floor(t.v[i].y * grid + 0.5));
  }
  const std::int64_t one = std::int64_t{1} << subpixel_bits;
  const std::int64_t cx = (2 * x + 1) * one;
  const std::int64_t cy = (2 * y + 1) * one;
  const auto area = [&](std::size_t a, std::size_t b, std::int64_t qx, std::int64_t qy) {
    return (px[b] - px[a]) * (qy - py[a]) - (qx - px[a]) * (py[b] - py[a]);
  };
  const std::int64_t whole = area(0, 1, px[2], py[2]);
  if (whole == 0) {
    return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    std::size_t a = i;
    std::size_t b = (i + 1) % 3;
    if (whole < 0) {
      std::swap(a, b);  // so that the inside has positive area
    }
    const std::int64_t part = area(a, b, cx, cy);
    // With y down and the inside at positive area, the triangle runs clockwise on the screen: left edges go
    // up, top edges go right.
    const bool left = py[b] < py[a];
    const bool top = py[b] == py[a] && px[b] > px[a];
    if (part < 0 || (part == 0 && rule == FillRule::top_left && !left && !top)) {
      return false;
    }
  }
  return true;
}

}  // namespace bitspan
