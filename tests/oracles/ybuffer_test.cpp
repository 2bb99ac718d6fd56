// SPDX-License-Identifier: Apache-2.0
// The Y-buffer of height fields: filled against other oracles pixel by pixel and against the engines, and as
// points of section lines. [V1]
#include <gtest/gtest.h>

#include "study/oracles.hpp"
#include "tests/oracles/field_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using test::refusal_of;
using test::triangle_of;

// A strip over all columns, from one row and distance to another.
void add_strip(std::vector<Triangle>& to, double y0, double s0, double y1, double s1) {
  to.push_back(triangle_of({-4, y0, s0}, {70, y0, s0}, {70, y1, s1}));
  to.push_back(triangle_of({-4, y0, s0}, {70, y1, s1}, {-4, y1, s1}));
}

// A slope up to row 20, one down to row 30 behind it, and one up to row 10.
TEST(YBuffer, TheFrontRidgeHidesByHand) {
  std::vector<Triangle> triangles;
  add_strip(triangles, 30, 15, 10, 30);
  add_strip(triangles, 20, 12.5, 30, 15);
  add_strip(triangles, 40, 10, 20, 12.5);
  const Scene scene = test::scene_of(std::move(triangles));
  const Config config = shipped_config("depth16");
  ASSERT_EQ(refusal_of("ybuffer", config, scene), "");
  const std::vector<Visible> picture = test::picture_of("ybuffer", config, scene);
  for (int y = 0; y < 48; ++y) {
    const int strip = y < 10 || y >= 40 ? -1 : y < 20 ? 0 : 2;
    const int seen = test::triangle_at(picture, scene, 31, y);
    EXPECT_EQ(seen < 0 ? -1 : seen / 2, strip) << y;
  }
}

TEST(YBuffer, EqualsTheCoverageOnEdgesToo) {
  Random draw(81);
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    for (const bool on_half_pixels : {false, true}) {
      test::Agreement all;
      for (int round = 0; round < (is_long_run() ? 5000 : 60); ++round) {
        const Scene scene = test::random_field(draw, on_half_pixels);
        ASSERT_EQ(refusal_of("ybuffer", config, scene), "") << "round " << round;
        test::compare_pictures(test::picture_of("ybuffer", config, scene),
                               test::picture_of("half_planes", config, scene), all);
        ASSERT_EQ(all.differences, 0U) << "round " << round << " " << on_half_pixels;
      }
      EXPECT_GT(all.seen, 15000U);
      EXPECT_GT(all.background, 500U);
    }
  }
}

// The row V1 of the sources: the same picture as `scanline`, of a height field in parallel projection.
TEST(YBuffer, EqualsScanlineFromSixteenSides) {
  const HeightField field = test::hills();
  const Config config = test::field_config();
  test::Agreement all;
  for (int side = 0; side < 16; ++side) {
    for (const double pitch : is_long_run() ? std::vector{5.0, 10.0, 20.0} : std::vector{20.0}) {
      const Scene scene = test::field_by_distance(field, {.yaw = 22.5 * side, .pitch = pitch});
      ASSERT_EQ(refusal_of("ybuffer", config, scene), "") << side << " " << pitch;
      test::compare_pictures(test::picture_of("ybuffer", config, scene),
                             test::picture_of("scanline", config, scene), all);
      EXPECT_EQ(all.differences, 0U) << side << " " << pitch;
    }
  }
  printf("ybuffer = scanline: %llu pixels seen, %llu differences\n",
         static_cast<unsigned long long>(all.seen), static_cast<unsigned long long>(all.differences));
  EXPECT_GT(all.seen, 16 * 1500U);
}

// The engine draws the depths of a parallel projection, and those of a central one.
TEST(YBuffer, JudgesAFieldInBothProjections) {
  const HeightField field = test::hills();
  const Config config = test::field_config();
  for (const Projection projection : {Projection::orthographic, Projection::central}) {
    const Scene scene = test::field_scene(
        field, {.yaw = 40, .pitch = 20, .width = 240, .height = 160, .projection = projection});
    EXPECT_EQ(goes_by_given_depth(config, scene), projection == Projection::orthographic);
    std::string why;
    const std::optional<Visibility> visibility = visibility_of(config, scene, why);
    ASSERT_TRUE(visibility) << why;
    const Frame frame = test::drawn_by("model", config, scene);
    for (const char* name : {"ybuffer", "scanline", "painter", "ray"}) {
      const Oracle& oracle = test::oracle_named(name);
      ASSERT_EQ(own_refusal(oracle, config, scene), "") << name;
      const VisibilityReport report =
          visibility->compare(oracle, visibility->picture(oracle), frame, "model");
      EXPECT_EQ(report.unexplained, 0U) << name << ": " << report.first;
      EXPECT_GT(report.equal, 3000U) << name;
      EXPECT_LE(report.ties * 1000, report.compared()) << name;
    }
    // A planted fault of the engine: all is nearer by eight codes than it is.
    Scene wrong = scene;
    const std::size_t depth_bias = *find_state_register("depth.bias");
    wrong.commands.push_back({0, StateChange{false, {{depth_bias, 8}}}});
    const VisibilityReport found =
        visibility->compare(test::oracle_named("ybuffer"), visibility->picture(test::oracle_named("ybuffer")),
                            test::drawn_by("model", config, wrong), "model");
    EXPECT_GT(found.unexplained, 3000U);
  }
}

TEST(YBuffer, RefusesWhatIsNoHeightField) {
  const Config config = shipped_config("depth16");
  const auto refused = [&](std::vector<Triangle> triangles) {
    return refusal_of("ybuffer", config, test::scene_of(std::move(triangles)));
  };
  const std::string no_field = "; the scene is no height field in the picture's vertical direction";
  // Two sheets, one over the other.
  EXPECT_EQ(refused({triangle_of({4, 40, 10}, {60, 40, 10}, {32, 30, 20}),
                     triangle_of({4, 20, 10}, {60, 20, 10}, {32, 10, 20})}),
            "in column 4 triangles 0 and 1 are at the same distances" + no_field);
  // A wall.
  EXPECT_EQ(refused({triangle_of({4, 40, 10}, {60, 40, 10}, {32, 10, 10})}),
            "in column 4 triangle 0 stands upright in the picture" + no_field);
  EXPECT_NE(refusal_of("ybuffer", config, test::spot(80, 60)), "");
  // Of a ridge with a valley behind it the far side is left out, as culling does. What lies behind the valley
  // shows through.
  std::vector<Triangle> triangles;
  add_strip(triangles, 20, 10, 10, 11);
  add_strip(triangles, 40, 12, 30, 13);
  add_strip(triangles, 46, 14, 5, 20);
  const std::string why = refused(triangles);
  EXPECT_NE(why.find("shows through a gap in what is in front of it, as culled faces leave one"),
            std::string::npos)
      << why;
}

// A field that falls from row 20 to row 24 behind its front edge, and rises to row 10: its lower side is seen
// in rows 20 to 23. The source has the highest row alone, and would hide what lies below row 20.
TEST(YBuffer, WhatIsBelowTheFrontIsSeen) {
  std::vector<Triangle> triangles;
  add_strip(triangles, 20, 10, 24, 12);
  add_strip(triangles, 24, 12, 10, 20);
  const Scene scene = test::scene_of(std::move(triangles));
  const Config config = shipped_config("depth16");
  ASSERT_EQ(refusal_of("ybuffer", config, scene), "");
  const std::vector<Visible> picture = test::picture_of("ybuffer", config, scene);
  for (int y = 0; y < 48; ++y) {
    const int seen = test::triangle_at(picture, scene, 31, y);
    EXPECT_EQ(seen < 0 ? -1 : seen / 2, y < 10 || y >= 24 ? -1 : y < 20 ? 1 : 0) << y;
  }
  EXPECT_EQ(test::agreement("ybuffer", config, scene).differences, 0U);
}

// "When the second section is written, the Y-buffer is zeroed", says the source, and its flow chart says the
// opposite. Zeroed, the buffer hides nothing: each section is then the first.
TEST(YBuffer, ZeroedForEachSectionItWouldHideNothing) {
  const Config config = test::field_config();
  const Scene scene = test::field_by_distance(test::hills(), {.yaw = 30});
  const std::vector<OracleFace> faces = golden::faces_of_scene(config, scene);
  const golden::SectionLines sections = golden::section_lines(faces, 20, false);
  const auto points = [&](std::span<const golden::SectionLine> lines) {
    std::size_t out = 0;
    for (const auto& column : golden::ybuffer_lines(lines, scene.width).seen) out += column.size();
    return out;
  };
  std::size_t zeroed = 0;
  for (const golden::SectionLine& line : sections.lines) zeroed += points({&line, 1});
  const std::size_t kept = points(sections.lines);
  EXPECT_GT(kept, 500U);
  EXPECT_GT(zeroed, kept + 50);
}

// Two lines and a side edge by hand; y runs downward.
TEST(YBuffer, KeepsTheHighestPointPerColumn) {
  const auto at = [](double x, double y) {
    return golden::Point{static_cast<std::int64_t>(x * 65536), static_cast<std::int64_t>(y * 65536)};
  };
  const std::vector<golden::SectionLine> lines{
      {false, {{at(0, 10), at(4, 10), 0}}},
      {true, {{at(4, 10), at(6, 10), -1}}},
      {false, {{at(0.5, 6), at(6.5, 12), 1}}},
  };
  const golden::YBufferLines buffer = golden::ybuffer_lines(lines, 8);
  // The second line is at 6 in column 0, and one lower per column: as high as the first in column 4.
  for (std::size_t x = 0; x < 8; ++x) {
    std::vector<std::size_t> expected;
    if (x < 4) expected = {0, 2};
    std::vector<std::size_t> seen;
    for (const auto& point : buffer.seen[x]) seen.push_back(point.line);
    EXPECT_EQ(seen, expected) << x;
    ASSERT_EQ(buffer.highest[x].has_value(), x < 6) << x;
    if (!buffer.highest[x]) continue;
    const golden::Ratio y{static_cast<std::int64_t>(65536 * (x < 4 ? 6 + x : 10)), 1};
    EXPECT_EQ(compared(*buffer.highest[x], y), 0) << x;
  }
}

TEST(YBuffer, LinesAreForALookAlone) {
  expect_refusal([] { parse_oracles("scanline,ybuffer_lines"); },
                 "--oracles: 'ybuffer_lines' draws lines, and judges no picture; legal: all, abuffer, ");
  for (const Oracle* oracle : parse_oracles("all")) EXPECT_FALSE(oracle->draws_lines) << oracle->name;
  EXPECT_EQ(oracle_names(", ").find("horizon"), std::string::npos);
  EXPECT_NE(oracle_names(", ", true).find("horizon"), std::string::npos);
}

}  // namespace
}  // namespace bitspan
