// SPDX-License-Identifier: Apache-2.0
// Lines that sections draw on a height field, and which of their pieces two algorithms see: the Y-buffer, a
// number per column [V1], and the floating horizon, a line from side to side [H4].
//
// A section is all of the field at one distance. Seen along the distance it is a line y(x) of the picture.
// Lines go from front to back, and each is seen where it rises above all before it, or falls below.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "golden/exact.hpp"
#include "golden/oracle.hpp"

namespace bitspan::golden {

inline constexpr std::string_view no_height_field =
    "the scene is no height field in the picture's vertical direction";

// Points of lines are in units of 2^-line_bits pixel, x to the right and y downward.
inline constexpr int line_bits = 16;
constexpr std::int64_t column_centre(std::int64_t x) { return (2 * x + 1) << (line_bits - 1); }

// A straight part: a.x <= x < b.x.
struct LinePart {
  Point a, b;
  std::int32_t triangle = -1;  // input index; -1 of a side edge
};
// n / d, d > 0.
struct Ratio {
  Integer n, d = 1;
};
int compared(const Ratio& a, const Ratio& b);
// y of the part's line at x.
Ratio height_at(const LinePart& part, std::int64_t x);

struct SectionLine {
  // A side edge is not drawn. It joins an end of a line with that of the line before, so that what lies
  // behind the field's side is not seen between them.
  bool is_side_edge = false;
  std::vector<LinePart> parts;  // by x; they do not overlap
};
struct SectionLines {
  std::vector<SectionLine> lines;  // front to back; a side edge at the left, the line, one at the right
  std::string fault;               // why the scene is no height field; empty where it is one
};
// Cuts the faces at `count` distances, which are spaced evenly in 1/S. Points of the lines are rounded to
// their unit. side_edges: whether there are any. count: at least 1.
SectionLines section_lines(std::span<const OracleFace> faces, int count, bool side_edges = true);
// How many sections a picture has: one per eight rows, and two at least.
int section_count(const Scene& scene);
// Why a scene has no section lines; empty where it has.
std::string refuses_lines(const Config& config, const Scene& scene);

// What a Y-buffer sees of lines at the centres of columns.
struct YBufferLines {
  struct Point {
    std::size_t line = 0;
    std::int32_t triangle = -1;
    Ratio y;
  };
  std::vector<std::vector<Point>> seen;       // per column, front to back
  std::vector<std::optional<Ratio>> highest;  // per column, of all lines; none where there is no line
};
YBufferLines ybuffer_lines(std::span<const SectionLine> lines, int width);

// What a floating horizon sees of lines. All is exact.
struct HorizonLines {
  // from <= x < to, without x = from where is_open.
  struct Piece {
    std::size_t line = 0;
    const LinePart* part = nullptr;  // of the lines given
    Ratio from, to;
    bool is_open = false;  // the line crosses or touches the horizon at `from`
  };
  std::vector<Piece> above, below;  // seen over the upper horizon, and under the lower one; by line and by x
  std::vector<Piece> upper, lower;  // the horizons behind the last line, by x
};
// The lines must outlive the result.
HorizonLines horizon_lines(std::span<const SectionLine> lines);

}  // namespace bitspan::golden
