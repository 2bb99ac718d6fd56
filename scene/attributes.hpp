// SPDX-License-Identifier: Apache-2.0
// What a vertex carries besides its position, the same in space, in the view volume and on the screen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace bitspan {

// u, v in texels (texel centres at .5, v downward); c red, green, blue, alpha in 0..1.
struct Attributes {
  double u = 0, v = 0;
  std::array<double, 4> c{1, 1, 1, 1};
};

enum class AttributeRange {
  any,   // every finite number
  unit,  // 0..1
};

// The list of the attributes: calls f(range, number of each of `of`...) once per number that a vertex
// carries.
template <class F, class... Of>
constexpr void for_each_attribute(F f, Of&... of) {
  f(AttributeRange::any, of.u...);
  f(AttributeRange::any, of.v...);
  for (std::size_t i = 0; i < 4; ++i) f(AttributeRange::unit, of.c[i]...);
}

static_assert(
    [] {
      Attributes a;
      std::size_t numbers = 0;
      for_each_attribute([&](AttributeRange, double) { ++numbers; }, a);
      return numbers * sizeof(double) == sizeof a;
    }(),
    "for_each_attribute leaves an attribute out");

constexpr double mix(double a, double b, double t) { return a + (b - a) * t; }

// Returns the attributes at t on the way from a (0) to b (1). They are linear in space, so t is one in space.
constexpr Attributes mix(const Attributes& a, const Attributes& b, double t) {
  Attributes out;
  for_each_attribute([t](AttributeRange, double& to, double from, double end) { to = mix(from, end, t); },
                     out, a, b);
  return out;
}

// Returns the attributes within their ranges.
constexpr Attributes clamped(const Attributes& a) {
  Attributes out = a;
  for_each_attribute(
      [](AttributeRange range, double& value) {
        if (range == AttributeRange::unit) value = std::clamp(value, 0.0, 1.0);
      },
      out);
  return out;
}

inline bool is_finite(const Attributes& a) {
  bool finite = true;
  for_each_attribute([&](AttributeRange, double value) { finite = finite && std::isfinite(value); }, a);
  return finite;
}

}  // namespace bitspan
