// SPDX-License-Identifier: Apache-2.0
// The z-buffer line by line: edges lie in a bucket per first row, those that cross a row are active and step
// to the next one, and along a span 1/S takes one step per pixel. All in integers. [H5, B3]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "config/modes.hpp"
#include "golden/exact.hpp"
#include "golden/oracle.hpp"

namespace bitspan {

namespace {

using golden::Integer;
using golden::Point;
using golden::Wide;

// n = whole * d + rest, 0 <= rest < d.
struct Division {
  std::int64_t whole = 0;
  Wide rest = 0;
};
Division divided(Wide n, Wide d) {
  const Wide whole = n >= 0 ? n / d : -((-n + d - 1) / d);
  return {static_cast<std::int64_t>(whole), n - whole * d};
}

// An edge at a row: it crosses the line through the row's centres at column whole + rest / d, where column x
// is the centre of pixel x.
struct ActiveEdge {
  std::size_t face = 0;  // of the input's
  std::int64_t last_row = 0;
  Division column, step;
  Wide d = 1;

  std::int64_t floor() const { return column.whole; }
  std::int64_t ceil() const { return column.whole + (column.rest > 0 ? 1 : 0); }
  void go_down() {
    column.whole += step.whole;
    column.rest += step.rest;
    if (column.rest < d) return;
    column.rest -= d;
    ++column.whole;
  }
};

// A face's 1/S, as n / d.
struct Plane {
  golden::InversePlane at;
  long double d = 1;
};

// What is seen at a pixel of the row so far.
struct Seen {
  const Plane* plane = nullptr;  // none: nothing
  std::size_t face = 0;
  Integer n;
  long double value = 0;  // of n / d; off by less than 2^-60 of itself
};

// Of faces that are exactly as far, the one seen first stays.
bool is_nearer(const Integer& n, long double value, const Plane& plane, const Seen& seen) {
  if (seen.plane == nullptr) return true;
  if (std::abs(value - seen.value) > 0x1p-58L * std::max(value, seen.value)) return value > seen.value;
  return n * seen.plane->at.d > seen.n * plane.at.d;
}

class Lines {
 public:
  explicit Lines(const OracleInput& input)
      : input_(input),
        grid_(input.faces),
        is_closed_(owns_every_edge(input.config.fill_rule)),
        first_(static_cast<std::size_t>(input.scene.height)) {
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
      const IdealTriangle& t = input.faces[f].shape;
      const auto p = [&](std::size_t i) { return golden::point_of(t.v[i]); };
      put(f, p(0), p(1));
      put(f, p(1), p(2));
      put(f, p(0), p(2));
      const golden::InversePlane plane = golden::inverse_plane(t, grid_);
      planes_.push_back({plane, static_cast<long double>(plane.d)});
    }
  }

  std::vector<Visible> picture() {
    const auto width = static_cast<std::size_t>(input_.scene.width);
    std::vector<Visible> out(width * first_.size());
    std::vector<Seen> row(width);
    for (std::size_t y = 0; y < first_.size(); ++y) {
      std::ranges::fill(row, Seen{});
      draw_row(static_cast<std::int64_t>(y), row);
      for (std::size_t x = 0; x < width; ++x) {
        if (row[x].plane != nullptr) {
          out[y * width + x] = visible(row[x], static_cast<std::int64_t>(x), static_cast<std::int64_t>(y));
        }
      }
    }
    return out;
  }

 private:
  // An edge from the vertex a down to b, where it crosses a row of the picture. An edge owns its upper end,
  // and its lower one where the fill rule is closed.
  void put(std::size_t face, Point a, Point b) {
    if (a.y == b.y) return;
    const std::int64_t pixel = std::int64_t{1} << input_.faces[face].shape.subpixel_bits;
    const std::int64_t pitch = 2 * pixel;  // from centre to centre
    const std::int64_t first = std::max<std::int64_t>(0, divided(a.y - pixel + pitch - 1, pitch).whole);
    const std::int64_t last = divided(b.y - pixel - (is_closed_ ? 0 : 1), pitch).whole;
    if (first > last || first >= std::int64_t{input_.scene.height}) return;
    const Wide down = b.y - a.y;
    const Wide right = b.x - a.x;
    ActiveEdge edge;
    edge.face = face;
    edge.last_row = last;
    edge.d = down * pitch;
    edge.column = divided((a.x - pixel) * down + (first * pitch + pixel - a.y) * right, edge.d);
    edge.step = divided(right * pitch, edge.d);
    first_[static_cast<std::size_t>(first)].push_back(edge);
  }

  void draw_row(std::int64_t y, std::vector<Seen>& row) {
    std::erase_if(active_, [&](const ActiveEdge& edge) { return edge.last_row < y; });
    for (ActiveEdge& edge : active_) edge.go_down();
    const auto& begun = first_[static_cast<std::size_t>(y)];
    const auto old = static_cast<std::ptrdiff_t>(active_.size());
    active_.insert(active_.end(), begun.begin(), begun.end());
    std::ranges::inplace_merge(active_, active_.begin() + old, {}, &ActiveEdge::face);
    for (std::size_t i = 0; i < active_.size();) {
      const std::size_t face = active_[i].face;
      std::int64_t first = active_[i].ceil();
      std::int64_t last = is_closed_ ? active_[i].floor() : first - 1;
      for (++i; i < active_.size() && active_[i].face == face; ++i) {
        first = std::min(first, active_[i].ceil());
        last = std::max(last, is_closed_ ? active_[i].floor() : active_[i].ceil() - 1);
      }
      fill(face, y, std::max<std::int64_t>(0, first), std::min<std::int64_t>(last, input_.scene.width - 1),
           row);
    }
  }

  void fill(std::size_t face, std::int64_t y, std::int64_t first, std::int64_t last, std::vector<Seen>& row) {
    if (first > last) return;
    const Plane& plane = planes_[face];
    Integer n = plane.at.a * first + plane.at.b * y + plane.at.c;
    for (std::int64_t x = first; x <= last; ++x, n += plane.at.a) {
      const long double value = static_cast<long double>(n) / plane.d;
      Seen& seen = row[static_cast<std::size_t>(x)];
      if (is_nearer(n, value, plane, seen)) seen = {&plane, face, n, value};
    }
  }

  // With the value that the steps have come to, so that the comparison sees a wrong step.
  Visible visible(const Seen& seen, std::int64_t x, std::int64_t y) const {
    const OracleFace& face = input_.faces[seen.face];
    Visible out{face.index,
                golden::inverse_distance(face.shape,
                                         golden::areas_at(face.shape, golden::centre_of(face.shape, x, y)))};
    out.q.value = grid_.inverse(seen.value);
    return out;
  }

  const OracleInput& input_;
  golden::DistanceGrid grid_;
  bool is_closed_;                              // edges belong to the triangle on both sides
  std::vector<std::vector<ActiveEdge>> first_;  // by the first row that they cross
  std::vector<ActiveEdge> active_;              // by their faces
  std::vector<Plane> planes_;
};

std::vector<Visible> line_by_line(const OracleInput& input) { return Lines(input).picture(); }

const RegisterOracle oracle{{.name = "scanline",
                             .meaning = "active edges row by row, and one exact step of 1/S per pixel",
                             .visible = line_by_line}};

}  // namespace

}  // namespace bitspan

extern "C" void scanline_oracle() {}
