// SPDX-License-Identifier: Apache-2.0
// line_walk: from a line's ends to the digital line between their pixels, clipped by four-bit codes.
// docs/numeric-spec.md, "line_walk" (B1, B2).
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/quantize.hpp"
#include "model/stages/plane_walk.hpp"

namespace bitspan::model {

struct LineWalkStage {
  LineForm walk = LineForm::none;
  std::int64_t width = 0, height = 0;  // of the viewport, pixels
  int subpixel_bits = 0;
  Register k;                                  // plane.k
  Register vertex_h, vertex_uv, vertex_shade;  // formats of the setup record
  Register x, h, uv, shade;                    // of a row's end
  std::uint64_t divides_per_line = 0;
};
LineWalkStage prepare_line_walk(const Config& config, int width, int height);

// Of pixel i of a digital line the minor coordinate is minor + floor((phase + k i) / one).
struct DigitalLine {
  std::int64_t minor = 0, phase = 0, k = 0, one = 1;
};

// The first and the last pixel of a line that lie in the viewport; first > last: there is none.
struct LineClip {
  std::int64_t first = 0, last = -1;
};
// major: major coordinate of pixel 0; length: number of the last pixel; breadth, depth: of the viewport along
// the major and the minor coordinate.
LineClip clip_line(const DigitalLine& line, std::int64_t major, std::int64_t length, std::int64_t breadth,
                   std::int64_t depth);

// A line's record, and what the span stage must know of it.
struct WalkedLine {
  LineWalkRecord record;
  PlaneGeometry geometry;
};
// False where no pixel lies inside the viewport; then there is no record. setup: of a line, whose ends are
// vertices 0 and 2. Throws InputError, naming the line, where line.walk = none.
template <class Watch = NoObserve>
bool line_walk(const LineWalkStage& stage, const SetupRecord& setup, WalkedLine& out, Watch watch = {});

// The line as a row of edge_walk along its major coordinate, whose y is the minor one of the first pixel.
RowRecord row_of(const LineWalkRecord& line);

}  // namespace bitspan::model
