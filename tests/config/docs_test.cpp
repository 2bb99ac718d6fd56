// docs/configuration.md says what the code says.
#include <gtest/gtest.h>

#include <algorithm>

#include "config/names.hpp"
#include "tests/config/support.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

std::vector<std::string> page() { return lines_of(read_file(BITSPAN_SOURCE_DIR "/docs/configuration.md")); }

TEST(Docs, TheFormatTableIsTheOneOfTheCode) {
  std::vector<std::string> expected;
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    std::string row = "| `";
    row.append(key_of(id)).append("` | ").append(unit_of(id)).append(" | ").append(text_of(id)).append(" |");
    expected.push_back(row);
  }
  std::vector<std::string> found;
  bool inside = false;
  for (const std::string& line : page()) {
    if (line == "<!-- formats -->") inside = true;
    if (line == "<!-- end of formats -->") inside = false;
    if (inside && line.starts_with("| `")) found.push_back(line);
  }
  EXPECT_EQ(found, expected);
}

TEST(Docs, EveryKeyHasARow) {
  const std::vector<std::string> lines = page();
  const auto has_row = [&lines](const std::string& key) {
    const std::string start = std::string("| `").append(key).append("` |");
    return std::ranges::any_of(lines, [&](const std::string& l) { return l.starts_with(start); });
  };
  std::string section;
  int keys = 0;
  for (const std::string& line : lines_of(to_toml(shipped_config("depth16")))) {
    if (line.starts_with('[')) {
      section = line.substr(1, line.size() - 2);
      if (section.starts_with("timing.")) section = "timing.STAGE";
      if (section.starts_with("reciprocal.")) section = "reciprocal.UNIT";
      continue;
    }
    const auto equals = line.find(" = ");
    if (equals == std::string::npos || section == "formats") continue;
    const std::string key = section + "." + line.substr(0, equals);
    EXPECT_TRUE(has_row(key)) << key;
    ++keys;
  }
  for (const char* key : {"signed", "word", "int", "round", "overflow", "overflow_expected"}) {
    EXPECT_TRUE(has_row(key)) << key;
  }
  EXPECT_GT(keys, 30);
}

TEST(Docs, EveryNameOfAModeIsThere) {
  const std::string text = read_file(BITSPAN_SOURCE_DIR "/docs/configuration.md");
  const auto expect_all = [&text](const auto& names) {
    for (const auto name : names) {
      EXPECT_NE(text.find(std::string("`").append(name).append("`")), std::string::npos) << name;
    }
  };
  expect_all(enum_names<Rounding>);
  expect_all(enum_names<Overflow>);
  expect_all(enum_names<FillRule>);
  expect_all(enum_names<EdgeWalk>);
  expect_all(enum_names<DdaUpdate>);
  expect_all(enum_names<Perspective>);
  expect_all(enum_names<Numerator>);
  expect_all(enum_names<SlopeForm>);
  expect_all(enum_names<ReciprocalKind>);
  expect_all(enum_names<DepthCode>);
  expect_all(enum_names<TextureFilter>);
  expect_all(enum_names<TextureWrap>);
  expect_all(enum_names<FogMode>);
  expect_all(enum_names<Stage>);
}

}  // namespace
}  // namespace bitspan
