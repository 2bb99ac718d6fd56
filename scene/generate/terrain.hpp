// SPDX-License-Identifier: Apache-2.0
// Terrain on regular grids [G1], and with a resolution that falls with the distance [G5].
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "scene/generate/height_field.hpp"
#include "scene/generate/obj_writer.hpp"

namespace bitspan {

// How samples become a mesh: the field's middle at x = z = 0, its lowest sample at y = 0, x along the columns
// and z along the rows. Faces look upward.
struct TerrainPlace {
  double spacing = 1;   // between samples
  double vertical = 1;  // times each height
  bool shade = false;   // vertices have a grey that grows with the height
};

// Turns samples of a field into places of the mesh.
class PlacedField {
 public:
  PlacedField(const HeightField& field, const TerrainPlace& place);
  // 0 <= x <= columns - 1 in samples, z alike.
  Vec3 position(double x, double z) const { return position(x, height_at(field_, x, z), z); }
  void write(ObjWriter& out, double x, double z) const { write(out, x, height_at(field_, x, z), z); }
  // The same with another height than the field's.
  Vec3 position(double x, double height, double z) const;
  void write(ObjWriter& out, double x, double height, double z) const;

 private:
  const HeightField& field_;
  TerrainPlace place_;
  double lowest_, highest_;
};

enum class GridKind : std::uint8_t {
  right,       // squares with a diagonal each
  equilateral  // rows that are shifted against each other by half a step
};

// The grid over a field. With columns of its own it is spread over the field, and heights between samples are
// interpolated. It has the rows that make triangles right or equilateral; these are as far apart as makes
// them fit.
struct GridOptions {
  GridKind kind = GridKind::right;
  int columns = 0;  // vertices per row; 0: the field's
};

struct MeshCounts {
  std::uint64_t vertices = 0, triangles = 0;
};

// Writes the grid. Memory does not grow with it. Throws InputError where the grid has more vertices than 2^32
// - 1.
MeshCounts write_grid(const HeightField& field, const TerrainPlace& place, const GridOptions& grid,
                      ObjWriter& out, const WorkProgress& progress = {});

// Squares of 2^l samples. One that is more than a sample wide is divided into four where its distance from
// the viewer, along the farther axis, is less than near / 2 times its width. So a square's neighbours are at
// most one level finer.
struct RingOptions {
  double x = 0, z = 0;  // the viewer, in samples
  double near = 32;     // at least 2, in samples; all that is nearer has the full resolution
};
struct RingMesh {
  std::vector<std::array<int, 2>> vertices;  // column, row
  std::vector<std::array<std::uint32_t, 3>>
      triangles;   // counterclockwise seen from above: x to the right, z downward
  int levels = 0;  // widths of squares that occur
};
// Squares that reach over the edge of the field are pressed onto it. A square beside finer ones has its
// middle as a vertex, and those in the middle of its edges that the finer ones have, so that no vertex lies
// inside an edge of another.
RingMesh ring_mesh(int columns, int rows, const RingOptions& rings);

}  // namespace bitspan
