// SPDX-License-Identifier: Apache-2.0
// rtl/reciprocal.sv: each kind, normalised or not, pipelined or not, over every operand of a small grid,
// against exact rational numbers. The divider's test is the interpolator's with slope form `divide`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
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
#include "tests/support/long_run.hpp"
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
        c.row_slope = RowSlope::reciprocal;
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
        c.rtl.setup_multipliers = 1 + static_cast<int>(random() % 4);
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

// Multipliers outside a unit: each reads its factors at its product's tick alone, as the row's do.
constexpr const char* outside = R"(
module outside #(
    parameter int Places = 1, AW = 1, BW = 1, Clocks = 1,
    parameter logic [16*Places-1:0] Ticks = '0
) (
    input logic clk_i,
    input int tick_i,
    input logic [Places*AW-1:0] a_i,
    input logic [Places*BW-1:0] b_i,
    output logic [Places*(AW+BW)-1:0] p_o
);
  for (genvar k = 0; k < Places; k++) begin : gen_place
    logic [AW-1:0] a_q;
    logic [BW-1:0] b_q;
    logic [AW+BW-1:0] p;
    always_ff @(posedge clk_i) begin
      a_q <= (tick_i == 32'(Ticks[16*k+:16])) ? a_i[k*AW+:AW] : '0;
      b_q <= b_i[k*BW+:BW];
    end
    mul_pipe #(.AW(AW), .BW(BW), .Clocks(Clocks)) u_p (.clk_i, .en_i(1'b1), .a_i(a_q), .b_i(b_q), .p_o(p));
    assign p_o[k*(AW+BW)+:AW+BW] = p;
  end
endmodule
)";

std::string bench(const std::vector<Config>& configs) {
  std::string packages;
  std::string text = "module bench;\n  logic clk, rst_n, start;\n  int clock;\n  logic [8:0] d;\n";
  std::string keep;
  std::string print;
  int longest = 0;
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const std::string package = fmt::format("unit{}_pkg", i);
    packages += std::regex_replace(emit_sv(configs[i]), std::regex("bitspan_cfg_pkg"), package);
    longest = std::max(longest, rtl_timing(configs[i]).row.unit);
    text += fmt::format(
        "  logic [{0}::RowRecipOutW-1:0] m{1}, made{1};\n  logic signed [7:0] e{1}, exponent{1};\n"
        "  localparam int Newton{1} = {0}::RowNewtonProducts;\n"
        "  localparam int Places{1} = (Newton{1} > 0) ? Newton{1} : 1;\n"
        "  localparam int First{1} = (Newton{1} > 0) ? {0}::RowProducts : 0;\n"
        "  logic [Places{1}*{0}::RowAW-1:0] a{1};\n  logic [Places{1}*{0}::RowBW-1:0] b{1};\n"
        "  logic [Places{1}*({0}::RowAW+{0}::RowBW)-1:0] p{1};\n"
        "  outside #(.Places(Places{1}), .AW({0}::RowAW), .BW({0}::RowBW), .Clocks({0}::ProductClocks),\n"
        "      .Ticks({0}::RowTicks[16*First{1}+:16*Places{1}])) u_outside{1} (.clk_i(clk), .tick_i(clock + "
        "1),\n"
        "      .a_i(a{1}), .b_i(b{1}), .p_o(p{1}));\n"
        "  reciprocal #(\n",
        package, i);
    for (const char* name : parameters)
      text += fmt::format("      .{}({}::RowRecip{}),\n", name, package, name);
    text += fmt::format(
        "      .NormaliseClocks({0}::NormaliseClocks),\n      .ProductClocks({0}::ProductClocks),\n"
        "      .Clocks({0}::RowUnitClocks),\n      .Shared({0}::RowNewtonProducts),\n      .StartTick(1),\n"
        "      .AW({0}::RowAW),\n      .BW({0}::RowBW),\n"
        "      .Ticks({0}::RowTicks[16*First{1}+:16*Places{1}])\n  ) u_{1} (.clk_i(clk), .rst_ni(rst_n), "
        ".en_i(1'b1), "
        ".start_i(start), .d_i(d), .a_o(a{1}), .b_o(b{1}), .product_i(p{1}), .m_o(m{1}), .e_o(e{1}));\n",
        package, i);
    keep += fmt::format(
        "        if (c == {0}::RowUnitClocks - 1) begin made{1} = m{1}; exponent{1} = e{1}; end\n", package,
        i);
    print += fmt::format("      $display(\"{0} %0d %0d %0d\", d, made{0}, exponent{0});\n", i);
  }
  text += fmt::format(
      "  initial begin\n    clk = 0; start = 0; d = 0; rst_n = 1; #1 rst_n = 0; #1 rst_n = 1;\n"
      "    for (int i = 0; i < {}; i++) begin\n      d = i; start = 1;\n"
      "      for (int c = 0; c < {}; c++) begin\n        clock = c;\n        #1 clk = 1; #1 clk = 0; start = "
      "0;\n{}      end\n{}   "
      " end\n"
      "  end\nendmodule\n",
      1 << operand_bits, longest, keep, print);
  return packages + outside + text;
}

TEST(Reciprocal, EveryKindOverEveryOperand) {
  std::vector<Config> configs;
  std::size_t number = 0;
  for (const Config& c : unit_configs()) {
    if (in_gate(number++, 3)) configs.push_back(c);
  }
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> sources = {folder.write("bench.sv", bench(configs))};
  for (const auto& source : rtl_sources()) {
    const std::string name = source.stem().string();
    if (!name.starts_with("span") && !name.starts_with("row_")) sources.push_back(source);
  }
  constexpr std::array tools{
      +[](const std::vector<std::filesystem::path>& s) { return run_icarus(s, "bench"); },
      +[](const std::vector<std::filesystem::path>& s) { return run_verilator(s, "bench"); }};
  for (const auto run : in_gate(tools)) {
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
