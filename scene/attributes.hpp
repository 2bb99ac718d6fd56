// SPDX-License-Identifier: Apache-2.0
// What a vertex carries besides its position, the same in space, in the view volume and on the screen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace bitspan {

enum class AttributeRange : std::uint8_t {
  any,   // every finite number
  unit,  // 0..1
};

// X(name, range, value where it is not given): what a triangle may give per vertex besides u, v and c. In a
// stream `name` is a key of the triangle, with one number per vertex.
#define BITSPAN_GIVEN_ATTRIBUTES(X)                                                                       \
  X(fog, unit, -1)     /* share of the object's own colour [F4]; else it follows from the distance */     \
  X(project_x, any, 0) /* a projector's texture at the vertex: column and row times W [T14]; and */       \
  X(project_y, any, 0)                                                                                    \
  X(project_w, any, 0) /* W, the distance along the projector's axis; where it is not above 0: outside */ \
  X(z, unit, -1)       /* depth of its own, linear on the screen, 0 nearest; else that of s */            \
  X(u2, any, 0)        /* texels of the second texture unit, where it has coordinates of its own */       \
  X(v2, any, 0)                                                                                           \
  X(nx, any, 0) /* outward normal in the viewer's space, of any length up to 2 [L6]: to the right, */     \
  X(ny, any, 0) /* downward and */                                                                        \
  X(nz, any, 0) /* along the view axis; of length 0: only ambient light */                                \
  X(lx, any, 0) /* where the light stands in the field of a map of normals [T15]: column, */              \
  X(ly, any, 0) /* row and */                                                                             \
  X(lz, any, 0) /* height above it, in its texels */

// u, v in texels (texel centres at .5, v downward); c red, green, blue, alpha in 0..1; and what may be given.
struct Attributes {
  double u = 0, v = 0;
  std::array<double, 4> c{1, 1, 1, 1};
#define BITSPAN_ATTRIBUTE(name, range, not_given) double name = not_given;
  BITSPAN_GIVEN_ATTRIBUTES(BITSPAN_ATTRIBUTE)
#undef BITSPAN_ATTRIBUTE
};

struct GivenAttribute {
  std::string_view key;
  AttributeRange range;
  double not_given;
  double Attributes::*member;

  bool is_legal(double value) const {
    return range == AttributeRange::any ? std::isfinite(value) : value >= 0 && value <= 1;
  }
  // Of a triangle.
  bool is_given(const auto& vertices) const {
    return std::ranges::any_of(vertices, [&](const auto& v) { return v.*member != not_given; });
  }
};
inline constexpr auto given_attributes = std::to_array<GivenAttribute>({
#define BITSPAN_ATTRIBUTE(name, range, not_given) \
  {#name, AttributeRange::range, not_given, &Attributes::name},
    BITSPAN_GIVEN_ATTRIBUTES(BITSPAN_ATTRIBUTE)
#undef BITSPAN_ATTRIBUTE
});

// The list of all: calls f(range, number of each of `of`...) once per number that a vertex carries.
template <class F, class... Of>
constexpr void for_each_attribute(F f, Of&... of) {
  f(AttributeRange::any, of.u...);
  f(AttributeRange::any, of.v...);
  for (std::size_t i = 0; i < 4; ++i) f(AttributeRange::unit, of.c[i]...);
  for (const GivenAttribute& given : given_attributes) f(given.range, of.*given.member...);
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

// Returns the attributes within their ranges; what is not given stays so.
constexpr Attributes clamped(const Attributes& a) {
  const Attributes none;
  Attributes out = a;
  for_each_attribute(
      [](AttributeRange range, double& value, double not_given) {
        if (range == AttributeRange::unit && value != not_given) value = std::clamp(value, 0.0, 1.0);
      },
      out, none);
  return out;
}

inline bool is_finite(const Attributes& a) {
  bool finite = true;
  for_each_attribute([&](AttributeRange, double value) { finite = finite && std::isfinite(value); }, a);
  return finite;
}

}  // namespace bitspan
