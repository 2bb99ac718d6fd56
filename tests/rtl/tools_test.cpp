// SPDX-License-Identifier: Apache-2.0
// The same RTL read by all three tools, over shipped and random configurations: Verilator's lint is silent,
// Icarus computes the same values, Yosys reads and checks the design.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

#include "engine/emit_sv.hpp"
#include "io/data_folder.hpp"
#include "tests/rtl/icarus_case.hpp"
#include "tests/rtl/interpolator_case.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Config depth16(Perspective mode) {
  Config c = shipped_config("depth16");
  c.perspective = mode;
  return c;
}

std::vector<Config> configs(std::uint64_t seed, int random_ones) {
  std::vector<Config> all;
  for (const Perspective mode : all_perspectives) all.push_back(depth16(mode));
  Random random(seed);
  for (int i = 0; i < random_ones; ++i) all.push_back(random_rtl_config(random));
  return all;
}

TEST(Tools, VerilatorLintIsSilent) {
  for (const Config& c : configs(100, 20)) {
    const TemporaryFolder folder;
    std::vector<std::string> command = {"verilator",    "--lint-only",      "-Wall",
                                        "--assert",     "--max-num-width",  "1048576",
                                        "--top-module", "span_interpolator"};
    command.push_back(folder.write("bitspan_cfg_pkg.sv", emit_sv(c)));
    for (const auto& source : rtl_sources()) command.push_back(source.string());
    const auto log = folder.path("lint.log");
    EXPECT_EQ(run_program(command, log, "this test"), 0) << to_toml(c);
    EXPECT_EQ(read_file(log), "") << to_toml(c);
    if (HasFailure()) return;
  }
}

// A shipped configuration and a random one, for each mode on its own: together they take minutes.
class ToolsIn : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ToolsIn, IcarusAgrees) {
  Random random(5 + GetParam());
  const std::vector<Config> all = configs(200, static_cast<int>(all_perspectives.size()));
  for (const std::size_t i : {GetParam(), GetParam() + all_perspectives.size()}) {
    const Config& c = all[i];
    const InterpolatorCase given = make_interpolator_case(random, c, 150, 10);
    const TemporaryFolder folder;
    const IcarusRun run = prepare_icarus(folder, c, given);
    const std::string printed = run_icarus(run.sources, "icarus_tb", run.arguments);
    EXPECT_NE(printed.find(run.expected), std::string::npos) << printed << to_toml(c);
  }
}

INSTANTIATE_TEST_SUITE_P(Perspectives, ToolsIn, ::testing::Range(std::size_t{0}, all_perspectives.size()));

// What Yosys understood, written back as a netlist, computes the same values too.
TEST(Tools, YosysNetlistAgrees) {
  Random random(8);
  for (const Config& c : configs(400, 1)) {  // Icarus simulates some thousand gates' processes per clock
    const InterpolatorCase given = make_interpolator_case(random, c, 12, 6);
    const TemporaryFolder folder;
    IcarusRun run = prepare_icarus(folder, c, given);
    const std::string netlist = folder.path("netlist.v");
    std::string script = "read_verilog -sv -DSYNTHESIS " + run.sources.front().string();
    for (const auto& source : rtl_sources()) script += fmt::format(" {}", source.string());
    script += "; prep -flatten -top span_interpolator; memory_map; write_verilog -noattr " + netlist;
    const auto log = folder.path("yosys.log");
    ASSERT_EQ(run_program({"yosys", "-q", "-p", script}, log, "this test"), 0)
        << read_file(log) << to_toml(c);
    run.sources = {run.sources.front(), netlist, run.sources.back()};
    const std::string printed = run_icarus(run.sources, "icarus_tb", run.arguments);
    EXPECT_NE(printed.find(run.expected), std::string::npos) << printed << to_toml(c);
  }
}

TEST(Tools, IcarusSeesADifference) {
  Random random(6);
  const Config c = depth16(Perspective::delta_f);
  InterpolatorCase given = make_interpolator_case(random, c, 20, 10);
  given.pixels[given.pixels.size() / 2].fragment.v ^= 1;
  const TemporaryFolder folder;
  const IcarusRun run = prepare_icarus(folder, c, given);
  EXPECT_THROW(run_icarus(run.sources, "icarus_tb", run.arguments), std::runtime_error);
}

TEST(Tools, YosysReadsAndChecks) {
  std::size_t number = 0;
  for (const Config& c : configs(300, 6)) {
    if (!in_gate(number++, 2)) continue;
    const TemporaryFolder folder;
    const std::string package = folder.write("bitspan_cfg_pkg.sv", emit_sv(c));
    const auto log = folder.path("yosys.log");
    const std::string script = (data_folder() / "tb/yosys_cells.sh").string();
    EXPECT_EQ(run_program({"sh", script, package, "check"}, log, "this test"), 0)
        << read_file(log) << to_toml(c);
  }
}

// "58,312" in the last column of the README's row of `narrow`.
std::string cells_in_readme() {
  std::istringstream in(read_file(source_path("README.md")));
  for (std::string row; std::getline(in, row);) {
    if (!row.starts_with("| `narrow` |")) continue;
    std::string cells;
    for (std::size_t i = row.rfind('|', row.size() - 2); i < row.size(); ++i) {
      if (row[i] >= '0' && row[i] <= '9') cells += row[i];
    }
    return cells;
  }
  return "no row";
}

TEST(Tools, TheReadmeHasTheCellsOfThisRtl) {
  const TemporaryFolder folder;
  const std::string package = folder.write("bitspan_cfg_pkg.sv", emit_sv(shipped_config("narrow")));
  const auto log = folder.path("yosys.log");
  ASSERT_EQ(run_program({"sh", (data_folder() / "tb/yosys_cells.sh").string(), package}, log, "this test"),
            0);
  const std::string text = read_file(log);
  const std::string label = "Number of cells:";
  ASSERT_NE(text.find(label), std::string::npos) << text;
  EXPECT_EQ(std::to_string(std::stol(text.substr(text.find(label) + label.size()))), cells_in_readme());
}

TEST(Tools, YosysScriptRefuses) {
  const TemporaryFolder folder;
  const std::string script = (data_folder() / "tb/yosys_cells.sh").string();
  const auto log = folder.path("yosys.log");
  EXPECT_EQ(run_program({"sh", script, folder.path("none.sv"), "check"}, log, "this test"), 2);
  const std::string broken = folder.write("broken.sv", "package bitspan_cfg_pkg;\nendpackage\n");
  EXPECT_NE(run_program({"sh", script, broken, "check"}, log, "this test"), 0);
}

}  // namespace
}  // namespace bitspan
