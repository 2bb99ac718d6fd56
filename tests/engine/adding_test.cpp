// SPDX-License-Identifier: Apache-2.0
// docs/adding.md lists files that exist, no more of them than it promises, and all in which its examples
// stand; the commits that it names as examples kept the limits, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/config/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

struct Addition {
  std::string name;
  std::size_t at_most = 0;
  std::string example;  // a name that stands in the files; empty: none is given
  std::string commit;   // the subject of one that added such a thing; empty: none is given
  std::vector<std::string> files;
};

// Limits are of code and documents.
std::size_t counted(const std::vector<std::string>& files) {
  const auto is_counted = [](const std::string& file) { return !file.starts_with("tests/"); };
  return static_cast<std::size_t>(std::ranges::count_if(files, is_counted));
}

std::vector<Addition> additions() {
  const std::regex heading("## (.+)");
  const std::regex limit("At most ([0-9]+) files.*");
  const std::regex example(R"re(.*Example: `([^`]+)`.*)re");
  const std::regex commit(R"re(.*commit "([^"]+)".*)re");
  const std::regex row(R"re(\| `([^`]+)` \| .+ \|)re");
  std::vector<Addition> out;
  for (const std::string& line : lines_of(read_file(source_path("docs/adding.md")))) {
    std::smatch m;
    if (std::regex_match(line, m, heading)) out.push_back({m[1], 0, "", "", {}});
    if (out.empty()) continue;
    if (std::regex_match(line, m, limit)) out.back().at_most = std::stoul(m[1]);
    if (std::regex_match(line, m, example)) out.back().example = m[1];
    if (std::regex_match(line, m, commit)) out.back().commit = m[1];
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
  const fs::path root(source_path());
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
  std::map<std::string, std::size_t> limits;
  for (const Addition& a : additions()) {
    limits[a.name] = a.at_most;
    EXPECT_LE(counted(a.files), a.at_most) << a.name;
    EXPECT_FALSE(a.files.empty()) << a.name;
    const std::set<std::string> distinct(a.files.begin(), a.files.end());
    EXPECT_EQ(distinct.size(), a.files.size()) << a.name << ": a file is listed twice";
    for (const std::string& file : a.files) {
      EXPECT_TRUE(fs::is_regular_file(fs::path(source_path()) / file)) << a.name << ": " << file;
    }
  }
  const std::map<std::string, std::size_t> promised{{"A configuration key", 4},
                                                    {"An option on one register that one stage reads", 11},
                                                    {"A stage between depth and merge", 30},
                                                    {"A channel", 10},
                                                    {"A texture filter", 25},
                                                    {"A wrap mode", 15},
                                                    {"A texel format", 7},
                                                    {"A kind of reciprocal", 14},
                                                    {"A depth comparison", 11},
                                                    {"A register of the draw state", 13},
                                                    {"A command", 12},
                                                    {"A pass plan", 5},
                                                    {"A metric of the picture", 2},
                                                    {"An oracle", 3},
                                                    {"A metric per field", 5}};
  EXPECT_EQ(limits, promised);
}

// What a command prints; nothing where it fails.
std::string output_of(const std::string& command) {
  std::string out;
  FILE* const pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return out;
  std::array<char, 4096> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) out.append(part.data(), n);
  return ::pclose(pipe) == 0 ? out : "";
}

const std::string git = "git -C '" + source_path() + "' ";

bool has_whole_history() {
  const std::vector<std::string> lines =
      lines_of(output_of(git + "rev-parse --show-toplevel --is-shallow-repository"));
  std::error_code ignored;
  return lines.size() == 2 && fs::equivalent(lines[0], source_path(), ignored) && lines[1] == "false";
}

// The files that each commit touched, by its subject; of several with one subject the newest.
std::map<std::string, std::vector<std::string>> history() {
  std::map<std::string, std::vector<std::string>> out;
  std::vector<std::string> older;
  std::vector<std::string>* files = &older;
  for (const std::string& line :
       lines_of(output_of(git + "log --no-merges --format='subject %s' --name-only"))) {
    if (line.starts_with("subject ")) {
      const auto [at, is_new] = out.try_emplace(line.substr(8));
      files = is_new ? &at->second : &older;
    } else if (!line.empty()) {
      files->push_back(line);
    }
  }
  return out;
}

// Sections of which the history has no commit that adds one such thing and nothing else. The first channel
// came with a mode of fog, mirror with border and its colour, and the texel format depth without its
// documents. No name is to be added: a section is written together with its first example.
const std::set<std::string> without_commit{"A configuration key",
                                           "An option on one register that one stage reads",
                                           "A stage between depth and merge",
                                           "A channel",
                                           "A texture filter",
                                           "A wrap mode",
                                           "A texel format",
                                           "A register of the draw state"};

TEST(Adding, CommitsOfExamplesKeepTheLimits) {
  if (!has_whole_history())
    GTEST_SKIP() << "no whole git history here: the commits that docs/adding.md names are not counted";
  const auto commits = history();
  for (const Addition& a : additions()) {
    EXPECT_EQ(a.commit.empty(), without_commit.contains(a.name))
        << a.name << ": commit \"" << a.commit << '"';
    if (a.commit.empty()) continue;
    const auto found = commits.find(a.commit);
    if (found == commits.end()) {
      ADD_FAILURE() << a.name << ": the history has no commit \"" << a.commit << '"';
      continue;
    }
    const std::vector<std::string>& files = found->second;
    EXPECT_LE(counted(files), a.at_most) << a.name << ": commit \"" << a.commit << '"';
    const auto is_listed = [&](const std::string& file) { return std::ranges::count(a.files, file) > 0; };
    EXPECT_GT(2 * std::ranges::count_if(files, is_listed), std::ssize(files))
        << a.name << ": most files of the commit \"" << a.commit << "\" are not in the list";
  }
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
      const bool found = read_file(source_path(path)).find(a.example) != std::string::npos;
      EXPECT_TRUE(!found || listed.contains(path)) << a.name << ": " << a.example << " stands in " << path;
    }
  }
  EXPECT_GE(examples, 3);
}

}  // namespace
}  // namespace bitspan
