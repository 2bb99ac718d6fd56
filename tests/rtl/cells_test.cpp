// SPDX-License-Identifier: Apache-2.0
// The interpolator's arithmetic cells, each alone: tests/rtl/cells_bench.sv under Verilator and Icarus, and
// with bugs planted in each cell.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/data_folder.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

// The bench and the cells, those of a copy of the RTL while there is one.
std::vector<std::filesystem::path> sources() {
  std::vector<std::filesystem::path> all{source_path("tests/rtl/cells_bench.sv")};
  for (const char* cell : {"delay_line", "mul_pipe", "lzc", "lzc_norm", "shift_add"}) {
    all.push_back(data_folder() / fmt::format("rtl/{}.sv", cell));
  }
  return all;
}

TEST(Cells, AgreeWithTheLanguagesOwnOperators) {
  const std::string fast = run_verilator(sources(), "cells_bench");
  EXPECT_NE(fast.find("checked 147856, errors 0"), std::string::npos) << fast;
  const std::string slow = run_icarus(sources(), "cells_bench", {"+seed=7", "+operands=300"});
  EXPECT_NE(slow.find("checked 10956, errors 0"), std::string::npos) << slow;
}

TEST(Cells, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/mul_pipe.sv", "<<< (Limb * (i + j))", "<<< (Limb * (i + j) + (i == 2 ? 1 : 0))"},
      {"rtl/mul_pipe.sv", "(ASigned != 0 && k == TopW - 1 && k < 2) first = first - (b <<< k)",
       "(ASigned != 0 && k == TopW - 1 && k < 2) first = first + (b <<< k)"},
      {"rtl/mul_pipe.sv", "(BSigned != 0 && k == TopW - 1) rest = rest - (a <<< k)",
       "(BSigned != 0 && k == TopW) rest = rest - (a <<< k)"},
      {"rtl/mul_pipe.sv", "rest = rest | ((a <<< k)", "rest = rest | ((a <<< (k + 1))"},
      {"rtl/mul_pipe.sv", ".Depth(Clocks > 5 ? Clocks - 5 : 0)", ".Depth(Clocks > 5 ? Clocks - 4 : 0)"},
      {"rtl/mul_pipe.sv", "PartWait = Clocks > 4 ? 1 : 0;", "PartWait = 0;"},
      {"rtl/mul_pipe.sv", "(i == ALimbs - 1 && ALowSigned != 0) & limb_a", "(i == ALimbs - 1) & limb_a"},
      {"rtl/lzc.sv", "count[2*n+1] | Levels'(1 << (level - 1))", "count[2*n+1]"},
      {"rtl/lzc_norm.sv", "coarse = (zeros_1 >> FineW) << FineW",
       "coarse = (zeros_1 >> FineW) << (FineW - 1)"},
      {"rtl/shift_add.sv", "sticky_q <= coarse_sticky_q | (|fine[BelowW-1:0])",
       "sticky_q <= |fine[BelowW-1:0]"},
      {"rtl/shift_add.sv", "far_q <= above_q | (|top)", "far_q <= |top"},
      {"rtl/shift_add.sv", "if (ShiftW'(i) < fine_q && i < FineMax) top[i] = 1'b0;",
       "if (ShiftW'(i) <= fine_q && i < FineMax) top[i] = 1'b0;"},
      {"rtl/shift_add.sv", "sign_o <= far_q ? sign_q : sum[KeptW-1]", "sign_o <= sum[KeptW-1]"},
      {"rtl/shift_add.sv", "i >= CoarseW + (k << FineW)", "i > CoarseW + (k << FineW)"},
  };
  expect_seen(bugs, [] {
    const std::string printed = run_icarus(sources(), "cells_bench", {"+operands=400"});
    EXPECT_NE(printed.find("errors"), std::string::npos) << printed;
    if (printed.find("errors 0\n") == std::string::npos) throw std::logic_error(printed);
  });
}

}  // namespace
}  // namespace bitspan
