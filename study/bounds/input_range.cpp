// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/input_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "config/modes.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan {
namespace {

using bounds::quantised;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Corner {
  __int128 x, y;  // in 2^-subpixel_bits pixel
  double s;
  std::array<double, 2> uv;
  std::array<double, 3> xyw;  // of the projector
  std::array<double, 3> normal;
  std::size_t place;  // among the input's
};

Interval real(__int128 x) {
  const auto rounded = static_cast<double>(x);  // to nearest
  return static_cast<__int128>(rounded) == x ? Interval(rounded)
                                             : Interval(next_down(rounded), next_up(rounded));
}

// Returns the largest |N| / s^-2 on the line between two corners, on which N and 1/s are linear. The line is
// cut into pieces of equal ratio of 1/s. However it is cut, each piece is bounded by its own ends.
double steepest_on_edge(Interval n_from, Interval n_to, Interval inverse_from, Interval inverse_to) {
  constexpr int pieces = 48;
  const double ratio = inverse_to.lo / inverse_from.lo;
  double most = 0;
  double from = 0;
  for (int i = 1; i <= pieces; ++i) {
    const double share = static_cast<double>(i) / pieces;
    const double grown = std::pow(ratio, share);
    double to = std::fabs(ratio - 1) < 1e-3 ? share : (grown - 1) / (ratio - 1);
    to = i == pieces ? 1 : std::clamp(to, from, 1.0);
    const auto between = [&](Interval a, Interval b, double t) { return a * (Interval(1) - t) + b * t; };
    const Interval n = hull(between(n_from, n_to, from), between(n_from, n_to, to));
    const Interval inverse =
        hull(between(inverse_from, inverse_to, from), between(inverse_from, inverse_to, to));
    most = std::max(most, (Interval(n.mag()) / square(inverse)).hi);
    from = to;
  }
  return most;
}

__int128 floor_ratio(__int128 n, __int128 d) {  // d > 0
  const __int128 q = n / d;
  return q * d > n ? q - 1 : q;
}

// The x of an edge on a row's centre, X = n / d, in units of 2^-(subpixel_bits + 1) pixel.
struct Crossing {
  __int128 n, d;
};
Crossing crossing(const Corner& a, const Corner& b, __int128 y) {
  const __int128 d = b.y - a.y;
  return {2 * a.x * d + (b.x - a.x) * (y - 2 * a.y), d};
}

// Coordinates over a triangle in perspective, by what is linear on the screen.
struct Surface {
  std::array<Interval, 3> inverse{};            // 1/s at the corners
  Interval inverse_x;                           // its change per pixel to the right
  std::vector<std::array<Interval, 3>> n = {};  // per coordinate u: du/dx = N s^2; N is constant along a row
  double least_inverse() const { return std::min({inverse[0].lo, inverse[1].lo, inverse[2].lo}); }
};

// d/dx of w is the sum of w_i (y_i+1 - y_i+2) / area, where the heights sum up to 0.
std::array<Interval, 3> weights_of_gradient(const std::array<Corner, 3>& v, __int128 area, double unit) {
  std::array<Interval, 3> out;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = real(v[(i + 1) % 3].y - v[(i + 2) % 3].y) / (real(area) * unit);
  }
  return out;
}
Interval gradient_of(const std::array<Interval, 3>& values, const std::array<Interval, 3>& weight) {
  return weight[1] * (values[1] - values[0]) + weight[2] * (values[2] - values[0]);
}

// coordinates: each at the corners.
Surface surface_of(const std::array<Interval, 3>& inverse,
                   std::span<const std::array<Interval, 3>> coordinates,
                   const std::array<Interval, 3>& weight) {
  Surface out{inverse, gradient_of(inverse, weight)};
  // N = (u/s)' / s - (u/s) (1/s)'. At corner i it is the sum of w_j (u_j - u_i) / s_j, times 1/s_i.
  for (const std::array<Interval, 3>& u : coordinates) {
    std::array<Interval, 3>& n = out.n.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      Interval sum = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        if (j != i) sum += weight[j] * inverse[j] * (u[j] - u[i]);
      }
      n[i] = sum * inverse[i];
    }
  }
  return out;
}

// Returns the steepest change at any point inside. On a row the steepest point is where 1/s is least. That is
// an end of the row, so it lies on an edge.
double steepest_inside(const Surface& surface, std::size_t k) {
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    most = std::max(
        most, steepest_on_edge(surface.n[k][i], surface.n[k][j], surface.inverse[i], surface.inverse[j]));
  }
  return most;
}

// Fraction bits of a margin that is in units of 2^-(subpixel_bits + 1) pixel.
constexpr int margin_bits = 20;

// A surface, and where its steepest changes on the rows in the picture go to.
struct Measured {
  Surface surface;
  std::vector<double*> gradient;  // per coordinate
};

// Measures the rows with centres that are covered, or would be with the edges `margin` further out, and what
// of them is in the picture. `v` is in the order of the edge walk.
void measure_rows(const Config& config, const std::array<Corner, 3>& v, __int128 area,
                  std::span<const Measured> surfaces, double margin, InputRange& r) {
  const __int128 one = __int128{1} << config.subpixel_bits;  // half a pixel
  const auto out =
      static_cast<__int128>(std::ceil(std::ldexp(margin, config.subpixel_bits + 1 + margin_bits)));
  const bool inclusive = owns_every_edge(config.fill_rule);
  const auto row_at = [&](__int128 y, bool below) {  // the first centre at or below y, the last at or above
    return below ? -floor_ratio(one - 2 * y, 2 * one) : floor_ratio(2 * y - one, 2 * one);
  };
  const __int128 first_row = std::max<__int128>(0, row_at(v[0].y, true));
  const __int128 last_row =
      std::min<__int128>(r.height - 1, inclusive ? row_at(v[2].y, false) : row_at(v[2].y, true) - 1);
  const double unit = std::ldexp(1.0, -config.subpixel_bits - 1);
  r.covers = false;
  r.shortest_row = infinite;
  r.longest_row = 0;
  for (const Measured& m : surfaces) {
    for (double* const gradient : m.gradient) *gradient = 0;
  }
  for (__int128 row = first_row; row <= last_row; ++row) {
    const __int128 y = (2 * row + 1) * one;
    const bool lower = y >= 2 * v[1].y && v[2].y != v[1].y;
    const std::size_t from = lower ? 1 : 0;
    const std::size_t to = lower ? 2 : 1;
    const Crossing long_edge = crossing(v[0], v[2], y);
    const Crossing short_edge = crossing(v[from], v[to], y);
    const Crossing& left = area > 0 ? long_edge : short_edge;
    const Crossing& right = area > 0 ? short_edge : long_edge;
    const __int128 first =
        std::max<__int128>(0, -floor_ratio(((one * left.d - left.n) << margin_bits) + out * left.d,
                                           (2 * one * left.d) << margin_bits));
    const __int128 last_edge = ((right.n - one * right.d) << margin_bits) + out * right.d;
    const __int128 pixel = (2 * one * right.d) << margin_bits;
    const __int128 end = inclusive ? floor_ratio(last_edge, pixel) + 1 : -floor_ratio(-last_edge, pixel);
    if (first >= std::min<__int128>(r.width, end)) continue;
    r.covers = true;
    const Interval length =
        real(right.n * left.d - left.n * right.d) / real(left.d) / real(right.d) * Interval(unit);
    r.shortest_row = std::min(r.shortest_row, std::max(0.0, length.lo));
    r.longest_row = std::max(r.longest_row, length.hi);

    // A pixel in the picture lies on the row or at most one pixel outside, as does the point that it stands
    // for.
    const Interval t = real(y - 2 * v[0].y) / real(2 * (v[2].y - v[0].y));
    const auto at = [&](const std::array<Interval, 3>& w) { return w[0] + (w[2] - w[0]) * t; };
    for (const Measured& m : surfaces) {
      const Surface& surface = m.surface;
      const Interval on_long = at(surface.inverse);
      const Interval to_right =
          area > 0 ? surface.inverse_x * length : -(surface.inverse_x * length);  // from the long edge
      const auto clipped = [&](const Crossing& end_of_row, Interval inverse) {
        const Interval x = real(end_of_row.n) / real(end_of_row.d) * Interval(unit);
        const Interval inside(std::clamp(x.lo, -1.0, r.width + 1.0), std::clamp(x.hi, -1.0, r.width + 1.0));
        return inside == x ? inverse : inverse + surface.inverse_x * (inside - x);
      };
      const Interval inverse = hull(clipped(long_edge, on_long), clipped(short_edge, on_long + to_right));
      // 1/s is nowhere below the least of the corners, whatever the intervals above lose on a sliver.
      const double least = std::max(inverse.lo, surface.least_inverse());
      for (std::size_t k = 0; k < m.gradient.size(); ++k) {
        double& most = *m.gradient[k];
        most = std::max(most, (Interval(at(surface.n[k]).mag()) / square(Interval(least))).hi);
      }
    }
  }
}

// What is known of a triangle's place in the projector's texture, without the gradients of places.
std::optional<ProjectedRange> projected_range(const Projector& projector, const std::array<Corner, 3>& v,
                                              const std::array<Interval, 3>& weight) {
  ProjectedRange out;
  out.s_min = projector.s_min;
  out.s_max = projector.s_max;
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<Interval, 3> over_s;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(v[i].xyw[2] > 0)) return std::nullopt;
      over_s[i] = Interval(v[i].xyw[j]) / v[i].s;
      out.xyw[j] = i == 0 ? Interval(v[i].xyw[j]) : hull(out.xyw[j], v[i].xyw[j]);
      out.over_s[j] = i == 0 ? over_s[i] : hull(out.over_s[j], over_s[i]);
    }
    out.over_s_gradient[j] = gradient_of(over_s, weight).mag();
  }
  return out;
}

// `position_error` gives the error of a dda's edges; it is empty where x is exact.
std::optional<InputRange> triangle_range(const Config& config, const Scene& scene, const Triangle& triangle,
                                         const std::function<double(const InputRange&)>& position_error) {
  const Format snap = config.coordinate_format();
  std::array<Corner, 3> v{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& in = triangle.v[i];
    const auto raw = [&](double x) {
      return static_cast<__int128>(std::ldexp(quantised(x, snap), config.subpixel_bits));
    };
    v[i] = {raw(in.x),
            raw(in.y),
            in.s,
            {in.u, in.v},
            {in.project_x, in.project_y, in.project_w},
            {in.nx, in.ny, in.nz},
            i};
  }
  std::stable_sort(v.begin(), v.end(),
                   [](const Corner& a, const Corner& b) { return a.y < b.y || (a.y == b.y && a.x < b.x); });
  const __int128 area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[2].x - v[0].x) * (v[1].y - v[0].y);
  if (area == 0) return std::nullopt;
  const double unit = std::ldexp(1.0, -config.subpixel_bits);
  const auto pixels = [unit](__int128 x) { return static_cast<double>(x) * unit; };  // 36 bits at most: exact
  InputRange r;
  r.width = scene.width;
  r.height = scene.height;
  r.s_min = scene.s_min;
  r.s_max = scene.s_max;
  const auto range_of = [&v](auto value) {
    Interval out = value(v[0]);
    for (const Corner& corner : v) out = hull(out, value(corner));
    return out;
  };
  r.x = range_of([&](const Corner& c) { return Interval(pixels(c.x)); });
  r.y = range_of([&](const Corner& c) { return Interval(pixels(c.y)); });
  r.s = range_of([](const Corner& c) { return Interval(c.s); });
  r.u = range_of([](const Corner& c) { return Interval(c.uv[0]); });
  r.v = range_of([](const Corner& c) { return Interval(c.uv[1]); });
  r.shortest_edge = infinite;
  for (std::size_t i = 0; i < 3; ++i) {
    const __int128 height = v[(i + 1) % 3].y - v[i].y;
    if (height != 0) r.shortest_edge = std::min(r.shortest_edge, pixels(height < 0 ? -height : height));
  }

  const std::array<Interval, 3> weight = weights_of_gradient(v, area, unit);
  const auto corners = [&v](auto value) {
    return std::array<Interval, 3>{value(v[0]), value(v[1]), value(v[2])};
  };
  const std::array uv{corners([](const Corner& c) { return c.uv[0]; }),
                      corners([](const Corner& c) { return c.uv[1]; })};
  std::vector<Measured> surfaces{
      {surface_of(corners([](const Corner& c) { return Interval(1) / c.s; }), uv, weight),
       {&r.u_gradient, &r.v_gradient}}};
  r.inverse_s_gradient = surfaces.front().surface.inverse_x.mag();
  // The triangle is widest at vertex 1.
  r.longest_row = (real(area < 0 ? -area : area) / real(v[2].y - v[0].y) * unit).hi;
  if (scene.projector && has_project(config.project))
    r.projected = projected_range(*scene.projector, v, weight);
  if (r.projected) {
    // X / W is a u over a surface whose 1/s is W / s.
    const std::array place{corners([](const Corner& c) { return Interval(c.xyw[0]) / c.xyw[2]; }),
                           corners([](const Corner& c) { return Interval(c.xyw[1]) / c.xyw[2]; }),
                           corners([](const Corner& c) { return Interval(1) / c.xyw[2]; })};
    auto& gradient = r.projected->place_gradient;
    for (std::size_t k = 0; k < 3; ++k)
      r.projected->place[k] = hull(hull(place[k][0], place[k][1]), place[k][2]);
    surfaces.push_back(
        {surface_of(corners([](const Corner& c) { return Interval(c.xyw[2]) / c.s; }), place, weight),
         {&gradient[0], &gradient[1], &gradient[2]}});
  }
  if (scene.light && has_light(config.light)) {
    LitTriangle& lit = r.lit.emplace();
    lit.view = lit_view(scene);
    for (std::size_t i = 0; i < 3; ++i) {
      lit.v[i] = {pixels(v[i].x), pixels(v[i].y), v[i].s, v[i].normal};
      if (v[i].place == 0) lit.first = i;
    }
    lit.weight = weight;
  }
  for (const Measured& m : surfaces) {
    for (std::size_t k = 0; k < m.gradient.size(); ++k) *m.gradient[k] = steepest_inside(m.surface, k);
  }
  const double margin = position_error ? position_error(r) : 0;
  // With a margin beyond half a pixel, what is outside the picture could count too.
  if (margin <= 0.5) measure_rows(config, v, area, surfaces, margin, r);
  return r;
}

}  // namespace

bounds::LitView lit_view(const View& view) {
  return {*view.light, view.width, view.height, view.focal, view.s_max};
}

std::vector<std::optional<InputRange>> ranges_of_triangles(const Config& config, const Scene& scene) {
  std::vector<std::optional<InputRange>> out;
  std::function<double(const InputRange&)> position_error;
  if (has_x_step(config)) position_error = edge_position_error(config);
  for (const Triangle& triangle : scene.triangles) {
    out.push_back(triangle_range(config, scene, triangle, position_error));
  }
  return out;
}

std::vector<InputRange> triangle_ranges(const Config& config, const Scene& scene) {
  std::vector<InputRange> out;
  for (const auto& range : ranges_of_triangles(config, scene)) {
    if (range) out.push_back(*range);
  }
  return out;
}

InputRange input_range(const Config& config, const Scene& scene) {
  const std::vector<InputRange> triangles = triangle_ranges(config, scene);
  if (triangles.empty()) {
    InputRange none;
    none.width = scene.width;
    none.height = scene.height;
    none.s_min = scene.s_min;
    none.s_max = scene.s_max;
    none.s = {scene.s_min, scene.s_max};
    none.x = {0, static_cast<double>(scene.width)};
    none.y = {0, static_cast<double>(scene.height)};
    return none;
  }
  InputRange all = triangles.front();
  for (const InputRange& r : triangles) {
    all.s = hull(all.s, r.s);
    all.x = hull(all.x, r.x);
    all.y = hull(all.y, r.y);
    all.u = hull(all.u, r.u);
    all.v = hull(all.v, r.v);
    all.shortest_edge = std::min(all.shortest_edge, r.shortest_edge);
    all.shortest_row = std::min(all.shortest_row, r.shortest_row);
    all.longest_row = std::max(all.longest_row, r.longest_row);
    all.covers = all.covers || r.covers;
    all.inverse_s_gradient = std::max(all.inverse_s_gradient, r.inverse_s_gradient);
    all.u_gradient = std::max(all.u_gradient, r.u_gradient);
    all.v_gradient = std::max(all.v_gradient, r.v_gradient);
    if (triangles.size() > 1) all.lit.reset();
    if (!all.projected || !r.projected) {
      all.projected.reset();
      continue;
    }
    const auto& own = *r.projected;
    auto& to = *all.projected;
    for (std::size_t j = 0; j < 3; ++j) {
      to.xyw[j] = hull(to.xyw[j], own.xyw[j]);
      to.over_s[j] = hull(to.over_s[j], own.over_s[j]);
      to.over_s_gradient[j] = std::max(to.over_s_gradient[j], own.over_s_gradient[j]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      to.place[k] = hull(to.place[k], own.place[k]);
      to.place_gradient[k] = std::max(to.place_gradient[k], own.place_gradient[k]);
    }
  }
  return all;
}

}  // namespace bitspan
