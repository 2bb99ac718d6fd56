// SPDX-License-Identifier: Apache-2.0
// The registers that have a bound, and the error of each.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "study/bounds/error_sum.hpp"

namespace bitspan::bounds {

enum Place : std::size_t {
  setup_b,
  setup_h,
  setup_u,
  setup_v,
  edge_x_acc,
  edge_x,
  edge_h_acc,
  edge_h,
  edge_fu,
  edge_fv,
  edge_reciprocal,
  edge_u,
  edge_v,
  span_h,
  span_fu,
  span_fv,
  span_reciprocal,
  span_u,
  span_v,
  depth_z,
  // Up to project_z: where project.unit is not none.
  project_s,
  project_t,
  project_ratio,
  project_h,
  project_z,
  // Up to light_color: where light.at is not none.
  light_normal,
  light_direction,
  light_cosine,
  light_mirrored,
  light_specular,
  light_value,
  light_color,
  picture_depth,
  picture_u,
  picture_v,
  place_count
};

struct PlaceName {
  const char *place, *stage, *quantity, *unit;
};
constexpr bool is_projected(std::size_t p) { return p >= project_s && p <= project_z; }
constexpr bool is_lit(std::size_t p) { return p >= light_normal && p <= light_color; }
constexpr std::array<PlaceName, place_count> place_names{{
    {"setup.b", "constants", "B", "depth code"},
    {"setup.h", "setup", "h", "depth code"},
    {"setup.uv", "setup", "u", "texel"},
    {"setup.uv", "setup", "v", "texel"},
    {"edge.x_acc", "edge_walk", "x", "pixel"},
    {"edge.x", "edge_walk", "x", "pixel"},
    {"edge.h_acc", "edge_walk", "h", "depth code"},
    {"edge.h", "edge_walk", "h", "depth code"},
    {"edge.f", "edge_walk", "fu", "texel*depth code"},
    {"edge.f", "edge_walk", "fv", "texel*depth code"},
    {"reciprocal.pixel (edge_walk)", "edge_walk", "1/(h+B)", "relative"},
    {"edge.uv", "edge_walk", "u", "texel"},
    {"edge.uv", "edge_walk", "v", "texel"},
    {"span.h", "span", "h", "depth code"},
    {"span.f", "span", "fu", "texel*depth code"},
    {"span.f", "span", "fv", "texel*depth code"},
    {"reciprocal.pixel (span)", "span", "1/(h+B)", "relative"},
    {"span.uv", "span", "u", "texel"},
    {"span.uv", "span", "v", "texel"},
    {"depth.z", "depth", "z", "depth code"},
    {"span.uv (project)", "project", "s", "texel"},
    {"span.uv (project)", "project", "t", "texel"},
    {"project.ratio", "project", "ratio", "1"},
    {"project.h", "project", "h", "depth code"},
    {"depth.z (project)", "project", "z", "depth code"},
    {"light.normal", "light", "normal", "1"},
    {"light.direction", "light", "direction", "1"},
    {"light.cosine", "light", "cosine", "1"},
    {"light.cosine (mirrored)", "light", "mirrored", "1"},
    {"light.specular", "light", "specular", "1"},
    {"light.value", "light", "value", "1"},
    {"texture.color (light)", "light", "colour of an exact one", "colour code"},
    {"depth buffer", "picture", "depth", "depth code"},
    {"picture u", "picture", "u", "texel"},
    {"picture v", "picture", "v", "texel"},
}};

struct PlaceError {
  ErrorSum error;
  bool used = false;
  bool unbounded = false;
  double resolution = 0;
  // Returns the bound rounded up to 32 bits, so that it is readable and leaves room where the terms are added
  // up again.
  double bound() const;
};

// The legal case behind the bounds, which Bound::why describes.
struct WorstCase {
  double edge_distance = 0, span_distance = 0;
  int rows = 0, pixels = 0;
  double q_least = 0;
  double x_error = 0;
  double h_gradient = 0;
  std::array<double, 2> uv_gradient{};
  bool position_capped = false;
  bool slope_saturates = false;
  double w_least = 0;  // of a projector's W (h + B), on the line through the vertices
};

}  // namespace bitspan::bounds
