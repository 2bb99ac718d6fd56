// SPDX-License-Identifier: Apache-2.0
// The SystemC side: many kernels in one process, errors out of a clock, the waveform's file.
#include "model/timed/kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tests/support/files.hpp"

namespace bitspan::timed {
namespace {

struct Counting : Clocked {
  std::vector<std::uint64_t> seen;
  StageSignals signals;
  std::uint64_t throws_at = ~std::uint64_t{0};
  void clock(std::uint64_t now) override {
    if (now == throws_at) throw std::runtime_error("as planned");
    seen.push_back(now);
    signals.occupancy = static_cast<unsigned>(now);
  }
};

void run_clocks(Kernel& kernel, std::uint64_t n) {
  const std::uint64_t end = kernel.cycles() + n;
  kernel.run([&] { return kernel.cycles() >= end; });
}

TEST(Kernel, ManyOneAfterAnotherAndTakingTurns) {
  for (int i = 0; i < 100; ++i) {
    Counting a;
    Kernel kernel({{"a", &a, {}}}, "");
    run_clocks(kernel, 5);
    run_clocks(kernel, 2);
    ASSERT_EQ(a.seen, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6}));
  }
  Counting a;
  Counting b;
  auto first = std::make_unique<Kernel>(std::vector<KernelPart>{{"same", &a, {}}}, "");
  Kernel second({{"same", &b, {}}}, "");
  run_clocks(*first, 3);
  run_clocks(second, 10);
  run_clocks(*first, 3);
  EXPECT_EQ(a.seen.size(), 6U);
  first.reset();
  run_clocks(second, 1);
  EXPECT_EQ(b.seen.size(), 11U);
  EXPECT_EQ(b.seen.back(), 10U);
}

TEST(Kernel, AnErrorInAClockComesOutOfRunAndLeavesNoWaveform) {
  const TemporaryFolder folder;
  Counting a;
  a.throws_at = 4;
  {
    Kernel kernel({{"a", &a, {{"", &a.signals}}}}, folder.path("run.vcd"));
    EXPECT_THROW(run_clocks(kernel, 100), std::runtime_error);
  }
  EXPECT_EQ(a.seen.size(), 4U);
  EXPECT_EQ(folder.files(), 0);
}

TEST(Kernel, TheWaveformAppearsComplete) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.vcd");
  Counting a;
  {
    Kernel kernel({{"a", &a, {{"", &a.signals}, {"inner", &a.signals}}}}, path);
    run_clocks(kernel, 20);
    EXPECT_FALSE(std::filesystem::exists(path));
    kernel.close_vcd();
    EXPECT_TRUE(std::filesystem::exists(path));
    run_clocks(kernel, 1);  // untraced
  }
  EXPECT_EQ(folder.files(), 1);
  const std::string vcd = read_file(path);
  for (const char* name : {"clk", "in_valid", "in_ready", "out_valid", "out_ready", "occupancy", "state"}) {
    EXPECT_NE(vcd.find(std::string("  ") + name), std::string::npos) << name;
  }
  EXPECT_NE(vcd.find("$scope module inner"), std::string::npos);
  EXPECT_NE(vcd.find("b10011 "), std::string::npos);  // occupancy of the last clock, 19
  EXPECT_NE(vcd.find("#19000"), std::string::npos);
}

TEST(Kernel, AWaveformThatCannotBeWrittenIsAnInputError) {
  Counting a;
  const TemporaryFolder folder;
  EXPECT_THROW(Kernel({{"a", &a, {}}}, folder.path("missing/run.vcd")), InputError);
}

TEST(Kernel, NoClocksNoWaveform) {
  const TemporaryFolder folder;
  Counting a;
  { Kernel kernel({{"a", &a, {{"", &a.signals}}}}, folder.path("run.vcd")); }
  EXPECT_EQ(folder.files(), 0);
}

}  // namespace
}  // namespace bitspan::timed
