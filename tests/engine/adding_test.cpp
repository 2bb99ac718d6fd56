// SPDX-License-Identifier: Apache-2.0
// docs/adding.md lists files that exist, no more of them than it promises, and all in which its examples
// stand.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/config/support.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

struct Addition {
  std::string name;
  int at_most = 0;
  std::string example;  // empty: none is named
  std::vector<std::string> files;
};

std::vector<Addition> additions() {
  const std::regex heading("## (.+)");
  const std::regex limit("At most ([0-9]+) files.*");
  const std::regex example(R"re(.*Example: `([^`]+)`.*)re");
  const std::regex row(R"re(\| `([^`]+)` \| .+ \|)re");
  std::vector<Addition> out;
  for (const std::string& line : lines_of(read_file(BITSPAN_SOURCE_DIR "/docs/adding.md"))) {
    std::smatch m;
    if (std::regex_match(line, m, heading)) out.push_back({m[1], 0, "", {}});
    if (out.empty()) continue;
    if (std::regex_match(line, m, limit)) out.back().at_most = std::stoi(m[1]);
    if (std::regex_match(line, m, example)) out.back().example = m[1];
    if (std::regex_match(line, m, row)) out.back().files.push_back(m[1]);
  }
  return out;
}

// Sources and documents without tests, and without what only tells of results: the changelog, areas, studies.
std::vector<std::string> sources() {
  const std::set<std::string> folders{"bench",   "cli",   "config", "docs",  "engine", "golden",
                                      "include", "io",    "lib",    "model", "python", "report",
                                      "rtl",     "scene", "study",  "tb"};
  const std::set<std::string> kinds{".cpp", ".h", ".hpp", ".sv", ".md", ".py", ".js"};
  std::vector<std::string> out{"README.md"};
  const fs::path root(BITSPAN_SOURCE_DIR);
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = fs::relative(entry.path(), root).generic_string();
      if (!kinds.contains(entry.path().extension().string()) || path == "docs/adding.md" ||
          path == "docs/area.md" || path.starts_with("docs/studies/")) {
        continue;
      }
      out.push_back(path);
    }
  }
  return out;
}

// The additions and limits that the project has promised.
TEST(Adding, KeepsItsPromises) {
  std::map<std::string, int> limits;
  for (const Addition& a : additions()) {
    limits[a.name] = a.at_most;
    EXPECT_LE(a.files.size(), static_cast<std::size_t>(a.at_most)) << a.name;
    EXPECT_FALSE(a.files.empty()) << a.name;
    const std::set<std::string> distinct(a.files.begin(), a.files.end());
    EXPECT_EQ(distinct.size(), a.files.size()) << a.name << ": a file is listed twice";
    for (const std::string& file : a.files) {
      EXPECT_TRUE(fs::is_regular_file(fs::path(BITSPAN_SOURCE_DIR) / file)) << a.name << ": " << file;
    }
  }
  const std::map<std::string, int> promised{{"A configuration key", 4},
                                            {"An option on one register that one stage reads", 12},
                                            {"A stage between depth and merge", 33},
                                            {"A texture filter", 25},
                                            {"A texel format", 9},
                                            {"A kind of reciprocal", 16},
                                            {"A depth comparison", 12},
                                            {"A register of the draw state", 14},
                                            {"A command", 12},
                                            {"A pass plan", 5},
                                            {"A metric of the picture", 3},
                                            {"An oracle", 3},
                                            {"A metric per field", 6}};
  EXPECT_EQ(limits, promised);
}

TEST(Adding, ExamplesStandInTheListedFilesAndInNoOther) {
  const std::vector<std::string> all = sources();
  EXPECT_GT(all.size(), 250U);
  int examples = 0;
  for (const Addition& a : additions()) {
    if (a.example.empty()) continue;
    ++examples;
    const std::set<std::string> listed(a.files.begin(), a.files.end());
    for (const std::string& path : all) {
      const bool found =
          read_file(std::string(BITSPAN_SOURCE_DIR "/") + path).find(a.example) != std::string::npos;
      EXPECT_TRUE(!found || listed.contains(path)) << a.name << ": " << a.example << " stands in " << path;
    }
  }
  EXPECT_GE(examples, 3);
}

}  // namespace
}  // namespace bitspan
