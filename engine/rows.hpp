// SPDX-License-Identifier: Apache-2.0
// Rows that were made elsewhere, in place of triangles: what golden and the model take beside Engine::draw. A
// bench of a unit behind edge_walk drives it so.
#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "engine/engine.hpp"

namespace bitspan {

// The records of which there is one per row.
using AnyRow = std::variant<RowRecord, PlaneRowRecord, SpanRecord>;

// A triangle of const_depth_rows.
struct PlaneOfRows {
  bool along_y = false;  // its rows run along y, else along x
  std::span<const PlaneRowRecord> rows;
};

// Throws InputError where a row needs more of its triangle than a row that was made elsewhere has: lod and
// depth its gradients, and span_setup its plane.
void check_draws_rows(const Config& config, const AnyRow& row);

// The callers promise: registers within their formats, pixels within the picture, and in const_depth_rows a
// setup record with an area, and the pixels of one of its rows.
class RowEngine {
 public:
  virtual ~RowEngine() = default;
  // Makes the plane of a triangle and its rows; const_depth_rows only. They hold until the next begin, draw
  // or set_plane.
  virtual PlaneOfRows set_plane(const SetupRecord& setup) = 0;
  // Draws one row from behind its stage through merge. plane_row: which of the plane's rows has its pixels;
  // not read in the modes with horizontal rows. texture: -1 for none. With a trace, appends the row and all
  // that is made of it. Counts the row, and what the stages behind it count.
  virtual void draw_row(const AnyRow& row, std::size_t plane_row, int texture, Trace* trace) = 0;
};

}  // namespace bitspan
