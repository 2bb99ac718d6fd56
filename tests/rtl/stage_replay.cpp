// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/stage_replay.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "engine/sv_names.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_build.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

// The output whose value 1 makes an output count; its own place where it counts always.
std::size_t valid_of(const StageDesign& design, const RtlModuleDesign& module, std::size_t output) {
  for (const StageChannel& c : design.channels) {
    if (c.kind == ChannelKind::in) continue;
    const auto valid = static_cast<std::size_t>(std::ranges::find(module.outputs, c.name + "_valid_o") -
                                                module.outputs.begin());
    if (output > valid && output <= valid + c.fields.size()) return valid;
  }
  return output;
}

std::string hex_lines(const std::vector<std::vector<std::uint64_t>>& clocks) {
  std::string text;
  for (const auto& ports : clocks) {
    for (const std::uint64_t value : ports) text += fmt::format("{:x} ", value);
    text += '\n';
  }
  return text;
}

// An output is narrower than the 64 bits that are looked at; what Icarus has above it is z. wN has a 1 for
// each bit of output N. Comparing words keeps the bench fast.
std::string bench(const StageDesign& design, const RtlModuleDesign& m, const StageTrace& trace,
                  const std::string& inputs, const std::string& outputs) {
  const std::size_t clocks = trace.inputs.size();
  std::string text = fmt::format(
      "module bench;\n  reg clk = 0, rst_n = 1;\n  reg [63:0] in [0:{}];\n  reg [63:0] want [0:{}];\n",
      clocks * m.inputs.size() - 1, clocks * m.outputs.size() - 1);
  std::string ports = ".clk_i(clk), .rst_ni(rst_n)";
  std::string drive;
  std::string clear;
  std::string widths;
  std::string check;
  for (std::size_t i = 0; i < m.inputs.size(); ++i) {
    text += fmt::format("  reg [63:0] i{};\n", i);
    ports += fmt::format(", .{}(i{})", m.inputs[i], i);
    clear += fmt::format("    i{} = 0;\n", i);
    drive += fmt::format("      i{} = in[c * {} + {}];\n", i, m.inputs.size(), i);
  }
  for (std::size_t o = 0; o < m.outputs.size(); ++o) {
    text += fmt::format("  wire [63:0] o{0};\n  reg [63:0] w{0};\n", o);
    ports += fmt::format(", .{}(o{})", m.outputs[o], o);
    widths += fmt::format(
        "    for (b = 0; b < 64; b = b + 1) w{0}[b] = o{0}[b] !== 1'bz;\n"
        "    if ((w{0} & (w{0} + 1)) != 0 || !w{0}[0]) $fatal(1, \"{1} has an open bit\");\n",
        o, m.outputs[o]);
    check += fmt::format(
        "      if (want[c * {0} + {1}] === 1 || {1} == {2}) begin\n"
        "        compared = compared + 1;\n"
        "        if ((o{2} & w{2}) !== want[c * {0} + {2}]) begin\n"
        "          $display(\"clock %0d: {3} is %h, expected %h\", c, o{2}, want[c * {0} + {2}]);\n"
        "          $fatal(1, \"a difference\");\n        end\n      end\n",
        m.outputs.size(), valid_of(design, m, o), o, m.outputs[o]);
  }
  text += fmt::format("  {} dut ({});\n  integer c, b, compared;\n  initial begin\n", m.top, ports);
  text += fmt::format("    $readmemh(\"{}\", in);\n    $readmemh(\"{}\", want);\n    compared = 0;\n", inputs,
                      outputs);
  text += clear;
  text += "    #1 rst_n = 0; #1 clk = 1; #1 clk = 0; #1 clk = 1; #1 clk = 0; #1 rst_n = 1; #1;\n";
  text += widths;
  text += fmt::format(
      "    for (c = 0; c < {}; c = c + 1) begin\n{}      #1;\n{}      clk = 1; #1 clk = 0; #1;\n"
      "    end\n    $display(\"compared %0d\", compared);\n    $finish;\n  end\nendmodule\n",
      clocks, drive, check);
  return text;
}

}  // namespace

std::size_t replay_under_icarus(const StageDesign& design, const StageTrace& trace,
                                const std::vector<std::filesystem::path>& sources, bool with_package) {
  const TemporaryFolder folder;
  const std::string inputs = folder.write("inputs", hex_lines(trace.inputs));
  const std::string outputs = folder.write("outputs", hex_lines(trace.outputs));
  std::vector<std::filesystem::path> all;
  if (with_package) all.emplace_back(folder.write("package.sv", design.package));
  all.insert(all.end(), sources.begin(), sources.end());
  all.emplace_back(folder.write("bench.sv", bench(design, module_of(design), trace, inputs, outputs)));
  const std::string printed = run_icarus(all, "bench");
  const std::size_t at = printed.find("compared ");
  if (at == std::string::npos) throw std::runtime_error("the bench came to no end\n" + printed);
  return std::stoull(printed.substr(at + 9));
}

void expect_tools_agree(const StageDesign& design, StageTrace& trace) {
  const TemporaryFolder folder;
  // Verilator wants a file named after its package.
  const std::string package =
      folder.write(*declared_names(design.package).packages.begin() + ".sv", design.package);
  const auto log = folder.path("log");
  std::vector<std::string> lint = {"verilator", "--lint-only",  "-Wall",    "--assert", "--max-num-width",
                                   "1048576",   "--top-module", design.top, package};
  std::string script = "read_verilog -sv -DSYNTHESIS " + package;
  for (const auto& source : design.sources) {
    lint.push_back(source.string());
    script += fmt::format(" {}", source.string());
  }
  EXPECT_EQ(run_program(lint, log, "this test"), 0) << design.name;
  EXPECT_EQ(read_file(log), "") << design.name;

  const std::size_t compared = replay_under_icarus(design, trace, design.sources, true);
  EXPECT_GT(compared, trace.outputs.size());
  const std::string netlist = folder.path("netlist.v");
  script += fmt::format(
      "; hierarchy -check -top {0}; prep -flatten -top {0}; check -assert; memory_map; write_verilog -noattr "
      "{1}",
      design.top, netlist);
  ASSERT_EQ(run_program({"yosys", "-q", "-p", script}, log, "this test"), 0) << read_file(log);
  EXPECT_EQ(replay_under_icarus(design, trace, {netlist}, false), compared);
  // The replay can fail.
  trace.outputs[5].front() ^= 1;
  EXPECT_THROW(replay_under_icarus(design, trace, {netlist}, false), std::runtime_error);
}

}  // namespace bitspan
