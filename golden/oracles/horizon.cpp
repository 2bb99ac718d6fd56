// SPDX-License-Identifier: Apache-2.0
// The floating horizon: lines of sections from front to back. A line is seen where it lies above the upper
// horizon of all before it, or below the lower one. Where that changes on the way, the point at which line
// and horizon cross is found exactly. [H4]
//
// The source keeps a number per column, and joins them by straight lines. Here a horizon is a list of parts
// of the lines, with fractions for ends, so that no crossing is lost between two columns.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "golden/section_lines.hpp"

namespace bitspan {

namespace {

using golden::Integer;
using golden::LinePart;
using golden::Ratio;
using Piece = golden::HorizonLines::Piece;

// y of a less y of b, times something positive: a x + c.
struct Difference {
  Integer a, c;
  int sign_at(const Ratio& x) const { return (a * x.n + c * x.d).sign(); }
  // Where it is 0; a is not.
  Ratio zero() const { return a > 0 ? Ratio{-c, a} : Ratio{c, -a}; }
};
Difference difference_of(const LinePart& a, const LinePart& b) {
  const auto right = [](const LinePart& p) { return Integer(p.b.x - p.a.x); };
  const auto down = [](const LinePart& p) { return Integer(p.b.y - p.a.y); };
  // y = (down x + offset) / right
  const auto offset = [&](const LinePart& p) { return right(p) * p.a.y - down(p) * p.a.x; };
  return {down(a) * right(b) - down(b) * right(a), offset(a) * right(b) - offset(b) * right(a)};
}

// One of the two horizons.
class Horizon {
 public:
  // sense: -1 where lines are seen above it, as y runs downward; 1 where they are seen below.
  explicit Horizon(int sense) : sense_(sense) {}

  // Adds to `seen` the pieces of a line that lie on the horizon's outer side, and lifts it to them.
  void add(std::size_t line, const std::vector<LinePart>& parts, std::vector<Piece>* seen) {
    std::vector<Piece> next;
    std::size_t own = 0;
    std::size_t other = 0;
    Ratio at;
    const auto start = [](const LinePart& part) { return Ratio{part.a.x, 1}; };
    const auto first_of = [](const Ratio& a, const Ratio& b) { return compared(a, b) <= 0 ? a : b; };
    for (bool begun = false; own < parts.size() || other < pieces_.size();) {
      const bool has_own = own < parts.size();
      const bool has_other = other < pieces_.size();
      // Without one of them, the other decides alone.
      const Ratio next_start = !has_own     ? pieces_[other].from
                               : !has_other ? start(parts[own])
                                            : first_of(start(parts[own]), pieces_[other].from);
      if (!begun || compared(at, next_start) < 0) at = next_start;
      begun = true;
      const bool is_on_own = has_own && compared(start(parts[own]), at) <= 0;
      const bool is_on_other = has_other && compared(pieces_[other].from, at) <= 0;
      const auto own_end = [&] { return is_on_own ? Ratio{parts[own].b.x, 1} : start(parts[own]); };
      const auto other_end = [&] { return is_on_other ? pieces_[other].to : pieces_[other].from; };
      const Ratio end = !has_own ? other_end() : !has_other ? own_end() : first_of(own_end(), other_end());
      merge(line, is_on_own ? &parts[own] : nullptr, is_on_other ? &pieces_[other] : nullptr, at, end, seen,
            next);
      at = end;
      if (is_on_own && compared(own_end(), at) <= 0) ++own;
      if (is_on_other && compared(other_end(), at) <= 0) ++other;
    }
    pieces_ = std::move(next);
  }

  std::vector<Piece> take() { return std::move(pieces_); }

 private:
  static void append(std::vector<Piece>& to, const Piece& piece) {
    if (!to.empty() && !piece.is_open && to.back().part == piece.part &&
        compared(to.back().to, piece.from) == 0) {
      to.back().to = piece.to;
    } else {
      to.push_back(piece);
    }
  }

  // From `from` to `to` there is one part of the line, or none, and one of the horizon, or none.
  void merge(std::size_t line, const LinePart* own, const Piece* other, const Ratio& from, const Ratio& to,
             std::vector<Piece>* seen, std::vector<Piece>& next) const {
    const auto keep = [&](const Ratio& a, const Ratio& b) { append(next, {other->line, other->part, a, b}); };
    const auto show = [&](const Ratio& a, const Ratio& b, bool is_open) {
      append(next, {line, own, a, b});
      if (seen != nullptr) append(*seen, {line, own, a, b, is_open});
    };
    if (own == nullptr) {
      if (other != nullptr) keep(from, to);
      return;
    }
    if (other == nullptr) return show(from, to, false);
    const Difference rise = difference_of(*own, *other->part);
    const int first = sense_ * rise.sign_at(from);
    const int last = sense_ * rise.sign_at(to);
    if (first <= 0 && last <= 0) return keep(from, to);
    if (first >= 0 && last >= 0) return show(from, to, first == 0);
    const Ratio middle = rise.zero();
    if (first > 0) {
      show(from, middle, false);
      keep(middle, to);
    } else {
      keep(from, middle);
      show(middle, to, true);
    }
  }

  int sense_;
  std::vector<Piece> pieces_;
};

long double value_of(const Ratio& f) {
  return std::ldexp(static_cast<long double>(f.n) / static_cast<long double>(f.d), -golden::line_bits);
}

// Puts a piece into the pixels that it goes through; of two in one pixel the nearer is there first.
void draw(const Piece& piece, const Scene& scene, std::vector<Visible>& out) {
  const auto pixels = [](const golden::Point& p) {
    return std::pair{std::ldexp(static_cast<long double>(p.x), -golden::line_bits),
                     std::ldexp(static_cast<long double>(p.y), -golden::line_bits)};
  };
  const auto [ax, ay] = pixels(piece.part->a);
  const auto [bx, by] = pixels(piece.part->b);
  const long double from = std::max(value_of(piece.from), 0.0L);
  const long double to = std::min(value_of(piece.to), static_cast<long double>(scene.width));
  for (auto x = static_cast<std::int64_t>(from); x < scene.width && static_cast<long double>(x) < to; ++x) {
    const auto y_at = [&, ax = ax, ay = ay, bx = bx, by = by](long double at) {
      return ay + (by - ay) * (at - ax) / (bx - ax);
    };
    const auto [high, low] = std::minmax({y_at(std::max(from, static_cast<long double>(x))),
                                          y_at(std::min(to, static_cast<long double>(x + 1)))});
    if (low < 0 || high >= scene.height) continue;
    const auto last = static_cast<std::int64_t>(std::min<long double>(low, scene.height - 1));
    for (auto y = static_cast<std::int64_t>(std::max(high, 0.0L)); y <= last; ++y) {
      Visible& pixel = out[static_cast<std::size_t>(y * scene.width + x)];
      if (pixel.triangle < 0) pixel.triangle = piece.part->triangle;
    }
  }
}

std::vector<Visible> draw_horizon(const OracleInput& input) {
  const Scene& scene = input.scene;
  std::vector<Visible> out(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  const golden::SectionLines sections = golden::section_lines(input.faces, golden::section_count(scene));
  const golden::HorizonLines seen = golden::horizon_lines(sections.lines);
  for (const auto* pieces : {&seen.above, &seen.below}) {
    for (const Piece& piece : *pieces) draw(piece, scene, out);
  }
  return out;
}

const RegisterOracle oracle{{.name = "horizon",
                             .meaning = "lines of sections by a floating horizon, upper and lower",
                             .draws_lines = true,
                             .refuses = golden::refuses_lines,
                             .visible = draw_horizon}};

}  // namespace

golden::HorizonLines golden::horizon_lines(std::span<const SectionLine> lines) {
  HorizonLines out;
  Horizon upper(-1);
  Horizon lower(1);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_drawn = !lines[i].is_side_edge;
    upper.add(i, lines[i].parts, is_drawn ? &out.above : nullptr);
    lower.add(i, lines[i].parts, is_drawn ? &out.below : nullptr);
  }
  out.upper = upper.take();
  out.lower = lower.take();
  return out;
}

}  // namespace bitspan

extern "C" void horizon_oracle() {}
