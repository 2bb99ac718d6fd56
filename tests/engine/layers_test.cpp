// SPDX-License-Identifier: Apache-2.0
// A folder includes only from folders of layers below its own, and from itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

struct Folder {
  std::string_view name;
  int layer;
};

// Folders of one layer do not include each other.
constexpr std::array<Folder, 14> folders{{{"config", 0},
                                          {"io", 1},
                                          {"scene", 2},
                                          {"engine", 3},
                                          {"model", 4},
                                          {"golden", 4},
                                          {"report", 5},
                                          {"tb", 5},
                                          {"study", 6},
                                          {"lib", 7},
                                          {"cli", 8},
                                          {"python", 8},
                                          {"bench", 9},
                                          {"tests", 10}}};

// -1: no folder of ours.
int layer_of(std::string_view name) {
  const auto* const at = std::ranges::find(folders, name, &Folder::name);
  return at == folders.end() ? -1 : at->layer;
}

bool may_include(std::string_view from, std::string_view what) {
  return from == what || layer_of(what) < layer_of(from);
}

// What the lines of a file include by the name of a folder.
std::vector<std::string> included_folders(std::istream& text) {
  constexpr std::string_view start = "#include \"";
  std::vector<std::string> out;
  for (std::string line; std::getline(text, line);) {
    const auto slash = line.find('/');
    if (line.starts_with(start) && slash != std::string::npos) {
      out.push_back(line.substr(start.size(), slash - start.size()));
    }
  }
  return out;
}

TEST(Layers, TheRuleItself) {
  EXPECT_TRUE(may_include("model", "engine"));
  EXPECT_TRUE(may_include("tb", "model"));
  EXPECT_FALSE(may_include("model", "golden"));
  EXPECT_FALSE(may_include("golden", "model"));
  EXPECT_FALSE(may_include("tb", "report"));
  EXPECT_FALSE(may_include("report", "tb"));
  EXPECT_FALSE(may_include("config", "scene"));
  std::istringstream text("#include <map>\n#include \"model/simd/spans.hpp\"\n#include \"x.hpp\"\n");
  EXPECT_EQ(included_folders(text), std::vector<std::string>{"model"});
}

TEST(Layers, NoFolderIncludesAgainstTheOrder) {
  std::size_t includes = 0;
  for (const Folder& folder : folders) {
    const fs::path root = fs::path(source_path()) / folder.name;
    if (!fs::exists(root)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".h" && extension != ".in") continue;
      std::ifstream text(entry.path());
      for (const std::string& included : included_folders(text)) {
        if (!fs::exists(fs::path(source_path()) / included)) continue;  // a library's
        ++includes;
        ASSERT_GE(layer_of(included), 0)
            << entry.path() << " includes " << included << ", which has no layer";
        EXPECT_TRUE(may_include(folder.name, included)) << entry.path() << " includes " << included;
      }
    }
  }
  EXPECT_GT(includes, 500U);
}

// Who makes engines by name includes none of their headers; the command that is about one engine may.
TEST(Layers, StudyMakesItsEnginesByName) {
  constexpr std::array<std::string_view, 4> engines{"golden/engine_golden.hpp", "golden/ideal.hpp",
                                                    "tb/engine_rtl.hpp", "model/timed/engine_systemc.hpp"};
  for (const std::string_view folder : {"study", "lib"}) {
    const fs::path root = fs::path(source_path()) / folder;
    if (!fs::exists(root)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream text(entry.path());
      for (std::string line; std::getline(text, line);) {
        for (const std::string_view engine : engines) {
          EXPECT_EQ(line.find("#include \"" + std::string(engine)), std::string::npos) << entry.path();
        }
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
