// SPDX-License-Identifier: Apache-2.0
// Faces in space to triangles on the screen: back-face removal, clipping, perspective, viewport.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/scene.hpp"
#include "scene/transform.hpp"

namespace bitspan {

struct ProjectOptions {
  bool cull = true;  // H1: leave out faces seen from behind or edge on
  // Clip at the picture's borders. Otherwise only at near and far and at a guard band of 16384 pixels around
  // the picture's centre, and the raster stages cut the spans (T2).
  bool clip_sides = true;
};

struct ProjectReport {
  std::uint64_t faces = 0;      // given
  std::uint64_t culled = 0;     // seen from behind or edge on
  std::uint64_t outside = 0;    // wholly beyond one plane of the volume
  std::uint64_t clipped = 0;    // cut by at least one plane
  std::uint64_t dropped = 0;    // triangles left out because they have no area on the screen
  std::uint64_t two_sided = 0;  // given that are never culled
  std::uint64_t drawn = 0;      // faces of which at least one triangle was made
  std::uint64_t triangles = 0;  // made

  ProjectReport& operator+=(const ProjectReport& more);
  bool operator==(const ProjectReport&) const = default;
};

// Appends the triangles to `triangles` in the order of the faces; a clipped face becomes a fan. Every s lies
// in [s_min, s_max]. Adds the counts to `report`. Many faces go in chunks to all threads.
void project(std::span<const Face> faces, const Viewpoint& view, const ProjectOptions& options,
             std::vector<Triangle>& triangles, ProjectReport& report);

// The triangles of a scene as faces in the viewer's space: x to the right, y downward, z along the view axis.
// They have two sides, because what is in a scene was to be seen.
std::vector<Face> faces_of(const Scene& scene);
// A corner of such a face from a vertex on the screen.
Vec3 position_of(const Vertex& vertex, const View& view);

}  // namespace bitspan
