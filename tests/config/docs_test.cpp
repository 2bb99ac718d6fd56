// SPDX-License-Identifier: Apache-2.0
// docs/configuration.md says what the code says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>

#include "config/keys.hpp"
#include "tests/config/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

const std::string page = source_path("docs/configuration.md");

using Rows = std::vector<std::string>;

std::string row_of(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out.append(" ").append(cell).append(" |");
  return out;
}
std::string code(std::string_view text) { return std::string("`").append(text).append("`"); }

std::string names_text(std::span<const std::string_view> names) {
  if (names.data() == enum_names<Rounding>.data()) return "a rounding mode";
  if (names.data() == enum_names<Overflow>.data()) return "an overflow mode";
  std::string out;
  for (const std::string_view name : names) out.append(out.empty() ? "" : ", ").append(code(name));
  return out;
}

std::string legal_text(const KeyRow& row) {
  Config initial;
  const Place at = row.place(initial, 0);
  std::string out;
  std::string by_default;
  if (const auto* number = std::get_if<int*>(&at)) {
    const Limits& limits = row.limits;
    out = (limits.power_of_two ? "a power of two, " : "") + std::to_string(limits.lowest) + ".." +
          std::to_string(limits.highest);
    by_default = std::to_string(**number);
  } else if (const auto* truth = std::get_if<bool*>(&at)) {
    out = "true, false";
    by_default = **truth ? "true" : "false";
  } else if (const auto* choice = std::get_if<Choice>(&at)) {
    out = names_text(choice->names);
    by_default = code(choice->names[*choice->number]);
  } else if (std::holds_alternative<StartOffset*>(at)) {
    out = "a number, `\"half_ulp\"`";
    by_default = "0";
  } else if (std::holds_alternative<Color*>(at)) {
    out = "`\"none\"`, `[r, g, b]`";
    by_default = "`\"none\"`";
  } else if (const auto* color = std::get_if<Rgba*>(&at)) {
    out = "`[r, g, b, a]`";
    for (const int code : **color) by_default += (by_default.empty() ? "`[" : ", ") + std::to_string(code);
    by_default += "]`";
  } else {
    out = "a format";
  }
  out += row.rule;
  switch (row.use.presence) {
    case Presence::always:
      return out;
    case Presence::where_used:
      return out + ", *optional* for " + std::string(row.use.unused_for);
    case Presence::optional:
    case Presence::later:
      return out + ", *optional*: " + by_default;
  }
  return out;
}

std::string effects_text(const KeyRow& row) {
  const auto text = [](unsigned bits) {
    std::string out;
    for (const auto& [bit, name] : {std::pair(affects::ideal, "ideal"),
                                    {affects::values, "values"},
                                    {affects::clocks, "clocks"},
                                    {affects::rtl, "RTL"}}) {
      if ((bits & bit) != 0) out.append(out.empty() ? "" : ", ").append(name);
    }
    return out;
  };
  constexpr unsigned hardware = affects::clocks | affects::rtl;
  if (row.use.in_rtl == nullptr) return text(row.affects);
  const std::string everywhere = text(row.affects & ~hardware);
  return everywhere + (everywhere.empty() ? "" : "; ") + "row, pixel: " + text(row.affects & hardware);
}

Rows key_table() {
  Rows out{"| key | legal | affects | meaning |", "|---|---|---|---|"};
  for (const KeyRow& row : key_rows()) {
    if (row.text.empty()) continue;  // the formats, which have a table of their own
    out.push_back(row_of({code(row.path), legal_text(row), effects_text(row), std::string(row.text)}));
  }
  return out;
}

Rows field_table() {
  Rows out{"| field | legal | meaning |", "|---|---|---|"};
  for (const FieldRow& field : field_rows()) {
    Format any;
    const Place at = field.place(any);
    std::string legal;
    if (const auto* choice = std::get_if<Choice>(&at)) {
      for (const std::string_view name : choice->names) legal += (legal.empty() ? "" : ", ") + code(name);
    }
    legal += field.legal;
    if (field.presence == Presence::later) legal += ", *optional*: false";
    out.push_back(row_of({code(field.name), legal, std::string(field.text)}));
  }
  return out;
}

// What a file that leaves the register out has; empty where it must give it.
std::string format_by_default(FormatId id) {
  const FormatDefault& by_default = format_defaults[static_cast<std::size_t>(id)];
  if (const auto* other = std::get_if<FormatId>(&by_default))
    return ", *optional*: as " + code(key_of(*other));
  const auto* f = std::get_if<Format>(&by_default);
  if (f == nullptr) return "";
  return std::string(", *optional*: ") + (f->is_signed ? "signed" : "unsigned") + ", word " +
         std::to_string(f->word) + ", int " + std::to_string(f->integer) + ", " +
         std::string(to_string(f->rounding)) + ", " + std::string(to_string(f->overflow));
}

Rows format_table() {
  Rows out{"| key | unit | meaning |", "|---|---|---|"};
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    out.push_back(row_of(
        {code(key_of(id)), std::string(unit_of(id)), std::string(text_of(id)) + format_by_default(id)}));
  }
  return out;
}

// The page's lines between <!-- NAME --> and <!-- end of NAME --> are the table. BITSPAN_UPDATE_DOCS=1 writes
// the page anew.
void expect_table(const std::string& name, const Rows& expected) {
  Rows lines = lines_of(read_file(page));
  const auto begin = std::ranges::find(lines, "<!-- " + name + " -->");
  const auto end = std::ranges::find(lines, "<!-- end of " + name + " -->");
  ASSERT_TRUE(begin < end && end != lines.end()) << name;
  if (std::getenv("BITSPAN_UPDATE_DOCS") != nullptr) {
    const auto at = lines.erase(begin + 1, end);
    lines.insert(at, expected.begin(), expected.end());
    std::ofstream(page) << text_of(lines);
    return;
  }
  EXPECT_EQ(Rows(begin + 1, end), expected) << "BITSPAN_UPDATE_DOCS=1 writes it anew";
}

TEST(Docs, TheTablesAreThoseOfTheCode) {
  expect_table("keys", key_table());
  expect_table("fields", field_table());
  expect_table("formats", format_table());
}

TEST(Docs, EveryKeyHasAMeaning) {
  std::set<std::string_view> paths;
  for (const KeyRow& row : key_rows()) {
    EXPECT_TRUE(paths.insert(row.path).second) << row.path;
    EXPECT_TRUE(row.text.size() > 2 || row.path == "formats.FORMAT") << row.path;
    EXPECT_NE(row.affects, 0U) << row.path;
  }
  EXPECT_GT(paths.size(), 40U);
}

}  // namespace
}  // namespace bitspan
