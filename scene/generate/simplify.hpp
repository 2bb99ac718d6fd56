// SPDX-License-Identifier: Apache-2.0
// Simpler meshes by collapsing edges, with quadrics as costs and a log that undoes it [G4].
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/generate/obj_writer.hpp"
#include "scene/generate/terrain.hpp"
#include "scene/geometry.hpp"

namespace bitspan {

using MeshFace = std::array<std::uint32_t, 3>;

// Corners at one place are one vertex; vertices are numbered as faces name them first.
struct IndexedMesh {
  std::vector<Vec3> vertices;
  std::vector<MeshFace> faces;
  bool operator==(const IndexedMesh&) const = default;
};
// Reads any mesh that read_mesh reads; only places and faces are kept. `left_out` is told how many faces have
// two corners at one place: they are not kept.
IndexedMesh read_indexed_mesh(const std::string& path, std::size_t& left_out);

// One edge that became a vertex. Vertices and faces keep the numbers that they have in the whole mesh.
struct Collapse {
  std::uint32_t kept = 0, gone = 0;
  double cost = 0;  // summed squared distances to the planes of both
  Vec3 kept_before, gone_before, to;
  struct GoneFace {
    std::uint32_t face = 0;
    MeshFace corners{};
    bool operator==(const GoneFace&) const = default;
  };
  std::vector<GoneFace> gone_faces;        // those between both
  std::vector<std::uint32_t> moved_faces;  // those whose corner `gone` became `kept`
  bool operator==(const Collapse&) const = default;
};

// A mesh from which vertices and faces went away, each by a collapse of the log.
struct SimplifiedMesh {
  IndexedMesh mesh;  // of all numbers; what went away is as it was last
  std::vector<bool> has_vertex, has_face;
  std::size_t face_count = 0;
  std::vector<Collapse> log;
  bool operator==(const SimplifiedMesh&) const = default;
};

// Collapses the edge of least cost until `triangles` or fewer faces are left, or none can go. The quadric of
// a vertex is the sum of those of its faces' planes and, at a border, of planes through the border's edges
// across the face. An edge's is the sum of both. Its cost is that of the best place: the optimum where there
// is one, else one of the ends or the middle. No collapse turns a face over, closes a hole, or makes an edge
// of three faces.
SimplifiedMesh simplify(IndexedMesh mesh, std::size_t triangles, const WorkProgress& progress = {});
// Undoes collapses from the last one until there are `triangles` or more faces, or the whole mesh is back.
void undo(SimplifiedMesh& mesh, std::size_t triangles);

// Writes vertices as faces name them first. Returns what was written.
MeshCounts write_mesh(const SimplifiedMesh& mesh, ObjWriter& out);

// The log as a file of JSON Lines, which has all that undo needs. docs/terrain.md describes it.
void write_collapse_log(const SimplifiedMesh& mesh, const std::string& path);
// Throws InputError "FILE:LINE: ..." where the file is not such a log.
SimplifiedMesh read_collapse_log(const std::string& path);

}  // namespace bitspan
