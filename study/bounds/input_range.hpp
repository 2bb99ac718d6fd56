// SPDX-License-Identifier: Apache-2.0
// The ranges of a scene's input that error bounds are proved from.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"
#include "study/bounds/interval.hpp"
#include "study/bounds/light_error.hpp"

namespace bitspan {

// Where a projector lays the triangles. There is none where a vertex has W <= 0.
struct ProjectedRange {
  double s_min = 1, s_max = 2;              // of the projector
  std::array<Interval, 3> xyw{};            // X, Y, W of the vertices
  std::array<Interval, 3> over_s{};         // X, Y, W over s of the vertices
  std::array<double, 3> over_s_gradient{};  // the largest change of these to a neighbouring pixel of a row
  std::array<Interval, 3> place{};          // X / W, Y / W in texels, and 1 / W, of the vertices
  // The largest change of these to a neighbouring pixel of a row, inside a triangle and the picture.
  std::array<double, 3> place_gradient{};
};

// A triangle under a light.
struct LitTriangle {
  struct Corner {
    double x = 0, y = 0, s = 0;  // snapped, pixels
    std::array<double, 3> normal{};
  };
  bounds::LitView view;
  std::array<Corner, 3> v{};  // in the order of the edge walk
  std::size_t first = 0;      // the one that is the input's first
  // What is linear on the screen changes per pixel to the right by the sum of these times its corners'
  // values.
  std::array<Interval, 3> weight{};
};

// What is known of the triangles. The fields from `shortest_edge` on may stay at what any legal triangle has;
// slivers then decide the bounds.
struct InputRange {
  int width = 640, height = 480;            // of the picture, pixels
  double s_min = 1, s_max = 1000;           // of the scene
  Interval s{1, 1000};                      // of the vertices; within s_min..s_max
  Interval x{0, 640}, y{0, 480};            // of the snapped vertices, pixels
  Interval u{-4096, 4096}, v{-4096, 4096};  // of the vertices, texels
  // The least height of an edge that is not level, in pixels.
  double shortest_edge = 0;
  // The distance between the two edges on a row's centre, in pixels, over rows that have pixels.
  double shortest_row = 0, longest_row = std::numeric_limits<double>::infinity();
  // The largest change of 1/s, u and v to a neighbouring pixel of a row, inside a triangle and the picture.
  double inverse_s_gradient = std::numeric_limits<double>::infinity();
  double u_gradient = std::numeric_limits<double>::infinity();
  double v_gradient = std::numeric_limits<double>::infinity();
  // Whether a pixel's centre may be covered. If not, only vertices are ever computed.
  bool covers = true;
  std::optional<ProjectedRange> projected = std::nullopt;
  // Of one triangle alone.
  std::optional<LitTriangle> lit = std::nullopt;
};

// What light takes of a view with one.
bounds::LitView lit_view(const View& view);

// Returns the hull of triangle_ranges, over all triangles of the scene. A scene without a triangle that has
// an area leaves the defaults, with the scene's size and s range.
InputRange input_range(const Config& config, const Scene& scene);
// Returns one range per triangle that has an area after the snap, in the order of the triangles. Rows and
// coverage are known exactly with edge_walk = exact, and up to the dda's own error otherwise. With edge_walk
// = dda it throws as error_bounds does.
std::vector<InputRange> triangle_ranges(const Config& config, const Scene& scene);
// The same for each triangle; none where it has no area.
std::vector<std::optional<InputRange>> ranges_of_triangles(const Config& config, const Scene& scene);

}  // namespace bitspan
