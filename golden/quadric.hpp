// SPDX-License-Identifier: Apache-2.0
// Rays from the eye against quadrics. Every sign is certified: by an error bound, and by whole numbers where
// a ray is so nearly a tangent that the bound leaves the sign open. [V2]
//
// A tessellation is not its quadric. It lies in a shell around it, the points where f is in low..high. Where
// a ray goes through the whole shell, it meets the tessellation for certain.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "golden/exact.hpp"
#include "scene/quadric.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Its points are t (x, y, z) in the viewer's space, t > 0. Each of the three is exact, and z is twice the
// focal length, so that the distance S is t z.
struct QuadricRay {
  double x = 0, y = 0, z = 1;
};
// Through the centre of pixel (x, y).
QuadricRay ray_through(const View& view, std::int64_t x, std::int64_t y);

struct Interval {
  double low = 0, high = 0;
};

// f along a ray: a t^2 + 2 b t + c.
struct QuadricAlong {
  Approx a, b, c;
  Approx at(double t) const;
  Interval range(const Interval& t) const;  // holds all values
};
QuadricAlong along(const Quadric& quadric, const QuadricRay& ray);

// Whether f is above a level all along the ray's line, for certain; the quick answer for most rays.
bool is_always_above(const Quadric& quadric, const QuadricRay& ray, double level);

// The sign of b^2 - a c, exactly: how many points the ray's whole line has in common with the quadric.
int discriminant_sign(const Quadric& quadric, const QuadricRay& ray);

// A root of f, enclosed.
struct QuadricRoot {
  Interval t;
  bool enters = false;  // f falls there
};
// All roots with t in the window, the nearest first. Where two are too close to be told apart, both have one
// enclosure.
std::vector<QuadricRoot> roots_of(const Quadric& quadric, const QuadricRay& ray, const Interval& window);

// A quadric of a scene with how far its triangles, snapped, may be from it.
struct QuadricShell {
  Quadric quadric;
  double low = 0, high = 0;  // of f
  double reach = 0;          // of the clip's axis
};
// Of the scene's vertices the snap and the rounding of doubles are added to the quadric's low..high.
QuadricShell shell_of(const Config& config, const Scene& scene, const Quadric& quadric);

// Where a ray may meet the tessellation.
struct QuadricCrossing {
  Interval t;
  bool is_certain = false;  // it meets it there, on a side that is drawn
};
// Of the wall and of the caps, in no order, within the window.
std::vector<QuadricCrossing> crossings_of(const QuadricShell& shell, const QuadricRay& ray,
                                          const Interval& window);

// What the ray meets first of the quadric itself and its caps, on a side that is drawn.
struct QuadricHit {
  Interval t;
  bool is_open = false;  // whether it meets it there lies within the error: at the rim of a cap
};
std::optional<QuadricHit> first_hit(const Quadric& quadric, const QuadricRay& ray, const Interval& window);

}  // namespace bitspan::golden
