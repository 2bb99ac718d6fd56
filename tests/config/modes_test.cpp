// SPDX-License-Identifier: Apache-2.0
// No source compares a mode with an enumerator: config/modes.hpp says what a mode implies, in exhaustive
// switches, and so does whoever needs more. A new enumerator then does not compile until each place has
// decided.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

// bench/ is left out: its kernels are written by hand for one configuration and refuse any other.
constexpr auto folders = std::to_array<std::string_view>(
    {"config", "io", "scene", "engine", "model", "golden", "report", "tb", "study", "cli"});

// Every enumeration that config.hpp declares, and EdgeX of modes.hpp, each as "FogMode::".
const std::vector<std::string>& modes() {
  static const std::vector<std::string> all = [] {
    constexpr std::string_view declaration = "\nBITSPAN_ENUM(";
    const std::string text = read_file(source_path("config/config.hpp"));
    std::vector<std::string> out{"EdgeX::"};
    for (std::size_t at = text.find(declaration); at != std::string::npos;
         at = text.find(declaration, at + 1)) {
      const std::size_t name = at + declaration.size();
      out.push_back(text.substr(name, text.find(',', name) - name) + "::");
    }
    return out;
  }();
  return all;
}

bool is_enumerator(std::string_view word) {
  return std::ranges::any_of(modes(), [&](std::string_view mode) { return word.starts_with(mode); });
}

// Lines with a comparison whose left or right side is an enumerator.
std::vector<std::string> comparisons_in(std::string_view text) {
  constexpr std::string_view name = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_:";
  constexpr std::string_view spaces = " \n";
  std::vector<std::string> found;
  for (std::size_t at = text.find('='); at != std::string_view::npos; at = text.find('=', at + 1)) {
    if (at == 0 || (text[at - 1] != '=' && text[at - 1] != '!')) continue;
    const std::size_t right = text.find_first_not_of(spaces, at + 1);
    const std::size_t left_end = text.find_last_not_of(spaces, at - 2) + 1;
    const std::size_t left = text.find_last_not_of(name, left_end - 1) + 1;
    const bool wrong = (right != std::string_view::npos && is_enumerator(text.substr(right))) ||
                       is_enumerator(text.substr(left, left_end - left));
    if (!wrong) continue;
    const std::size_t begin = text.rfind('\n', at) + 1;
    found.emplace_back(text.substr(begin, text.find('\n', at) - begin));
  }
  return found;
}

// Whether a switch over a mode has a default: no compiler says then that an enumerator is missing.
bool has_default(std::string_view text) {
  for (std::size_t at = text.find("switch ("); at != std::string_view::npos;
       at = text.find("switch (", at + 1)) {
    const std::size_t open = text.find('{', at);
    std::size_t close = open;
    for (int depth = 0; close < text.size(); ++close) {
      depth += text[close] == '{' ? 1 : text[close] == '}' ? -1 : 0;
      if (depth == 0) break;
    }
    const std::string_view body = text.substr(open, close - open);
    const bool over_a_mode = std::ranges::any_of(modes(), [&](const std::string& mode) {
      return body.find("case " + mode) != std::string_view::npos;
    });
    if (over_a_mode && body.find("default:") != std::string_view::npos) return true;
  }
  return false;
}

TEST(Modes, NoSourceComparesAModeWithAnEnumerator) {
  std::size_t files = 0;
  for (const std::string_view folder : folders) {
    const std::filesystem::path root = std::filesystem::path(source_path()) / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      ++files;
      const std::string text = read_file(entry.path().string());
      for (const std::string& line : comparisons_in(text)) ADD_FAILURE() << entry.path() << ": " << line;
      EXPECT_FALSE(has_default(text)) << entry.path();
    }
  }
  EXPECT_GT(files, 200U);
  EXPECT_GT(modes().size(), 11U);
}

TEST(Modes, AComparisonIsFound) {
  EXPECT_EQ(comparisons_in("if (c.fog == FogMode::none) {\n  a != Perspective::affine\n").size(), 2U);
  EXPECT_EQ(comparisons_in("FogMode::none == c.fog").size(), 1U);
  EXPECT_TRUE(comparisons_in("case FogMode::none:\n  c.fog = FogMode::linear;").empty());
  EXPECT_TRUE(has_default("switch (fog) {\n case FogMode::none: {\n } default: {}\n }"));
  EXPECT_FALSE(has_default("switch (fog) {\n case FogMode::none: break;\n } switch (x) { default: }"));
}

}  // namespace
}  // namespace bitspan
