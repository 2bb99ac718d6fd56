// SPDX-License-Identifier: Apache-2.0
// A surface in many resolutions by ranks of its points [G3].
#pragma once

#include <cstdint>
#include <vector>

#include "scene/generate/delaunay.hpp"
#include "scene/generate/height_field.hpp"
#include "scene/generate/obj_writer.hpp"
#include "scene/generate/terrain.hpp"

namespace bitspan {

// The difference between a surface of triangles and all samples of the field.
struct SurfaceError {
  double largest = 0;
  double rms = 0;
};
// `surface` has points of the field, column and row, and their heights are the field's. Differences are
// vertical.
SurfaceError surface_error(const HeightField& field, const Delaunay& surface);
// The same of the right grid that has about `points` vertices, spread evenly over the field with interpolated
// heights.
SurfaceError grid_error(const HeightField& field, std::size_t points);

enum class LodCost : std::uint8_t {
  normal,  // the sum of (n . (V_i - V))^2 over the neighbours V_i; n is the mean normal in the full
           // resolution
  error    // how much the sum of all samples' squared errors grows
};

struct LodOptions {
  LodCost cost = LodCost::error;
  int ranks = 8;
  double keep = 0.1;        // of the points, behind the last rank
  double steepness = 0.01;  // height in steps between samples: spacing 1, vertical `steepness`
};

struct LodRank {
  std::size_t points = 0, triangles = 0;  // left when the points of this rank are gone
  SurfaceError error;
  double bound = 0;  // the largest error up to this rank
};

struct Lod {
  std::vector<LodRank> ranks;
  std::vector<std::int32_t>
      rank;  // of each sample, row by row: the rank with which it goes; ranks.size() where it stays
};

// Ranks every sample. Of each rank the points of least cost are taken out one by one, and the costs of their
// neighbours are formed anew. Corners stay. Ranks take equal shares: each leaves the same part of what the
// one before left.
Lod make_lod(const HeightField& field, const LodOptions& options, const WorkProgress& progress = {});

// The surface of the points whose rank is `least` or more, triangulated again.
Delaunay lod_surface(const HeightField& field, const std::vector<std::int32_t>& rank, std::int32_t least);

// Writes the points of a surface that are in, and its triangles.
MeshCounts write_surface(const HeightField& field, const TerrainPlace& place, const Delaunay& surface,
                         ObjWriter& out);

// The corners first, then all samples for which `chosen` holds, as points of a triangulation.
template <class Chosen>
std::vector<GridPoint> chosen_points(const HeightField& field, const Chosen& chosen) {
  const int right = field.columns - 1, low = field.rows - 1;
  std::vector<GridPoint> out{{0, 0}, {right, 0}, {right, low}, {0, low}};
  for (int j = 0; j <= low; ++j) {
    for (int i = 0; i <= right; ++i) {
      const bool is_corner = (i == 0 || i == right) && (j == 0 || j == low);
      if (!is_corner && chosen(i, j)) out.push_back({i, j});
    }
  }
  return out;
}

}  // namespace bitspan
