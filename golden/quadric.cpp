// SPDX-License-Identifier: Apache-2.0
#include "golden/quadric.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "golden/surface.hpp"

namespace bitspan::golden {
namespace {

Approx as_it_is(double x) { return {x, 0}; }

// An affine function along a ray: slope t + constant.
struct LinearAlong {
  Approx slope;
  double constant;
  Approx at(double t) const { return slope * as_it_is(t) + as_it_is(constant); }
};
LinearAlong linear_along(const LinearForm& form, const QuadricRay& ray) {
  return {as_it_is(form[0]) * as_it_is(ray.x) + as_it_is(form[1]) * as_it_is(ray.y) +
              as_it_is(form[2]) * as_it_is(ray.z),
          form[3]};
}

double low_of(const Approx& a) { return a.value - a.error; }
double high_of(const Approx& a) { return a.value + a.error; }
Interval hull(const Approx& a, const Approx& b) {
  return {std::min(low_of(a), low_of(b)), std::max(high_of(a), high_of(b))};
}

// A stretch of a ray along which f only grows (1), only falls (-1), or has its extreme (0).
struct Stretch {
  Interval t;
  int slope = 0;
};
// The window in stretches, from near to far.
std::vector<Stretch> stretches(const QuadricAlong& f, const Interval& window) {
  const auto slope = [&](double t) { return sign_of(f.a * as_it_is(t) + f.b); };
  const std::optional<int> first = slope(window.low);
  const std::optional<int> last = slope(window.high);
  if (first && last && *first == *last) return {{window, *first}};
  const double extreme = -f.b.value / f.a.value;
  if (!first || !last || !std::isfinite(extreme)) return {{window, 0}};
  for (double share = 0x1p-46; share < 1; share *= 16) {
    const Interval middle{std::max(window.low, extreme * (1 - share)),
                          std::min(window.high, extreme * (1 + share))};
    if (middle.low < middle.high && slope(middle.low) == first && slope(middle.high) == last) {
      return {{{window.low, middle.low}, *first}, {middle, 0}, {{middle.high, window.high}, *last}};
    }
  }
  return {{window, 0}};
}

// Where f is `level` in a stretch, at whose ends f is certainly on two sides of it. `low` and `high` of what
// is returned are so, too.
Interval enclosed(const QuadricAlong& f, const Stretch& s, double level) {
  const auto side = [&](double t) { return sign_of(f.at(t) - as_it_is(level)); };
  // The formula that does not cancel; it only guesses.
  const double c = f.c.value - level;
  const double root = std::sqrt(std::max(0.0, f.b.value * f.b.value - f.a.value * c));
  const double sum = -(f.b.value + std::copysign(root, f.b.value));
  std::array<double, 2> guesses{sum / f.a.value, c / sum};
  Interval out = s.t;
  for (const double guess : guesses) {
    if (!(guess >= s.t.low && guess <= s.t.high)) continue;
    for (double share = 0x1p-50; share < 0.5; share *= 4) {
      const double below = std::max(s.t.low, guess * (1 - share));
      const double above = std::min(s.t.high, guess * (1 + share));
      const bool is_above_low = below == s.t.low || side(below) == -s.slope;
      const bool is_below_high = above == s.t.high || side(above) == s.slope;
      if (!is_above_low || !is_below_high) continue;
      if (above - below < out.high - out.low) out = {below, above};
      break;
    }
  }
  return out;
}

// x 2^-lowest, for x that is a multiple of 2^lowest.
Integer whole_of(double x, int lowest) {
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  if (mantissa == 0) return 0;
  return Integer(mantissa) << static_cast<unsigned>(exponent - 53 - lowest);
}
template <std::size_t N>
std::array<Integer, N> wholes(const std::array<double, N>& numbers) {
  int lowest = std::numeric_limits<int>::max();
  for (const double x : numbers) {
    int exponent = 0;
    if (x == 0) continue;
    std::frexp(x, &exponent);
    lowest = std::min(lowest, exponent - 53);
  }
  std::array<Integer, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = whole_of(numbers[i], lowest);
  return out;
}

// x, y and the distance in the viewer's space.
using Place = std::array<double, 3>;
double scalar_product(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Place absolute(const Place& a) { return {std::fabs(a[0]), std::fabs(a[1]), std::fabs(a[2])}; }

using Matrix10 = std::array<double, 10>;
Matrix10 absolute(Matrix10 m) {
  for (double& x : m) x = std::fabs(x);
  return m;
}
// M (p 1) without its last row: half of the gradient.
Place half_gradient(const Matrix10& m, const Place& p) {
  const auto& [x, y, z] = p;
  return {m[0] * x + m[1] * y + m[2] * z + m[3], m[1] * x + m[4] * y + m[5] * z + m[6],
          m[2] * x + m[5] * y + m[7] * z + m[8]};
}

// How far a vertex of a tessellation may be from where it was meant, each way.
struct Moved {
  Place at, by;
};

// Doubles that have been through a projection, in shares of the number and in pixels.
constexpr double rounded_share = 0x1p-45, rounded_pixels = 0x1p-32;

Moved moved(const Vertex& v, const IdealTriangle::Corner& snapped, int subpixel_bits, const View& view) {
  const double per_pixel = v.s / view.focal;
  const auto off = [&](std::int64_t code, double given) {
    return (std::fabs(std::ldexp(static_cast<double>(code), -subpixel_bits) - given) + rounded_pixels) *
           per_pixel;
  };
  Moved out{{(v.x - view.width / 2.0) * per_pixel, (v.y - view.height / 2.0) * per_pixel, v.s},
            {off(snapped.x, v.x), off(snapped.y, v.y), 0}};
  for (std::size_t i = 0; i < 3; ++i) out.by[i] += rounded_share * std::fabs(out.at[i]);
  return out;
}

// By how much (p 1) M (q 1) may change where both points move.
double change(const Matrix10& m, const Moved& p, const Moved& q) {
  const Matrix10 all = absolute(m);
  Matrix10 square = all;
  square[3] = square[6] = square[8] = 0;
  const Place from_q = absolute(q.at);
  const double terms = scalar_product(absolute(p.at), half_gradient(all, from_q)) +
                       scalar_product({all[3], all[6], all[8]}, from_q) + all[9];
  return scalar_product(absolute(half_gradient(m, p.at)), q.by) +
         scalar_product(absolute(half_gradient(m, q.at)), p.by) +
         scalar_product(half_gradient(square, p.by), q.by) + rounded_share * terms;
}

// How much of an interval of t lies between the planes.
enum class Between { whole, part, none };
Between between(const std::optional<QuadricClip>& clip, const QuadricRay& ray, const Interval& t,
                double reach) {
  if (!clip) return Between::whole;
  const LinearAlong axis = linear_along(clip->axis, ray);
  const Interval height = hull(axis.at(t.low), axis.at(t.high));
  if (height.high < clip->from - reach || height.low > clip->to + reach) return Between::none;
  if (height.low >= clip->from + reach && height.high <= clip->to - reach) return Between::whole;
  return Between::part;
}

// A cap, as a plane that the ray meets.
struct CapAlong {
  Interval t;
  bool enters = false;
};
// Where the ray may be as high as the cap, or `reach` beside it; none where it is nowhere in the window, or
// goes along with the plane.
std::optional<CapAlong> meet_cap(const QuadricClip& clip, bool is_upper, double reach, const QuadricRay& ray,
                                 const Interval& window) {
  const LinearAlong axis = linear_along(clip.axis, ray);
  const std::optional<int> slope = sign_of(axis.slope);
  if (!slope || *slope == 0) return std::nullopt;
  const double level = is_upper ? clip.to : clip.from;
  const auto at = [&](double height) {
    const Approx rise = as_it_is(height) - as_it_is(axis.constant);
    const double t = rise.value / axis.slope.value;
    const double slope_least = std::fabs(axis.slope.value) - axis.slope.error;
    const double error =
        (rise.error + std::fabs(t) * axis.slope.error) / slope_least + 0x1p-50 * std::fabs(t);
    return Interval{t - error, t + error};
  };
  const Interval below = at(level - reach);
  const Interval above = at(level + reach);
  CapAlong out{{std::min(below.low, above.low), std::max(below.high, above.high)}, (*slope < 0) == is_upper};
  if (out.t.high < window.low || out.t.low > window.high) return std::nullopt;
  return out;
}

bool has_cap(const QuadricClip& clip, bool is_upper) { return is_upper ? clip.cap_to : clip.cap_from; }

}  // namespace

QuadricRay ray_through(const View& view, std::int64_t x, std::int64_t y) {
  return {static_cast<double>(2 * x + 1 - view.width), static_cast<double>(2 * y + 1 - view.height),
          2 * view.focal};
}

Approx QuadricAlong::at(double t) const {
  const Approx at = as_it_is(t);
  return (a * at + b + b) * at + c;
}

// The three control values of the parabola hold all of it.
Interval QuadricAlong::range(const Interval& t) const {
  const Approx low = as_it_is(t.low);
  const Approx high = as_it_is(t.high);
  const Approx middle = (a * low + b) * high + b * low + c;
  const Interval ends = hull(at(t.low), at(t.high));
  return {std::min(ends.low, low_of(middle)), std::max(ends.high, high_of(middle))};
}

QuadricAlong along(const Quadric& quadric, const QuadricRay& ray) {
  std::array<Approx, 10> m;
  std::ranges::transform(quadric.matrix, m.begin(), as_it_is);
  const Approx x = as_it_is(ray.x);
  const Approx y = as_it_is(ray.y);
  const Approx z = as_it_is(ray.z);
  const Approx mixed = x * (m[1] * y + m[2] * z) + m[5] * y * z;
  return {m[0] * x * x + m[4] * y * y + m[7] * z * z + mixed + mixed, m[3] * x + m[6] * y + m[8] * z, m[9]};
}

bool is_always_above(const Quadric& quadric, const QuadricRay& ray, double level) {
  // Beside each sum the sum of its absolute terms, of which each rounding loses 2^-53 at most.
  struct Sum {
    double value = 0, terms = 0;
    void add(double x) {
      value += x;
      terms += std::fabs(x);
    }
  };
  const auto& m = quadric.matrix;
  const auto& [x, y, z] = ray;
  Sum a;
  for (const double term : {m[0] * x * x, m[4] * y * y, m[7] * z * z, 2 * (m[1] * x * y), 2 * (m[2] * x * z),
                            2 * (m[5] * y * z)}) {
    a.add(term);
  }
  Sum b;
  for (const double term : {m[3] * x, m[6] * y, m[8] * z}) b.add(term);
  constexpr double lost = 0x1p-45;
  const double c = m[9] - level;
  const double reach = b.terms * b.terms + a.terms * (std::fabs(m[9]) + std::fabs(level));
  return a.value > lost * a.terms && b.value * b.value - a.value * c < -lost * reach;
}

namespace {

int discriminant_sign_of(const QuadricAlong& f, const Quadric& quadric, const QuadricRay& ray) {
  if (const auto sign = sign_of(f.b * f.b - f.a * f.c)) return *sign;
  const std::array<Integer, 10> m = wholes(quadric.matrix);
  const auto [x, y, z] = wholes(std::array{ray.x, ray.y, ray.z});
  const Integer mixed = x * (m[1] * y + m[2] * z) + m[5] * y * z;
  const Integer a = m[0] * x * x + m[4] * y * y + m[7] * z * z + 2 * mixed;
  const Integer b = m[3] * x + m[6] * y + m[8] * z;
  return Integer(b * b - a * m[9]).sign();
}

std::vector<QuadricRoot> roots_along(const QuadricAlong& f, const Interval& window) {
  std::vector<QuadricRoot> out;
  const auto side = [&](double t) { return sign_of(f.at(t)); };
  const std::vector<Stretch> parts = stretches(f, window);
  const auto is_crossed = [&](const Stretch& s) {
    const std::optional<int> first = side(s.t.low);
    const std::optional<int> last = side(s.t.high);
    return s.slope != 0 && first && last && *first * *last < 0;
  };
  for (const Stretch& s : parts) {
    if (is_crossed(s)) out.push_back({enclosed(f, s, 0), s.slope < 0});
    if (s.slope != 0) continue;
    // A root that no stretch beside the extreme has lies so near to it that the error leaves signs open.
    const std::optional<int> outside = sign_of(f.a);
    if (!outside) continue;
    const auto beyond = [&](double sign, double from, double end) {
      for (double share = 0x1p-46; share < 1; share *= 4) {
        const double t = from * (1 + sign * share);
        if (sign * (end - t) <= 0) break;
        if (side(t) == outside) return t;
      }
      return end;
    };
    if (out.empty() && side(window.low) == outside) {
      out.push_back({{beyond(-1, s.t.low, window.low), s.t.high}, *outside > 0});
    }
    if (!is_crossed(parts.back()) && side(window.high) == outside) {
      out.push_back({{s.t.low, beyond(1, s.t.high, window.high)}, *outside < 0});
    }
  }
  return out;
}

}  // namespace

int discriminant_sign(const Quadric& quadric, const QuadricRay& ray) {
  return discriminant_sign_of(along(quadric, ray), quadric, ray);
}

std::vector<QuadricRoot> roots_of(const Quadric& quadric, const QuadricRay& ray, const Interval& window) {
  const QuadricAlong f = along(quadric, ray);
  if (discriminant_sign_of(f, quadric, ray) < 0) return {};
  return roots_along(f, window);
}

QuadricShell shell_of(const Config& config, const Scene& scene, const Quadric& quadric) {
  QuadricShell out{.quadric = quadric, .low = quadric.low, .high = quadric.high};
  double more = 0;
  for (std::size_t i = 0; i < quadric.count; ++i) {
    const Triangle& triangle = scene.triangles[quadric.first + i];
    const auto shape = ideal_triangle(config, triangle);
    if (!shape) continue;
    std::array<Moved, 3> corner;
    for (const IdealTriangle::Corner& c : shape->v) {
      const auto place = static_cast<std::size_t>(c.place);
      corner[place] = moved(triangle.v[place], c, shape->subpixel_bits, scene);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b) more = std::max(more, change(quadric.matrix, corner[a], corner[b]));
      if (!quadric.clip) continue;
      const LinearForm& g = quadric.clip->axis;
      const Place axis = absolute(Place{g[0], g[1], g[2]});
      out.reach = std::max(
          out.reach, scalar_product(axis, corner[a].by) +
                         rounded_share * (scalar_product(axis, absolute(corner[a].at)) + std::fabs(g[3])));
    }
  }
  out.low -= more;
  out.high += more;
  return out;
}

std::vector<QuadricCrossing> crossings_of(const QuadricShell& shell, const QuadricRay& ray,
                                          const Interval& window) {
  const Quadric& q = shell.quadric;
  const QuadricAlong f = along(q, ray);
  std::vector<QuadricCrossing> out;
  const auto is_above = [&](double t) { return low_of(f.at(t)) > shell.high; };
  const auto is_below = [&](double t) { return high_of(f.at(t)) < shell.low; };
  for (const Stretch& s : stretches(f, window)) {
    const Interval values = f.range(s.t);
    if (values.high < shell.low || values.low > shell.high) continue;
    QuadricCrossing here{s.t, false};
    if (s.slope != 0) {
      const bool falls = s.slope < 0;
      const bool begins = falls ? is_above(s.t.low) : is_below(s.t.low);
      const bool ends = falls ? is_below(s.t.high) : is_above(s.t.high);
      if (falls ? is_below(s.t.low) || is_above(s.t.high) : is_above(s.t.low) || is_below(s.t.high)) continue;
      if (begins) here.t.low = enclosed(f, s, falls ? shell.high : shell.low).low;
      if (ends) here.t.high = enclosed(f, s, falls ? shell.low : shell.high).high;
      here.is_certain = begins && ends && (falls || q.two_sided);
    }
    // A shell that the ray does not go through goes on in the next stretch.
    if (!out.empty() && !out.back().is_certain && !here.is_certain && out.back().t.high >= here.t.low) {
      out.back().t.high = here.t.high;
    } else {
      out.push_back(here);
    }
  }
  std::erase_if(out, [&](QuadricCrossing& crossing) {
    const Between part = between(q.clip, ray, crossing.t, shell.reach);
    if (part == Between::part) crossing.is_certain = false;
    return part == Between::none;
  });
  if (!q.clip) return out;
  for (const bool is_upper : {false, true}) {
    if (!has_cap(*q.clip, is_upper)) continue;
    const auto cap = meet_cap(*q.clip, is_upper, shell.reach, ray, window);
    if (!cap) continue;
    const Interval values = f.range(cap->t);
    if (values.low > shell.high) continue;
    const bool is_inside = cap->t.low >= window.low && cap->t.high <= window.high;
    out.push_back({cap->t, is_inside && values.high < shell.low && (cap->enters || q.two_sided)});
  }
  return out;
}

std::optional<QuadricHit> first_hit(const Quadric& q, const QuadricRay& ray, const Interval& window) {
  const QuadricAlong f = along(q, ray);
  std::optional<QuadricHit> out;
  const auto add = [&](const QuadricHit& hit) {
    if (!out || hit.t.high < out->t.high) out = hit;
  };
  std::vector<QuadricRoot> roots;
  if (discriminant_sign_of(f, q, ray) >= 0) roots = roots_along(f, window);
  for (const QuadricRoot& root : roots) {
    if (!root.enters && !q.two_sided) continue;
    const Between part = between(q.clip, ray, root.t, 0);
    if (part != Between::none) add({root.t, part == Between::part});
  }
  if (!q.clip) return out;
  for (const bool is_upper : {false, true}) {
    if (!has_cap(*q.clip, is_upper)) continue;
    const auto cap = meet_cap(*q.clip, is_upper, 0, ray, window);
    if (!cap || !(cap->enters || q.two_sided)) continue;
    const Interval values = f.range(cap->t);
    if (values.low <= 0) add({cap->t, values.high > 0});
  }
  return out;
}

}  // namespace bitspan::golden
