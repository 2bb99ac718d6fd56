// SPDX-License-Identifier: Apache-2.0
// The Y-buffer of height fields: sections from front to back, and per column of the picture the highest row
// that one of them has come to. A section shows what rises above it. [V1] What falls below the lowest row is
// the field's lower side, seen under its front. The source has no lowest row, and would hide it.
//
// Through the centres of a column the field is cut by a plane, and each triangle leaves a section there. All
// of one is nearer than all of the next one: a line of the picture's vertical direction, at one distance,
// meets the field in one point. No depth is compared at a pixel.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "golden/exact.hpp"
#include "golden/oracle.hpp"
#include "golden/section_lines.hpp"

namespace bitspan {

namespace {

using golden::Integer;
using golden::Wide;

class YBuffer {
 public:
  explicit YBuffer(const OracleInput& input)
      : input_(input),
        grid_(input.faces),
        is_closed_(owns_every_edge(input.config.fill_rule)),
        first_(static_cast<std::size_t>(input.scene.width)) {
    for (const OracleFace& face : input.faces) {
      const golden::PixelBox box = golden::pixel_box(face.shape, input.scene.width, input.scene.height);
      if (box.x_first > box.x_last) continue;
      first_[static_cast<std::size_t>(box.x_first)].push_back({&face, box.x_last});
    }
  }

  std::vector<Visible> picture() {
    std::vector<Visible> out(first_.size() * static_cast<std::size_t>(input_.scene.height));
    walk([&](std::int64_t x, const std::vector<Section>& sections) {
      fill(x, sections, [&](std::int64_t y) -> Visible& {
        return out[static_cast<std::size_t>(y) * first_.size() + static_cast<std::size_t>(x)];
      });
      return true;
    });
    return out;
  }

  // Why the scene is no such field; empty where it is one.
  std::string fault() {
    std::string out;
    std::vector<Visible> column(static_cast<std::size_t>(input_.scene.height));
    walk([&](std::int64_t x, const std::vector<Section>& sections) {
      out = order_fault(x, sections);
      if (!out.empty()) return false;
      std::ranges::fill(column, Visible{});
      const Section* behind_gap =
          fill(x, sections, [&](std::int64_t y) -> Visible& { return column[static_cast<std::size_t>(y)]; });
      if (behind_gap != nullptr) {
        out = fmt::format(
            "in column {} triangle {} shows through a gap in what is in front of it, as culled faces leave "
            "one",
            x, behind_gap->face->index);
      }
      return out.empty();
    });
    return out;
  }

 private:
  using Corner = IdealTriangle::Corner;

  // Where a side crosses a column: y and 1/S are means of its ends, weighted by how far the other end is.
  struct Cut {
    const Corner* a = nullptr;
    const Corner* b = nullptr;
    std::int64_t to_a = 0, to_b = 0;  // along x, from 0 on; not both 0
    long double q = 0;                // 1/S, off by less than 2^-60 of itself
  };
  struct Section {
    const OracleFace* face = nullptr;
    Cut near, far;
  };
  struct Active {
    const OracleFace* face = nullptr;
    std::int64_t last_column = 0;
  };

  // x: in units of golden::Point, not outside of the side, whose ends differ in x.
  static Cut cut_of(const Corner& a, const Corner& b, std::int64_t x) {
    Cut out{&a, &b, std::abs(x - golden::point_of(a).x), std::abs(golden::point_of(b).x - x)};
    out.q = (out.to_b / a.s + out.to_a / b.s) / static_cast<long double>(out.to_a + out.to_b);
    return out;
  }
  // y = n / d, in units of golden::Point.
  static Wide y_n(const Cut& cut) {
    return Wide(golden::point_of(*cut.a).y) * cut.to_b + Wide(golden::point_of(*cut.b).y) * cut.to_a;
  }
  static std::int64_t y_d(const Cut& cut) { return cut.to_a + cut.to_b; }
  static bool has_equal_y(const Cut& a, const Cut& b) { return y_n(a) * y_d(b) == y_n(b) * y_d(a); }

  // The sign of 1/S of a less that of b: 1 where a is nearer.
  int compared(const Cut& a, const Cut& b) const {
    if (std::abs(a.q - b.q) > 0x1p-58L * std::max(a.q, b.q)) return a.q > b.q ? 1 : -1;
    const auto n = [&](const Cut& c) {
      return Integer(c.to_b) * grid_.whole(c.b->s) + Integer(c.to_a) * grid_.whole(c.a->s);
    };
    const auto d = [&](const Cut& c) { return Integer(y_d(c)) * grid_.whole(c.a->s) * grid_.whole(c.b->s); };
    return (n(a) * d(b) - n(b) * d(a)).sign();
  }

  // Adds the section that a face leaves in a column, if the column is one of its own: of a face that begins
  // or ends there, by the fill rule.
  void add_section(const OracleFace& face, std::int64_t x, std::vector<Section>& to) const {
    const std::int64_t at = golden::centre_of(face.shape, x, 0).x;
    std::array<const Corner*, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = &face.shape.v[i];
    std::ranges::sort(v, {}, [](const Corner* c) { return c->x; });
    const auto column_of = [](const Corner* c) { return golden::point_of(*c).x; };
    const bool is_last = at == column_of(v[2]);
    if (at < column_of(v[0]) || at > column_of(v[2]) || (is_last && !is_closed_)) return;
    const bool by_first = is_last ? at <= column_of(v[1]) : at < column_of(v[1]);
    Section out{&face, cut_of(*v[0], *v[2], at),
                by_first ? cut_of(*v[0], *v[1], at) : cut_of(*v[1], *v[2], at)};
    if (compared(out.near, out.far) < 0) std::swap(out.near, out.far);
    to.push_back(out);
  }

  // Calls f(x, sections from front to back) per column until it returns false.
  template <class F>
  void walk(F f) {
    std::vector<Active> active;
    std::vector<Section> sections;
    for (std::size_t x = 0; x < first_.size(); ++x) {
      const auto column = static_cast<std::int64_t>(x);
      active.insert(active.end(), first_[x].begin(), first_[x].end());
      sections.clear();
      for (const Active& a : active) add_section(*a.face, column, sections);
      std::ranges::sort(sections, [&](const Section& a, const Section& b) {
        int order = compared(a.near, b.near);
        if (order == 0) order = compared(a.far, b.far);
        return order != 0 ? order > 0 : a.face->index < b.face->index;
      });
      if (!f(column, sections)) return;
      std::erase_if(active, [&](const Active& a) { return a.last_column <= column; });
    }
  }

  std::string order_fault(std::int64_t x, const std::vector<Section>& sections) const {
    for (std::size_t i = 0; i < sections.size(); ++i) {
      const Section& own = sections[i];
      if (compared(own.near, own.far) == 0 && !has_equal_y(own.near, own.far)) {
        return fmt::format("in column {} triangle {} stands upright in the picture; {}", x, own.face->index,
                           golden::no_height_field);
      }
      if (i == 0) continue;
      const Section& before = sections[i - 1];
      if (compared(before.far, own.near) >= 0) continue;
      // By a closed rule a column through a side belongs to the triangles on both of its sides.
      if (compared(before.near, own.near) == 0 && compared(before.far, own.far) == 0 &&
          has_equal_y(before.near, own.near) && has_equal_y(before.far, own.far)) {
        continue;
      }
      return fmt::format("in column {} triangles {} and {} are at the same distances; {}", x,
                         before.face->index, own.face->index, golden::no_height_field);
    }
    return "";
  }

  struct Rows {
    std::int64_t first = 0, last = -1;
  };
  // Whose centres a section covers, inside the picture or not.
  Rows rows_of(const Section& section, std::int64_t x) const {
    const IdealTriangle& t = section.face->shape;
    const Wide pixel = Wide(1) << t.subpixel_bits;
    // The centre of row r is at (2 r + 1) pixels of half size.
    const auto first_from = [&](const Cut& cut) {
      const Wide n = y_n(cut) - pixel * y_d(cut);
      const Wide d = 2 * pixel * y_d(cut);
      return static_cast<std::int64_t>(n > 0 ? (n + d - 1) / d : -(-n / d));
    };
    const bool near_is_low = y_n(section.near) * y_d(section.far) > y_n(section.far) * y_d(section.near);
    const Cut& high = near_is_low ? section.far : section.near;
    const Cut& low = near_is_low ? section.near : section.far;
    Rows out{first_from(high), first_from(low)};
    const auto is_covered = [&](std::int64_t y) { return ideal_covers(input_.config, t, x, y); };
    // The fill rule decides of centres on a side.
    if (out.first <= out.last && !is_covered(out.first)) ++out.first;
    if (out.first <= out.last && !is_covered(out.last)) --out.last;
    return out;
  }

  Visible seen_of(const OracleFace& face, std::int64_t x, std::int64_t y) const {
    return {face.index, golden::inverse_distance(
                            face.shape, golden::areas_at(face.shape, golden::centre_of(face.shape, x, y)))};
  }

  // Fills a column; pixel(y) is the one of a row. Returns the first section that has a row between the
  // highest and the lowest one which none before it covers; null where there is none.
  template <class Pixel>
  const Section* fill(std::int64_t x, const std::vector<Section>& sections, Pixel pixel) const {
    const std::int64_t height = input_.scene.height;
    Rows seen{height, -1};  // from the highest to the lowest; rows run downward
    const Section* behind_gap = nullptr;
    for (const Section& section : sections) {
      const Rows rows = rows_of(section, x);
      if (rows.first > rows.last) continue;
      const std::int64_t first = std::max<std::int64_t>(0, rows.first);
      const std::int64_t last = std::min(rows.last, height - 1);
      for (std::int64_t y = first; y <= last; ++y) {
        const bool is_hidden = seen.first <= y && y <= seen.last;
        if (!is_hidden) pixel(y) = seen_of(*section.face, x, y);
        if (is_hidden && pixel(y).triangle < 0 && behind_gap == nullptr) behind_gap = &section;
      }
      // A centre on a side that two sections share: of both, which are as far, the first triangle is seen.
      for (const std::int64_t y : {seen.first, seen.last}) {
        if (first > y || y > last || section.face->index >= pixel(y).triangle) continue;
        const Visible own = seen_of(*section.face, x, y);
        if (own.q == pixel(y).q) pixel(y) = own;
      }
      seen = {std::min(seen.first, rows.first), std::max(seen.last, rows.last)};
    }
    return behind_gap;
  }

  const OracleInput& input_;
  golden::DistanceGrid grid_;
  bool is_closed_;                          // edges belong to the triangle on both sides
  std::vector<std::vector<Active>> first_;  // by the first column of their boxes
};

std::vector<Visible> fill_columns(const OracleInput& input) { return YBuffer(input).picture(); }

std::string refuses_field(const Config& config, const Scene& scene) {
  const std::vector<OracleFace> faces = golden::faces_of_scene(config, scene);
  return YBuffer({config, scene, faces}).fault();
}

const RegisterOracle oracle{{.name = "ybuffer",
                             .meaning = "height fields by sections from front to back, and the highest row "
                                        "per column",
                             .refuses = refuses_field,
                             .visible = fill_columns}};

std::vector<Visible> draw_points(const OracleInput& input) {
  const Scene& scene = input.scene;
  std::vector<Visible> out(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  const golden::SectionLines sections = golden::section_lines(input.faces, golden::section_count(scene));
  const golden::YBufferLines buffer = golden::ybuffer_lines(sections.lines, scene.width);
  for (std::size_t x = 0; x < buffer.seen.size(); ++x) {
    for (const golden::YBufferLines::Point& point : buffer.seen[x]) {
      const Integer d = point.y.d << golden::line_bits;
      if (point.y.n < 0 || point.y.n >= d * scene.height) continue;
      Visible& pixel =
          out[static_cast<std::size_t>(point.y.n / d) * static_cast<std::size_t>(scene.width) + x];
      if (pixel.triangle < 0) pixel.triangle = point.triangle;
    }
  }
  return out;
}

const RegisterOracle lines{{.name = "ybuffer_lines",
                            .meaning = "lines of sections by a Y-buffer, a point per column",
                            .draws_lines = true,
                            .refuses = golden::refuses_lines,
                            .visible = draw_points}};

}  // namespace

golden::YBufferLines golden::ybuffer_lines(std::span<const SectionLine> lines, int width) {
  YBufferLines out;
  out.seen.resize(static_cast<std::size_t>(width));
  out.highest.resize(out.seen.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const LinePart& part : lines[i].parts) {
      const std::int64_t first = std::max<std::int64_t>(0, part.a.x >> line_bits);
      for (std::int64_t x = first; x < width && column_centre(x) < part.b.x; ++x) {
        if (column_centre(x) < part.a.x) continue;
        const auto column = static_cast<std::size_t>(x);
        const Ratio y = height_at(part, column_centre(x));
        std::optional<Ratio>& highest = out.highest[column];
        if (highest && compared(y, *highest) >= 0) continue;
        highest = y;
        if (!lines[i].is_side_edge) out.seen[column].push_back({i, part.triangle, y});
      }
    }
  }
  return out;
}

}  // namespace bitspan

extern "C" void ybuffer_oracle() {}
