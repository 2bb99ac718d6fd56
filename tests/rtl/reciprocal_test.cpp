// SPDX-License-Identifier: Apache-2.0
// rtl/reciprocal.sv: each kind, normalised or not, pipelined or not, over every operand of a small grid,
// against exact rational numbers. The divider's test is the interpolator's with slope form `divide`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "tb/rtl_build.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/reference.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"
#include "tests/support/reciprocal_definition.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr int operand_bits = 9;

// Configurations whose row operand, L on edge.x, is the small grid.
std::vector<Config> unit_configs() {
  std::vector<Config> configs;
  Random random(7);
  for (int kind = 0; kind < reciprocal_kinds; ++kind) {
    for (const bool normalize : {true, false}) {
      for (const bool pipelined : {true, false}) {
        Config c = shipped_config("depth16");
        c.perspective = Perspective::delta_f;
        c.row_slope = SlopeForm::reciprocal;
        const int fraction = static_cast<int>(random() % 6);
        c.format(FormatId::edge_x) = {operand_bits,  operand_bits - fraction, false,
                                      Rounding::trn, Overflow::sat,           false};
        Reciprocal& r = c.row_reciprocal;
        r.kind = static_cast<ReciprocalKind>(kind);
        r.normalize = normalize;
        r.pipelined = pipelined;
        const bool lut = has_table(r.kind);
        // Fewer operand bits than the operand has, and more; tables of 2 and of many entries.
        r.operand_bits = lut ? 5 + static_cast<int>(random() % 6) : 0;
        r.index_bits = lut ? 1 + static_cast<int>(random() % 4) : 0;
        r.table_bits = lut ? 4 + static_cast<int>(random() % 10) : 0;
        r.internal_bits = lut ? 5 + static_cast<int>(random() % 12) : 0;
        r.steps = has_newton_steps(r.kind) ? static_cast<int>(random() % 3) : 0;
        r.bits_per_cycle = lut ? 0 : 1 + static_cast<int>(random() % 4);
        const int out_fraction = 3 + static_cast<int>(random() % 12);
        r.output = {out_fraction + 2,
                    2,
                    false,
                    static_cast<Rounding>(random() % rounding_modes),
                    static_cast<Overflow>(random() % (overflow_modes - 1)),
                    false};
        c.rtl.product_clocks = 1 + static_cast<int>(random() % 4);
        c.rtl.normalise_clocks = 1 + static_cast<int>(random() % 3);
        configs.push_back(c);
      }
    }
  }
  return configs;
}

constexpr const char* parameters[] = {
    "Kind",         "Normalize", "OpW",          "OpFrac",    "OperandBits",  "IndexBits",    "TableBits",
    "InternalBits", "Steps",     "BitsPerCycle", "Pipelined", "Iterations",   "QuotientFrac", "OutW",
    "OutFrac",      "OutSigned", "OutRnd",       "OutOvf",    "TableEntries", "Table"};

std::string bench(const std::vector<Config>& configs) {
  std::string packages;
  std::string text = "module bench;\n  logic clk, rst_n, start;\n  logic [8:0] d;\n";
  std::string print;
  int longest = 0;
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const std::string package = fmt::format("unit{}_pkg", i);
    packages += std::regex_replace(emit_sv(configs[i]), std::regex("bitspan_cfg_pkg"), package);
    longest = std::max(longest, rtl_timing(configs[i]).row_unit);
    text += fmt::format("  logic [{}::RowRecipOutW-1:0] m{};\n  logic signed [7:0] e{};\n  reciprocal #(\n",
                        package, i, i);
    for (const char* name : parameters)
      text += fmt::format("      .{}({}::RowRecip{}),\n", name, package, name);
    text += fmt::format(
        "      .NormaliseClocks({0}::NormaliseClocks),\n      .ProductClocks({0}::ProductClocks),\n"
        "      .Clocks({0}::RowUnitClocks)\n  ) u_{1} (.clk_i(clk), .rst_ni(rst_n), .en_i(1'b1), "
        ".start_i(start), .d_i(d),"
        " .m_o(m{1}), .e_o(e{1}));\n",
        package, i);
    print += fmt::format("      $display(\"{} %0d %0d %0d\", d, m{}, e{});\n", i, i, i);
  }
  text += fmt::format(
      "  initial begin\n    clk = 0; start = 0; d = 0; rst_n = 1; #1 rst_n = 0; #1 rst_n = 1;\n"
      "    for (int i = 0; i < {}; i++) begin\n      d = i; start = 1;\n"
      "      for (int c = 0; c < {}; c++) begin\n        #1 clk = 1; #1 clk = 0; start = 0;\n      end\n{}   "
      " end\n"
      "  end\nendmodule\n",
      1 << operand_bits, longest, print);
  return packages + text;
}

TEST(Reciprocal, EveryKindOverEveryOperand) {
  const std::vector<Config> configs = unit_configs();
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> sources = {folder.write("bench.sv", bench(configs))};
  for (const auto& source : rtl_sources()) {
    const std::string name = source.stem().string();
    if (!name.starts_with("span")) sources.push_back(source);
  }
  for (const auto run :
       {+[](const std::vector<std::filesystem::path>& s) { return run_icarus(s, "bench"); },
        +[](const std::vector<std::filesystem::path>& s) { return run_verilator(s, "bench"); }}) {
    std::istringstream in(run(sources));
    std::size_t compared = 0;
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::size_t i = 0;
      std::int64_t d = 0;
      std::int64_t m = 0;
      int e = 0;
      if (!(words >> i >> d >> m >> e)) continue;
      const Format& x = configs[i].format(FormatId::edge_x);
      const auto expected = reference::reciprocal(
          reference::value(d, x), reference::power_of_two(-x.fraction()), configs[i].row_reciprocal);
      ASSERT_EQ(m, expected.m) << "unit " << i << ", d = " << d << "\n" << to_toml(configs[i]);
      ASSERT_EQ(e, expected.e) << "unit " << i << ", d = " << d << "\n" << to_toml(configs[i]);
      ++compared;
    }
    EXPECT_EQ(compared, configs.size() << operand_bits);
  }
}

}  // namespace
}  // namespace bitspan
