// SPDX-License-Identifier: Apache-2.0
#include "golden/line_walk.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "golden/quantize.hpp"
#include "golden/values.hpp"

namespace bitspan::golden {

namespace {

// The place of each line's value in a row's ends, and in the record.
struct EndFields {
  FieldOf<LineWalkRecord> l, r;
};
constexpr std::array<EndFields, fixed_lines> end_fields = [] {
  using R = LineWalkRecord;
  return std::array<EndFields, fixed_lines>{{{&R::l_h, &R::r_h},
                                             {&R::l_u, &R::r_u},
                                             {&R::l_v, &R::r_v},
                                             {&R::l_r, &R::r_r},
                                             {&R::l_g, &R::r_g},
                                             {&R::l_b, &R::r_b},
                                             {&R::l_a, &R::r_a}}};
}();

// Quadruple precision holds each product and sum below: k has at most 64 bits, and a pixel's number 25.
class LineWalker {
 public:
  LineWalker(const Config& config, int width, int height)
      : walk_(config.line_walk),
        width_(width),
        height_(height),
        vertex_(config),
        q_k_(config.format(FormatId::plane_k)),
        q_x_(config.format(FormatId::edge_x)) {
    for (const Line& line : lines_of(config)) q_end_.emplace_back(config.format(line.edge.kept));
  }

  std::optional<LineWalkRecord> operator()(const SetupRecord& setup) const {
    if (!has_lines(walk_)) {
      throw InputError("triangle " + std::to_string(setup.triangle) +
                       " is a line, and line.walk = none draws no lines; legal: line.walk = exact, dda");
    }
    VertexValues<Quad> l = vertex_.load(setup, 0), r = vertex_.load(setup, 2);
    const Quad wide = floorq(r.x) - floorq(l.x), high = floorq(r.y) - floorq(l.y);
    const bool along_y = high * high > wide * wide;
    const auto major = [&](const VertexValues<Quad>& v) { return floorq(along_y ? v.y : v.x); };
    const auto minor = [&](const VertexValues<Quad>& v) { return floorq(along_y ? v.x : v.y); };
    if (major(r) < major(l)) std::swap(l, r);
    const Quad length = major(r) - major(l), rise = minor(r) - minor(l);

    LineWalkRecord out;
    out.triangle = setup.triangle;
    out.major = along_y ? 1 : 0;
    Quad k = 0;  // a pixel rises by k / one
    if (has_line_slope(walk_)) {
      const Quad slope = length > 0 ? q_k_.quotient(rise, length) : Quad(0);
      out.one = q_k_.raw(1);
      k = q_k_.raw(slope);
    } else {
      out.one = 2 * static_cast<std::int64_t>(length > 0 ? length : Quad(1));
      k = 2 * rise;
    }
    out.k = static_cast<std::int64_t>(k);
    const Quad one = static_cast<Quad>(out.one);
    // Each pixel of the whole line, and whether it lies in the picture.
    for (std::int64_t i = 0; i <= static_cast<std::int64_t>(length); ++i) {
      const Quad up = one / 2 + k * static_cast<Quad>(i);
      const Quad rows = whole_of_quotient(up, one).whole;
      const Quad m = major(l) + static_cast<Quad>(i), n = minor(l) + rows;
      const Quad x = along_y ? n : m, y = along_y ? m : n;
      if (x < 0 || x >= width_ || y < 0 || y >= height_) continue;
      if (out.count++ > 0) continue;
      out.major_first = static_cast<std::int64_t>(m);
      out.minor_first = static_cast<std::int64_t>(n);
      out.phase = static_cast<std::int64_t>(up - rows * one);
    }
    if (out.count == 0) return std::nullopt;
    out.l_x = q_x_.raw(q_x_(major(l) + Quad(0.5)));
    out.r_x = q_x_.raw(q_x_(major(r) + Quad(0.5)));
    for (std::size_t i = 0; i < fixed_lines; ++i) {
      out.*end_fields[i].l = q_end_[i].raw(q_end_[i](l.line[i]));
      out.*end_fields[i].r = q_end_[i].raw(q_end_[i](r.line[i]));
    }
    return out;
  }

 private:
  LineForm walk_;
  int width_, height_;
  VertexFormats<Quad> vertex_;
  Quantizer<Quad> q_k_, q_x_;
  std::vector<Quantizer<Quad>> q_end_;
};

}  // namespace

LineWalkStage make_line_walk(const Config& config, int width, int height) {
  return LineWalker(config, width, height);
}

std::int64_t minor_at(const LineWalkRecord& line, std::int64_t i) {
  const Quad up = static_cast<Quad>(line.phase) + static_cast<Quad>(line.k) * static_cast<Quad>(i);
  return line.minor_first +
         static_cast<std::int64_t>(whole_of_quotient(up, static_cast<Quad>(line.one)).whole);
}

RowRecord row_of(const LineWalkRecord& line) {
  RowRecord row;
  row.triangle = line.triangle;
  row.y = line.minor_first;
  row.x_first = line.major_first;
  row.x_last = line.major_first + line.count - 1;
  row.l_x = line.l_x;
  row.r_x = line.r_x;
  for (std::size_t i = 0; i < fixed_lines; ++i) {
    row.*row_fields[i].l = line.*end_fields[i].l;
    row.*row_fields[i].r = line.*end_fields[i].r;
  }
  return row;
}

}  // namespace bitspan::golden
