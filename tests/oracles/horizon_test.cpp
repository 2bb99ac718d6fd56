// SPDX-License-Identifier: Apache-2.0
// The floating horizon against its definition at every place, and against the Y-buffer on every column of a
// height field. [H4]
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "tests/oracles/field_support.hpp"

namespace bitspan {
namespace {

using golden::compared;
using golden::HorizonLines;
using golden::Integer;
using golden::LinePart;
using golden::Ratio;
using golden::SectionLine;
using Piece = HorizonLines::Piece;

bool holds(const Piece& piece, const Ratio& x) {
  const int from = compared(piece.from, x);
  return (piece.is_open ? from < 0 : from <= 0) && compared(x, piece.to) < 0;
}

// y of a part's line at any x.
Ratio y_at(const LinePart& part, const Ratio& x) {
  const Integer right = part.b.x - part.a.x;
  return {right * part.a.y * x.d + Integer(part.b.y - part.a.y) * (x.n - part.a.x * x.d), right * x.d};
}
const LinePart* part_at(const SectionLine& line, const Ratio& x) {
  for (const LinePart& part : line.parts) {
    if (compared({part.a.x, 1}, x) <= 0 && compared(x, {part.b.x, 1}) < 0) return &part;
  }
  return nullptr;
}

// The definition at one x: a line is seen where it is above all before it (sense -1), or below them (1).
std::set<std::size_t> seen_at(std::span<const SectionLine> lines, const Ratio& x, int sense) {
  std::set<std::size_t> out;
  std::optional<Ratio> horizon;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const LinePart* part = part_at(lines[i], x);
    if (part == nullptr) continue;
    const Ratio y = y_at(*part, x);
    if (horizon && sense * compared(y, *horizon) <= 0) continue;
    horizon = y;
    if (!lines[i].is_side_edge) out.insert(i);
  }
  return out;
}
std::set<std::size_t> seen_at(std::span<const Piece> pieces, const Ratio& x) {
  std::set<std::size_t> out;
  for (const Piece& piece : pieces) {
    if (holds(piece, x)) out.insert(piece.line);
  }
  return out;
}

// A line falls from (0, 0) to (30, 20), and the next one rises from (0, 10) to (30, 0): y = 2 x / 3 and
// y = 10 - x / 3 meet at x = 10.
TEST(Horizon, TheCrossingIsFoundExactly) {
  const std::vector<SectionLine> lines{{false, {{{0, 0}, {30, 20}, 0}}}, {false, {{{0, 10}, {30, 0}, 1}}}};
  const HorizonLines seen = golden::horizon_lines(lines);
  ASSERT_EQ(seen.above.size(), 2U);
  ASSERT_EQ(seen.below.size(), 2U);
  const Piece& above = seen.above[1];
  EXPECT_EQ(above.line, 1U);
  EXPECT_TRUE(above.is_open);
  EXPECT_EQ(compared(above.from, {10, 1}), 0);
  EXPECT_EQ(compared(above.to, {30, 1}), 0);
  const Piece& below = seen.below[1];
  EXPECT_FALSE(below.is_open);
  EXPECT_EQ(compared(below.from, {0, 1}), 0);
  EXPECT_EQ(compared(below.to, {10, 1}), 0);
  // The source's remedy without the crossing point would show none of it, or all.
  ASSERT_EQ(seen.upper.size(), 2U);
  EXPECT_EQ(seen.upper[0].line, 0U);
  EXPECT_EQ(seen.upper[1].line, 1U);
  ASSERT_EQ(seen.lower.size(), 2U);
  EXPECT_EQ(seen.lower[0].line, 1U);
}

// Lines on a coarse grid: they meet at corners, lie on each other, begin and end on the way. At every end and
// crossing of any two parts, and between neighbours of these, the pieces are what the definition says.
TEST(Horizon, EqualsItsDefinitionAtEveryPlace) {
  Random draw(91);
  std::uint64_t places = 0;
  std::uint64_t crossings = 0;
  for (int round = 0; round < (is_long_run() ? 2000 : 60); ++round) {
    std::vector<SectionLine> lines;
    for (int i = 0; i < 6; ++i) {
      SectionLine& line = lines.emplace_back();
      line.is_side_edge = draw.chance(0.2);
      std::int64_t x = draw.integer(0, 6);
      std::int64_t y = draw.integer(0, 5);
      while (x < 14) {
        const golden::Point b{x + draw.integer(1, 5), draw.integer(0, 5)};
        if (!draw.chance(0.2)) line.parts.push_back({{x, y}, b, i});
        x = b.x;
        y = draw.chance(0.8) ? b.y : draw.integer(0, 5);
      }
    }
    std::vector<Ratio> at;
    for (const SectionLine& one : lines) {
      for (const LinePart& p : one.parts) {
        at.push_back({p.a.x, 1});
        at.push_back({p.b.x, 1});
        for (const SectionLine& other : lines) {
          for (const LinePart& q : other.parts) {
            // (b - a) of the two slopes and offsets, over the common denominator.
            const std::int64_t pr = p.b.x - p.a.x, pd = p.b.y - p.a.y, qr = q.b.x - q.a.x, qd = q.b.y - q.a.y;
            const std::int64_t a = pd * qr - qd * pr;
            const std::int64_t c = (q.a.y * qr - qd * q.a.x) * pr - (p.a.y * pr - pd * p.a.x) * qr;
            if (a != 0) at.push_back({a > 0 ? c : -c, std::abs(a)});
          }
        }
      }
    }
    const auto before = [](const Ratio& a, const Ratio& b) { return compared(a, b) < 0; };
    std::ranges::sort(at, before);
    const auto same = [](const Ratio& a, const Ratio& b) { return compared(a, b) == 0; };
    at.erase(std::unique(at.begin(), at.end(), same), at.end());
    for (std::size_t i = at.size(); i-- > 1;) {
      at.push_back({at[i].n * at[i - 1].d + at[i - 1].n * at[i].d, 2 * at[i].d * at[i - 1].d});
    }
    const HorizonLines seen = golden::horizon_lines(lines);
    for (const Ratio& x : at) {
      ASSERT_EQ(seen_at(seen.above, x), seen_at(lines, x, -1)) << "round " << round;
      ASSERT_EQ(seen_at(seen.below, x), seen_at(lines, x, 1)) << "round " << round;
      ++places;
    }
    for (const Piece& piece : seen.above) crossings += piece.is_open ? 1 : 0;
  }
  EXPECT_GT(places, 3000U);
  EXPECT_GT(crossings, 40U);
}

struct Sums {
  std::uint64_t points = 0, seen = 0, differences = 0;
};
// Per column, which lines are seen, and how far out the horizon is in the end. sense: as above; the buffer is
// of the lines upside down where it is 1.
void compare_columns(const golden::YBufferLines& buffer, std::span<const Piece> seen,
                     std::span<const Piece> horizon, int sense, Sums& to) {
  for (std::size_t x = 0; x < buffer.seen.size(); ++x) {
    const Ratio at{golden::column_centre(static_cast<std::int64_t>(x)), 1};
    std::set<std::size_t> by_buffer;
    for (const auto& point : buffer.seen[x]) by_buffer.insert(point.line);
    bool is_equal = seen_at(seen, at) == by_buffer;
    const auto piece = std::ranges::find_if(horizon, [&](const Piece& p) { return holds(p, at); });
    is_equal = is_equal && (piece != horizon.end()) == buffer.highest[x].has_value();
    if (is_equal && piece != horizon.end()) {
      const Ratio y = y_at(*piece->part, at);
      is_equal = compared({-sense * y.n, y.d}, *buffer.highest[x]) == 0;
    }
    ++to.points;
    to.seen += by_buffer.size();
    to.differences += is_equal ? 0 : 1;
  }
}

// The picture upside down, so that what is below becomes what is above.
std::vector<SectionLine> turned_over(std::vector<SectionLine> lines) {
  for (SectionLine& line : lines) {
    for (LinePart& part : line.parts) {
      part.a.y = -part.a.y;
      part.b.y = -part.b.y;
    }
  }
  return lines;
}

std::vector<SectionLine> lines_of(const Scene& scene, int count, bool side_edges = true) {
  return golden::section_lines(golden::faces_of_scene(test::field_config(), scene), count, side_edges).lines;
}

TEST(Horizon, EqualsTheYBufferOnEveryColumnFromSixteenSides) {
  const HeightField field = test::hills();
  Sums above;
  Sums below;
  Sums planted;
  for (int side = 0; side < 16; ++side) {
    for (const double pitch : is_long_run() ? std::vector{5.0, 10.0, 20.0} : std::vector{20.0}) {
      const Scene scene = test::field_by_distance(field, {.yaw = 22.5 * side, .pitch = pitch});
      ASSERT_EQ(test::refusal_of("horizon", test::field_config(), scene), "") << side << " " << pitch;
      const std::vector<SectionLine> lines = lines_of(scene, is_long_run() ? 60 : 24);
      const HorizonLines seen = golden::horizon_lines(lines);
      const golden::YBufferLines buffer = golden::ybuffer_lines(lines, scene.width);
      compare_columns(buffer, seen.above, seen.upper, -1, above);
      compare_columns(golden::ybuffer_lines(turned_over(lines), scene.width), seen.below, seen.lower, 1,
                      below);
      EXPECT_EQ(above.differences, 0U) << side << " " << pitch;
      EXPECT_EQ(below.differences, 0U) << side << " " << pitch;
      // A planted fault: one part of one line is a sixteenth of a pixel too low.
      std::vector<SectionLine> low = lines;
      std::vector<LinePart>& parts = low[low.size() / 2].parts;
      for (LinePart& part : parts) {
        part.a.y += 1 << (golden::line_bits - 4);
        part.b.y += 1 << (golden::line_bits - 4);
      }
      const HorizonLines wrong = golden::horizon_lines(low);
      compare_columns(buffer, wrong.above, wrong.upper, -1, planted);
    }
  }
  printf("horizon = Y-buffer: %llu columns, %llu points above and %llu below, %llu differences\n",
         static_cast<unsigned long long>(above.points), static_cast<unsigned long long>(above.seen),
         static_cast<unsigned long long>(below.seen),
         static_cast<unsigned long long>(above.differences + below.differences));
  EXPECT_GT(above.seen, 16 * 500U);
  EXPECT_GT(below.seen, 16 * 30U);
  EXPECT_GT(planted.differences, 16U);
}

// The front line begins at x = 10, the next one, on a ridge, at 6, and the last one, in the valley behind it,
// at 0. The field's side goes from (10, 10) to (6, 4). It is at y = 8 where x = 26 / 3: there the last line
// goes behind the field. Without side edges it would end at x = 10, below the end of the front line.
TEST(Horizon, ASideEdgeHidesWhatLiesBehindTheFieldsSide) {
  const SectionLine front{false, {{{10, 10}, {20, 10}, 0}}};
  const SectionLine ridge{false, {{{6, 4}, {20, 4}, 1}}};
  const SectionLine valley{false, {{{0, 8}, {20, 8}, 2}}};
  const SectionLine first_side{true, {{{6, 4}, {10, 10}, -1}}};
  const SectionLine second_side{true, {{{0, 8}, {6, 4}, -1}}};
  const auto end_of_valley = [](const std::vector<SectionLine>& lines) {
    const HorizonLines seen = golden::horizon_lines(lines);
    Ratio out{-1, 1};
    for (const auto* pieces : {&seen.above, &seen.below}) {
      for (const Piece& piece : *pieces) {
        if (piece.part->triangle == 2) out = compared(piece.to, out) > 0 ? piece.to : out;
        EXPECT_NE(piece.part->triangle, -1) << "a side edge is not drawn";
      }
    }
    return out;
  };
  EXPECT_EQ(compared(end_of_valley({front, first_side, ridge, second_side, valley}), {26, 3}), 0);
  EXPECT_EQ(compared(end_of_valley({front, ridge, valley}), {10, 1}), 0);
}

// Between two lines there are two side edges, which join their ends, or none where one end is above the
// other.
TEST(Horizon, SideEdgesJoinNeighbours) {
  const Scene scene = test::field_by_distance(test::hills(), {.yaw = 30});
  const std::vector<SectionLine> lines = lines_of(scene, 24);
  const std::vector<SectionLine> alone = lines_of(scene, 24, false);
  ASSERT_EQ(alone.size(), 24U);
  ASSERT_EQ(lines.size(), 3 * 24U - 2);
  const auto same = [](golden::Point a, golden::Point b) { return a.x == b.x && a.y == b.y; };
  for (std::size_t i = 1; i < alone.size(); ++i) {
    const std::vector<LinePart>& before = alone[i - 1].parts;
    const std::vector<LinePart>& own = alone[i].parts;
    const SectionLine& left = lines[3 * i - 2];
    const SectionLine& right = lines[3 * i];
    EXPECT_FALSE(lines[3 * i - 1].is_side_edge);
    for (const auto& [edge, a, b] :
         {std::tuple{&left, before.front().a, own.front().a}, {&right, before.back().b, own.back().b}}) {
      EXPECT_TRUE(edge->is_side_edge);
      ASSERT_EQ(edge->parts.size(), 1U);
      const LinePart& part = edge->parts[0];
      EXPECT_EQ(part.triangle, -1);
      EXPECT_LT(part.a.x, part.b.x);
      EXPECT_TRUE((same(part.a, a) && same(part.b, b)) || (same(part.a, b) && same(part.b, a))) << i;
    }
  }
}

// As a picture: a line goes through the pixels of the points that the Y-buffer shows, and joins them.
TEST(Horizon, DrawsThroughThePointsOfTheYBuffer) {
  const Config config = test::field_config();
  const Scene scene = test::field_by_distance(test::hills(), {.yaw = 30});
  const std::vector<Visible> points = test::picture_of("ybuffer_lines", config, scene);
  const std::vector<Visible> lines = test::picture_of("horizon", config, scene);
  std::size_t drawn = 0;
  std::size_t missed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].triangle < 0) continue;
    ++drawn;
    missed += lines[i].triangle < 0 ? 1 : 0;
  }
  const auto all = std::ranges::count_if(lines, [](const Visible& at) { return at.triangle >= 0; });
  EXPECT_GT(drawn, 500U);
  EXPECT_EQ(missed, 0U);
  EXPECT_GT(static_cast<std::size_t>(all), drawn);
  EXPECT_LT(static_cast<std::size_t>(all), 4 * drawn);
}

TEST(Horizon, RefusesWhatIsNoHeightField) {
  const Config config = shipped_config("depth16");
  // Two sheets that are seen over each other.
  const Scene sheets = test::scene_of({test::triangle_of({4, 40, 10}, {60, 40, 10}, {32, 30, 20}),
                                       test::triangle_of({4, 20, 10}, {60, 20, 10}, {32, 10, 20})});
  EXPECT_EQ(test::refusal_of("horizon", config, sheets),
            "triangles 0 and 1 lie over each other at one distance; the scene is no height field in the "
            "picture's vertical direction");
  EXPECT_NE(test::refusal_of("ybuffer_lines", config, test::spot(80, 60)), "");
  // Nothing at different distances has no section.
  const Scene flat = test::scene_of({test::triangle_of({4, 40, 10}, {60, 40, 10}, {32, 30, 10})});
  EXPECT_TRUE(lines_of(flat, 8).empty());
}

}  // namespace
}  // namespace bitspan
