// SPDX-License-Identifier: Apache-2.0
// The table of stages and the list of counters: complete, in order, and told by the documents as they are.
#include "engine/stages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "config/exact.hpp"
#include "engine/counters.hpp"
#include "engine/records.hpp"
#include "tests/config/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

std::vector<std::string> lines_of_file(const std::string& path) {
  return lines_of(read_file(source_path(path)));
}

// The rows of the table between <!-- name --> and <!-- end of name -->.
std::vector<std::string> rows_of(const std::string& path, const std::string& name) {
  std::vector<std::string> found;
  bool inside = false;
  for (const std::string& line : lines_of_file(path)) {
    if (line == "<!-- " + name + " -->") inside = true;
    if (line == "<!-- end of " + name + " -->") inside = false;
    if (inside && line.starts_with("| `")) found.push_back(line);
  }
  return found;
}

std::string code(std::string_view name) { return "`" + std::string(name) + "`"; }

std::string to_string(Per per) {
  switch (per) {
    case Per::scene:
      return "scene";
    case Per::change:
      return "change of state";
    case Per::triangle:
      return "triangle";
    case Per::edge:
      return "edge";
    case Per::row:
      return "row";
    case Per::pixel:
      return "pixel";
  }
  return "";
}

// The stages' names without parts, each once, in the order of the table.
std::vector<std::string> stages_in_order() {
  std::vector<std::string> out;
  for (const StageRow& row : stage_table) {
    if (out.empty() || out.back() != row.stage()) out.emplace_back(row.stage());
  }
  return out;
}

TEST(Stages, TheTableIsTheOneOfTheSpecification) {
  std::vector<std::string> expected;
  for (const StageRow& row : stage_table) {
    std::string from;
    for (const RecordType type : row.made_from) from += (from.empty() ? "" : ", ") + code(row_of(type).name);
    expected.push_back("| " + code(row.name) + " | " + to_string(row.per) +
                       (row.per_channel() ? " and channel | " : " | ") + (from.empty() ? "the scene" : from) +
                       " | " + (row.clock ? code(to_string(*row.clock)) : "none") + " |");
  }
  EXPECT_EQ(rows_of("docs/numeric-spec.md", "stages"), expected);
}

TEST(Stages, CountersAreThoseOfTheSpecification) {
  std::vector<std::string> expected;
  for_each_counter([&](const CounterInfo& info, auto) {
    expected.push_back("| " + code(info.name) + " | " + std::string(info.meaning) + " | " +
                       (info.compared ? "yes" : "no") + " |");
  });
  EXPECT_EQ(rows_of("docs/numeric-spec.md", "counters"), expected);
}

TEST(Stages, EachHasAHeadingInTheSpecificationInTheirOrder) {
  std::vector<std::string> headings;
  for (const std::string& line : lines_of_file("docs/numeric-spec.md")) {
    if (!line.starts_with("## ")) continue;
    for (const std::string& stage : stages_in_order()) {
      const bool names_it = line == "## " + stage || line.starts_with("## " + stage + " ") ||
                            line.find("(" + code(stage) + ")") != std::string::npos;
      if (names_it) headings.push_back(stage);
    }
  }
  EXPECT_EQ(headings, stages_in_order());
}

bool has_own_clock(std::string_view stage) {
  return std::ranges::any_of(
      stage_table, [&](const StageRow& row) { return row.clock && to_string(*row.clock) == stage; });
}

// docs/timing.md: "| setup | ...", or "| edge_walk, plane_walk | ...", in the table headed "stage | takes".
TEST(Stages, EachThatHasAClockOfItsOwnIsInTheTableOfTheTimedModel) {
  std::vector<std::string> found;
  bool inside = false;
  for (const std::string& line : lines_of_file("docs/timing.md")) {
    if (line.starts_with("| stage | takes ")) {
      inside = true;
      continue;
    }
    if (!line.starts_with("|")) inside = false;
    if (!inside || line.starts_with("|---")) continue;
    std::string names = line.substr(2, line.find(" |", 2) - 2);
    for (std::size_t comma = 0; (comma = names.find(", ")) != std::string::npos; names.erase(0, comma + 2)) {
      found.push_back(names.substr(0, comma));
    }
    found.push_back(names);
  }
  std::vector<std::string> expected = stages_in_order();
  std::erase_if(expected, [&](const std::string& stage) {
    return !has_own_clock(stage) && std::ranges::count(found, stage) == 0;
  });
  EXPECT_EQ(found, expected);
}

// config/ names stages too, and cannot see the table.
TEST(Stages, ExactValuesAreOfStagesOfTheTableInTheirOrder) {
  for (const Perspective mode : all_perspectives) {
    Config config = shipped_config("depth16");
    config.perspective = mode;
    const StageRow* last = stage_table.data();
    for (const ExactIntermediate& x : exact_intermediates(config)) {
      if (x.stage.starts_with("reciprocal.")) continue;
      const auto* const row = std::ranges::find(stage_table, x.stage, &StageRow::name);
      ASSERT_NE(row, stage_table.end()) << x.stage;
      // The area belongs to setup, and stands at the end of the list.
      if (x.expression.starts_with("area ")) continue;
      EXPECT_GE(row, last) << x.stage << ": " << x.expression;
      last = row;
    }
  }
}

TEST(Stages, ARecordIsMadeFromEarlierOnesThatStandForAsMuchOrMore) {
  for (const StageRow& row : stage_table) {
    EXPECT_EQ(row.made_from.size() == 0, row.per == Per::scene) << row.name;
    RecordType last = RecordType::constants;
    for (const RecordType type : row.made_from) {
      EXPECT_LT(type, row.type) << row.name;
      EXPECT_LE(row_of(type).per, row.per) << row.name;
      EXPECT_GE(type, last) << row.name << ": not in the order of the pipeline";
      last = type;
    }
    // What a record stands for shows in its integer fields.
    const bool has_triangle = field_index(row.type, "triangle") >= 0;
    const bool has_pixel = field_index(row.type, "x") >= 0 && field_index(row.type, "y") >= 0;
    EXPECT_EQ(has_triangle, row.per != Per::scene) << row.name;
    EXPECT_EQ(field_index(row.type, "edge") >= 0, row.per == Per::edge) << row.name;
    EXPECT_EQ(field_index(row.type, "channel") >= 0, row.per_channel()) << row.name;
    if (row.per == Per::pixel) {
      EXPECT_TRUE(has_pixel) << row.name;
    }
    if (row.per == Per::triangle || row.per == Per::edge) {
      EXPECT_FALSE(has_pixel) << row.name;
    }
  }
}

TEST(Stages, ClocksAreTakenInTheOrderOfThePipeline) {
  int next = 0;
  for (const StageRow& row : stage_table) {
    EXPECT_EQ(row.clock.has_value(), row.per > Per::change) << row.name;
    if (!row.clock) continue;
    const int clock = static_cast<int>(*row.clock);
    EXPECT_TRUE(clock == next || clock == next - 1) << row.name;
    // The first stage of a clock gives it its name; plane_walk works in the clock of edge_walk, light, which
    // is behind a late depth test, in that of fog, and candidate in that of merge.
    if (clock == next && row.type != RecordType::light && row.type != RecordType::candidate) {
      EXPECT_EQ(row.stage(), to_string(*row.clock));
    }
    next = clock + 1;
  }
  EXPECT_EQ(next, stage_count);
}

TEST(Stages, EachRecordOfATraceIsReservedAndClearedByItsRow) {
  Trace trace;
  deliver(&trace, ConstantsRecord{});
  deliver(&trace, FragmentRecord{});
  deliver(&trace, MergeRecord{});
  deliver(nullptr, MergeRecord{});
  trace.clear_pixels();
  EXPECT_EQ(trace.constants.size(), 1U);
  EXPECT_TRUE(trace.fragment.empty());
  EXPECT_TRUE(trace.merge.empty());
  trace.reserve_pixels(100);
  for (const StageRow& row : stage_table) EXPECT_EQ(view_of(trace, row.type).stage, row.name);
  EXPECT_GE(trace.fog.capacity(), 100U);
  EXPECT_LT(trace.span.capacity(), 100U);
}

TEST(Counters, AddUp) {
  Counters a;
  Counters b;
  int n = 0;
  for_each_counter([&](const CounterInfo&, auto member) {
    a.*member = 3;
    b.*member = static_cast<std::uint8_t>(++n);
  });
  a += b;
  n = 0;
  for_each_counter([&](const CounterInfo& info, auto member) {
    EXPECT_EQ(static_cast<int>(a.*member), 3 + ++n) << info.name;
  });
  EXPECT_EQ(sizeof(Counters), static_cast<std::size_t>(n) * sizeof(std::uint64_t));
}

}  // namespace
}  // namespace bitspan
