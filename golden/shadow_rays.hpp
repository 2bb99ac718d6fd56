// SPDX-License-Identifier: Apache-2.0
// What a light sees, without quantisation: whether a point is lit, by rays from the light to all that a
// lookup in its shadow map may take for the point. [SH2, V2]
//
// All is in the light's picture, the map: places in texels, and q = 1/W, which is linear over each plane
// there.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan::golden {

// A triangle between the light and others.
struct Caster {
  std::array<double, 3> x{}, y{}, q{};
  double excess = 0;  // it may be stored nearer by so much of q, where that is more than a bias is made for
  bool vanishes = false;  // fragments of it may be killed
};
Caster caster_of(const Triangle& seen_by_light);

// A point of a plane, and the plane's q in the picture: q_x x + q_y y + q_0. The comparison adds `shift` to
// it. Either may make the point nearer than its surface, which is among the casters then, at a share of this
// q.
struct Receiver {
  double x = 0, y = 0;
  double q_x = 0, q_y = 0, q_0 = 0;
  double shift = 0;
  double q(double at_x, double at_y) const { return q_x * at_x + q_y * at_y + q_0; }
};
// The point with these weights of a triangle whose corners have X, Y, W. W is positive there, and the light
// is not in the triangle's plane; else q is not finite.
Receiver receiver_at(const std::array<std::array<double, 3>, 3>& xyw, const std::array<double, 3>& weights);

enum class Lit {
  lit,      // nothing in reach is, or may be stored, nearer to the light
  dark,     // all in reach is covered, by what is nearer by at least the margin
  open,     // an edge is in reach, or what is nearer by less
  unknown,  // something whose fragments may be killed is in reach
};

class ShadowRays {
 public:
  explicit ShadowRays(std::span<const Caster> casters);
  ~ShadowRays();
  ShadowRays(const ShadowRays&) = delete;
  ShadowRays& operator=(const ShadowRays&) = delete;
  // reach: texels from the point, each way. margin: of q.
  Lit at(const Receiver& receiver, double reach, double margin) const;

 private:
  struct Tree;
  std::vector<Caster> casters_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace bitspan::golden
