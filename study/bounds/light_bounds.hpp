// SPDX-License-Identifier: Apache-2.0
// Proves upper bounds for the error of the unit `light` at a fragment; docs/bounds.md, "Light".
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "config/config.hpp"
#include "golden/ideal_point.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// |register - ideal| is at most this. With the brightness of vertices, all but `value` and the colours are 0.
struct LightBound {
  double normal = 0, direction = 0;  // of each part
  double cosine = 0, mirrored = 0, specular = 0, value = 0;
  std::array<double, 3> color{};  // of a fragment whose colour in front of light is exact
};

class LightBounds {
 public:
  // The scene has a light. Throws InputError where no bound is known for a mode; it then
  // names the key.
  LightBounds(const Config& config, const Scene& scene);
  ~LightBounds();
  LightBounds(const LightBounds&) = delete;
  LightBounds& operator=(const LightBounds&) = delete;

  // Returns the bounds at the centre of a pixel of a triangle that covers one; color: the texture's, exactly.
  LightBound at(std::size_t triangle, const IdealPoint& centre, const std::array<double, 3>& color) const;

 private:
  struct Triangles;
  Config config_;
  std::unique_ptr<Triangles> triangles_;
};

}  // namespace bitspan
