// SPDX-License-Identifier: Apache-2.0
// The tables of docs/c_api.md against the library. BITSPAN_UPDATE_DOCS=1 writes the stages again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/records.hpp"
#include "lib/stages.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

const std::string page = source_path("docs/c_api.md");

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string per(const StageRow& row) {
  constexpr std::array<std::string_view, 6> names{"scene", "change of state", "triangle", "edge", "row",
                                                  "pixel"};
  return std::string(names.at(static_cast<std::size_t>(row.per))) + (row.per_channel() ? " and channel" : "");
}

TEST(LibDocs, StagesAreTheLibrarys) {
  const std::string head = "| number | name | fields | one record per |\n|---|---|---|---|\n";
  std::string table = head;
  for (bs_stage stage = 0; bs_stage_name(stage) != nullptr; ++stage) {
    const StageRow& row = row_of(capi::stage_types[static_cast<std::size_t>(stage)]);
    table += "| " + std::to_string(stage) + " | `" + bs_stage_name(stage) + "` | " +
             std::to_string(fields_of(row.type).size()) + " | " + per(row) + " |\n";
  }
  std::string text = text_of(page);
  const std::size_t begin = text.find(head);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = text.find("\n\n", begin) + 1;
  if (std::getenv("BITSPAN_UPDATE_DOCS") != nullptr) {
    text.replace(begin, end - begin, table);
    std::ofstream(page) << text;
  } else {
    EXPECT_EQ(text.substr(begin, end - begin), table);
  }
}

TEST(LibDocs, TheProgramIsTheExample) {
  std::string program = text_of(source_path("examples/c/bench.c"));
  ASSERT_TRUE(program.starts_with("// SPDX"));
  program.erase(0, program.find('\n') + 1);
  EXPECT_NE(text_of(page).find("```c\n" + program + "```\n"), std::string::npos);
}

TEST(LibDocs, EveryEngineIsTold) {
  const std::string text = text_of(page);
  for (int i = 0; bs_engine_name(i) != nullptr; ++i) {
    EXPECT_NE(text.find("| `" + std::string(bs_engine_name(i)) + "` | "), std::string::npos)
        << bs_engine_name(i);
  }
}

}  // namespace
}  // namespace bitspan
