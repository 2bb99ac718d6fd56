// SPDX-License-Identifier: Apache-2.0
#include "model/stages/line_walk.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {
namespace {

// Four-bit codes of Cohen and Sutherland, in the line's own coordinates.
constexpr unsigned before = 1, behind = 2, below = 4, above = 8;

std::int64_t minor_at(const DigitalLine& line, std::int64_t i) {
  return line.minor +
         static_cast<std::int64_t>(floor_divide(line.phase + int128{line.k} * i, line.one).floor);
}

// Where k > 0: the first pixel whose minor coordinate is `minor` or more.
std::int64_t first_at_least(const DigitalLine& line, std::int64_t minor) {
  // phase + k i >= one (minor - line.minor)
  const int128 missing = int128{line.one} * (minor - line.minor) - line.phase;
  return static_cast<std::int64_t>(-floor_divide(-missing, line.k).floor);
}
// Where k < 0: the first pixel whose minor coordinate is `minor` or less.
std::int64_t first_at_most(const DigitalLine& line, std::int64_t minor) {
  // phase + k i < one (minor + 1 - line.minor)
  const int128 spare = line.phase - int128{line.one} * (minor + 1 - line.minor);
  return static_cast<std::int64_t>(floor_divide(spare, -int128{line.k}).floor) + 1;
}

}  // namespace

LineWalkStage prepare_line_walk(const Config& config, int width, int height) {
  LineWalkStage s;
  s.walk = config.line_walk;
  s.width = width;
  s.height = height;
  s.subpixel_bits = config.subpixel_bits;
  s.k = make_register(config, FormatId::plane_k);
  s.vertex_h = make_register(config, FormatId::setup_h);
  s.vertex_uv = make_register(config, FormatId::setup_uv);
  s.vertex_shade = make_register(config, FormatId::setup_shade);
  s.x = make_register(config, FormatId::edge_x);
  s.h = make_register(config, FormatId::edge_h);
  s.uv = make_register(config, FormatId::edge_uv);
  s.shade = make_register(config, FormatId::edge_shade);
  s.divides_per_line = has_line_slope(config.line_walk) ? 1 : 0;
  return s;
}

LineClip clip_line(const DigitalLine& line, std::int64_t major, std::int64_t length, std::int64_t breadth,
                   std::int64_t depth) {
  const auto code = [&](std::int64_t i) {
    const std::int64_t m = major + i, n = minor_at(line, i);
    return (m < 0 ? before : 0U) | (m >= breadth ? behind : 0U) | (n < 0 ? below : 0U) |
           (n >= depth ? above : 0U);
  };
  LineClip ends{0, length};
  while (true) {
    const unsigned first = code(ends.first), last = code(ends.last);
    if ((first & last) != 0) return {};
    if ((first | last) == 0) return ends;
    // An end outside goes along the digital line to the first pixel that one of its bits lets in. The other
    // end is on the inner side of that bit, so that there is one.
    if ((first & before) != 0) {
      ends.first = -major;
    } else if ((first & below) != 0) {
      ends.first = first_at_least(line, 0);
    } else if ((first & above) != 0) {
      ends.first = first_at_most(line, depth - 1);
    } else if ((last & behind) != 0) {
      ends.last = breadth - 1 - major;
    } else if ((last & below) != 0) {
      ends.last = first_at_most(line, -1) - 1;
    } else {
      ends.last = first_at_least(line, depth) - 1;
    }
  }
}

template <class Watch>
bool line_walk(const LineWalkStage& stage, const SetupRecord& setup, WalkedLine& out, Watch watch) {
  if (!has_lines(stage.walk)) {
    throw InputError("triangle " + std::to_string(setup.triangle) +
                     " is a line, and line.walk = none draws no lines; legal: line.walk = exact, dda");
  }
  SetupVertex l = vertex_of(setup, 0), r = vertex_of(setup, 2);
  const auto pixel = [&](std::int64_t at) { return at >> stage.subpixel_bits; };
  const bool along_y = std::abs(pixel(r.y) - pixel(l.y)) > std::abs(pixel(r.x) - pixel(l.x));
  const auto major = [&](const SetupVertex& v) { return pixel(along_y ? v.y : v.x); };
  const auto minor = [&](const SetupVertex& v) { return pixel(along_y ? v.x : v.y); };
  if (major(l) > major(r)) std::swap(l, r);
  const std::int64_t length = major(r) - major(l), rise = minor(r) - minor(l);

  DigitalLine line{.minor = minor(l)};
  if (has_line_slope(stage.walk)) {
    line.k = length == 0 ? 0 : quantize_ratio(rise, length, 0, stage.k, watch);
    line.one = std::int64_t{1} << stage.k.fraction;
  } else {
    line.k = 2 * rise;
    line.one = 2 * std::max<std::int64_t>(length, 1);
  }
  line.phase = line.one / 2;
  const LineClip clip = clip_line(line, major(l), length, along_y ? stage.height : stage.width,
                                  along_y ? stage.width : stage.height);
  if (clip.first > clip.last) return false;

  const std::int64_t minor_first = minor_at(line, clip.first);
  LineWalkRecord& o = out.record;
  o = {};
  o.triangle = setup.triangle;
  o.major = along_y ? 1 : 0;
  o.major_first = major(l) + clip.first;
  o.minor_first = minor_first;
  o.count = clip.last - clip.first + 1;
  o.phase = static_cast<std::int64_t>(floor_divide(line.phase + int128{line.k} * clip.first, line.one).rest);
  o.k = line.k;
  o.one = line.one;
  const auto centre = [&](const SetupVertex& v) {
    return quantize(int128{2 * major(v) + 1}, 1, stage.x, watch);
  };
  const auto narrowed = [&](std::int64_t raw, const Register& from, const Register& to) {
    return quantize(int128{raw}, from.fraction, to, watch);
  };
  using Field = std::int64_t LineWalkRecord::*;
  const auto put = [&](const SetupVertex& v, const std::array<Field, 8>& to) {
    o.*to[0] = centre(v);
    o.*to[1] = narrowed(v.h, stage.vertex_h, stage.h);
    o.*to[2] = narrowed(v.u, stage.vertex_uv, stage.uv);
    o.*to[3] = narrowed(v.v, stage.vertex_uv, stage.uv);
    for (std::size_t c = 0; c < channel_count; ++c) {
      o.*to[4 + c] = narrowed(v.c[c], stage.vertex_shade, stage.shade);
    }
  };
  using R = LineWalkRecord;
  put(l, {&R::l_x, &R::l_h, &R::l_u, &R::l_v, &R::l_r, &R::l_g, &R::l_b, &R::l_a});
  put(r, {&R::r_x, &R::r_h, &R::r_u, &R::r_v, &R::r_r, &R::r_g, &R::r_b, &R::r_a});

  PlaneGeometry& g = out.geometry;
  g.is_line = true;
  g.phase = o.phase;
  g.k = o.k;
  g.one = o.one;
  g.along_y = along_y;
  return true;
}

RowRecord row_of(const LineWalkRecord& line) {
  RowRecord row;
  row.triangle = line.triangle;
  row.y = line.minor_first;
  row.x_first = line.major_first;
  row.x_last = line.major_first + line.count - 1;
  row.l_x = line.l_x;
  row.l_h = line.l_h;
  row.l_u = line.l_u;
  row.l_v = line.l_v;
  row.l_r = line.l_r;
  row.l_g = line.l_g;
  row.l_b = line.l_b;
  row.l_a = line.l_a;
  row.r_x = line.r_x;
  row.r_h = line.r_h;
  row.r_u = line.r_u;
  row.r_v = line.r_v;
  row.r_r = line.r_r;
  row.r_g = line.r_g;
  row.r_b = line.r_b;
  row.r_a = line.r_a;
  return row;
}

template bool line_walk(const LineWalkStage&, const SetupRecord&, WalkedLine&, NoObserve);
template bool line_walk(const LineWalkStage&, const SetupRecord&, WalkedLine&, Observe);

}  // namespace bitspan::model
