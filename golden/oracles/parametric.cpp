// SPDX-License-Identifier: Apache-2.0
// Triangles filled by two parameters in object space: the points C + (B - C) i / (n - 1) + (A - C) j / (n -
// 1) with i + j < n are projected one by one, and a triangle fills the pixels in which they lie. A pixel of
// its own that no point hits is a gap. [O1]
//
// The source takes for n the most pixels that two vertices are apart, and finds that no gap is left. There
// are gaps: n points leave n - 1 steps for n + 1 pixels, and at the near end of a triangle the projection
// stretches its steps.
//
// (n + 1) s_max / s_min + 2 points leave none. At a point f of the picture two neighbours of N points are
// (s_b (b - f) - s_c (c - f)) / (s (N - 1)) apart, which is at most n s_max / (s_min (N - 1)) in x and in y:
// less than a pixel. So a covered centre lies in a small triangle that is less than a pixel wide and high.
// Were each of its corners half a pixel or more from the centre in x or in y, no two could lie on opposite
// sides: all would lie beyond two neighbouring sides of the pixel, and the centre would not be between them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "golden/oracle.hpp"

namespace bitspan {

namespace {

// Points along a side of a triangle.
using PointCount = std::int64_t (*)(const IdealTriangle& t);

template <class F>
std::int64_t most_apart(const IdealTriangle& t, F pixels) {
  std::int64_t most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const IdealTriangle::Corner& a = t.v[i];
    const IdealTriangle::Corner& b = t.v[(i + 1) % 3];
    most = std::max({most, pixels(a.x, b.x), pixels(a.y, b.y)});
  }
  return most;
}

// As in the source: from pixel to pixel.
std::int64_t count_of_source(const IdealTriangle& t) {
  return most_apart(t, [&](std::int64_t a, std::int64_t b) {
    return std::abs((a >> t.subpixel_bits) - (b >> t.subpixel_bits));
  });
}

// Saturates where no picture could be made of them.
std::int64_t safe_count(const IdealTriangle& t) {
  const std::int64_t pixel = std::int64_t{1} << t.subpixel_bits;
  const std::int64_t n =
      most_apart(t, [&](std::int64_t a, std::int64_t b) { return (std::abs(a - b) + pixel - 1) / pixel; });
  const auto [near, far] = std::minmax({t.v[0].s, t.v[1].s, t.v[2].s});
  const long double count = std::ceil(static_cast<long double>(n + 1) * (far / near)) + 2;
  return static_cast<std::int64_t>(std::min(count, 0x1p30L));
}

struct Filled {
  std::vector<Visible> picture;
  std::uint64_t gaps = 0;    // centres that a triangle covers, and no point of it lies in their pixel
  std::uint64_t points = 0;  // in the picture
  std::uint64_t pixels = 0;  // in which they lie, each triangle for itself
};

// Calls f(x, y) for the pixel of each point; those outside of the picture too. The vertices' places are exact
// in a double, and a point is off by far less than the gap of 1 / (2 n + 2) pixel that the safe count leaves.
template <class F>
void for_each_point(const IdealTriangle& t, std::int64_t count, F f) {
  struct Space {
    double x, y, z;
  };
  std::array<Space, 3> v{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto s = static_cast<double>(t.v[i].s / t.v[2].s);
    const auto pixels = [&](std::int64_t a) { return std::ldexp(static_cast<double>(a), -t.subpixel_bits); };
    v[i] = {s * pixels(t.v[i].x), s * pixels(t.v[i].y), s};
  }
  const double parts = static_cast<double>(std::max<std::int64_t>(count - 1, 1));
  const auto step = [&](std::size_t to) {
    return Space{(v[to].x - v[2].x) / parts, (v[to].y - v[2].y) / parts, (v[to].z - v[2].z) / parts};
  };
  const Space along_a = step(0);
  const Space along_b = step(1);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<double>(i);
    Space at{v[2].x + k * along_b.x, v[2].y + k * along_b.y, v[2].z + k * along_b.z};
    for (std::int64_t j = 0; i + j < count; ++j) {
      f(static_cast<std::int64_t>(std::floor(at.x / at.z)),
        static_cast<std::int64_t>(std::floor(at.y / at.z)));
      at = {at.x + along_a.x, at.y + along_a.y, at.z + along_a.z};
    }
  }
}

Filled filled(const OracleInput& input, PointCount count) {
  const Scene& scene = input.scene;
  Filled out;
  out.picture.resize(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  std::vector<const OracleFace*> last(out.picture.size());  // that has a point in the pixel
  for (const OracleFace& face : input.faces) {
    for_each_point(face.shape, count(face.shape), [&](std::int64_t x, std::int64_t y) {
      if (x < 0 || x >= scene.width || y < 0 || y >= scene.height) return;
      ++out.points;
      const OracleFace*& here = last[static_cast<std::size_t>(y * scene.width + x)];
      if (here != &face) ++out.pixels;
      here = &face;
    });
    golden::for_each_covered(face.shape, input.config.fill_rule, scene.width, scene.height,
                             [&](const golden::Areas& areas, std::int64_t x, std::int64_t y) {
                               const auto at = static_cast<std::size_t>(y * scene.width + x);
                               if (last[at] != &face) {
                                 ++out.gaps;
                                 return;
                               }
                               Visible& seen = out.picture[at];
                               const Visible here{face.index, golden::inverse_distance(face.shape, areas)};
                               if (seen.triangle < 0 || here.q > seen.q) seen = here;
                             });
  }
  return out;
}

template <PointCount count>
std::vector<Visible> picture(const OracleInput& input) {
  Filled f = filled(input, count);
  if (input.counts != nullptr) {
    *input.counts = {{"gaps", static_cast<double>(f.gaps)},
                     {"points per pixel", static_cast<double>(f.points) /
                                              static_cast<double>(std::max<std::uint64_t>(1, f.pixels))}};
  }
  return std::move(f.picture);
}

constexpr double point_limit = 3e8;  // some seconds

template <PointCount count>
std::string refuses(const Config& config, const Scene& scene) {
  double points = 0;
  for (const Triangle& triangle : scene.triangles) {
    const auto shape = ideal_triangle(config, triangle);
    if (!shape) continue;
    const auto n = static_cast<double>(count(*shape));
    points += n * (n + 1) / 2;
  }
  if (points <= point_limit) return "";
  return fmt::format("its triangles need {:.2g} points, and it takes no more than {:.2g}", points,
                     point_limit);
}

const RegisterOracle safe{{.name = "parametric",
                           .meaning = "triangles filled by parameters in object space, without a gap",
                           .refuses = refuses<safe_count>,
                           .visible = picture<safe_count>}};
const RegisterOracle source{
    {.name = "parametric_source",
     .meaning = "the same with the source's number of points; counts its gaps and wrong pixels",
     .is_truth = false,
     .refuses = refuses<count_of_source>,
     .visible = picture<count_of_source>}};

}  // namespace

}  // namespace bitspan

extern "C" void parametric_oracle() {}
