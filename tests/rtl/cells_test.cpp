// SPDX-License-Identifier: Apache-2.0
// The interpolator's arithmetic cells, each alone: tests/rtl/cells_bench.sv under Verilator and Icarus, and
// with bugs planted in each cell.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

constexpr const char* cells[] = {"delay_line", "mul_pipe", "lzc", "lzc_norm", "shift_add"};

std::string source(const std::string& name) { return fmt::format("{}/rtl/{}.sv", BITSPAN_SOURCE_DIR, name); }
std::string bench() { return std::string(BITSPAN_SOURCE_DIR) + "/tests/rtl/cells_bench.sv"; }

TEST(Cells, AgreeWithTheLanguagesOwnOperators) {
  std::vector<std::filesystem::path> sources{bench()};
  for (const char* cell : cells) sources.emplace_back(source(cell));
  const std::string fast = run_verilator(sources, "cells_bench");
  EXPECT_NE(fast.find("checked 135871, errors 0"), std::string::npos) << fast;
  const std::string slow = run_icarus(sources, "cells_bench", {"+seed=7", "+operands=300"});
  EXPECT_NE(slow.find("checked 10071, errors 0"), std::string::npos) << slow;
}

struct Bug {
  const char *cell, *from, *to;
};

TEST(Cells, PlantedBugsAreSeen) {
  const Bug bugs[] = {
      {"mul_pipe", "<<< (Limb * (i + j))", "<<< (Limb * (i + j) + (i == 2 ? 1 : 0))"},
      {"mul_pipe", "(ASigned != 0 && k == TopW - 1) ? sum - (b <<< k)",
       "(ASigned != 0 && k == TopW - 1) ? sum + (b <<< k)"},
      {"mul_pipe", "(BSigned != 0 && k == TopW - 1) ? sum - (a <<< k)",
       "(BSigned != 0 && k == TopW) ? sum - (a <<< k)"},
      {"mul_pipe", "(i == ALimbs - 1 && ALowSigned != 0) & a_i", "(i == ALimbs - 1) & a_i"},
      {"lzc", "count[2*n+1] | Levels'(1 << (level - 1))", "count[2*n+1]"},
      {"lzc_norm", "coarse = (zeros_1 >> FineW) << FineW", "coarse = (zeros_1 >> FineW) << (FineW - 1)"},
      {"shift_add", "sticky_q <= coarse_sticky_q | (|fine[BelowW-1:0])", "sticky_q <= |fine[BelowW-1:0]"},
      {"shift_add", "far_q <= above_q | (|top)", "far_q <= |top"},
      {"shift_add", "if (ShiftW'(i) < fine_q && i < FineMax) top[i] = 1'b0;",
       "if (ShiftW'(i) <= fine_q && i < FineMax) top[i] = 1'b0;"},
      {"shift_add", "sign_o <= far_q ? sign_q : sum[KeptW-1]", "sign_o <= sum[KeptW-1]"},
      {"shift_add", "i >= CoarseW + (k << FineW)", "i > CoarseW + (k << FineW)"},
  };
  for (const Bug& bug : bugs) {
    const TemporaryFolder folder;
    std::vector<std::filesystem::path> sources{bench()};
    for (const std::string cell : cells) {
      std::string text = read_file(source(cell));
      if (cell == bug.cell) {
        const std::size_t at = text.find(bug.from);
        ASSERT_NE(at, std::string::npos) << bug.from;
        text.replace(at, std::string(bug.from).size(), bug.to);
      }
      sources.emplace_back(folder.write(cell + ".sv", text));
    }
    const std::string printed = run_icarus(sources, "cells_bench", {"+operands=400"});
    EXPECT_NE(printed.find("errors"), std::string::npos) << printed;
    EXPECT_EQ(printed.find("errors 0\n"), std::string::npos) << bug.cell << ": " << bug.to;
  }
}

}  // namespace
}  // namespace bitspan
