// SPDX-License-Identifier: Apache-2.0
// Prefixes reach the names of modules and packages, and nothing that is only spelled like one.
#include "engine/sv_names.hpp"

#include <gtest/gtest.h>

#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

constexpr std::string_view text = R"(// module fifo: the fifo of span records
package cfg_pkg;
  localparam int W = 4'b1;
endpackage
module fifo #(parameter int Depth = cfg_pkg::W) (input logic span, output logic fifo_o);
  /* fifo u_no (); */
  logic fifo, cfg_pkg_q, my_fifo;
  assign fifo_o = fifo ? span : (span inside {1'b0});
  if (Depth > 1) begin : span
    initial $fatal(1, "fifo: a \" fifo #(");
  end
endmodule : fifo
module span (input logic clk_i);
  fifo #(.Depth(cfg_pkg::W)) u_fifo (.span(clk_i), .fifo_o());
  fifo fifo (.span(clk_i), .fifo_o());
endmodule
)";

constexpr std::string_view prefixed = R"(// module fifo: the fifo of span records
package x_cfg_pkg;
  localparam int W = 4'b1;
endpackage
module x_fifo #(parameter int Depth = x_cfg_pkg::W) (input logic span, output logic fifo_o);
  /* fifo u_no (); */
  logic fifo, cfg_pkg_q, my_fifo;
  assign fifo_o = fifo ? span : (span inside {1'b0});
  if (Depth > 1) begin : span
    initial $fatal(1, "fifo: a \" fifo #(");
  end
endmodule : x_fifo
module x_span (input logic clk_i);
  x_fifo #(.Depth(x_cfg_pkg::W)) u_fifo (.span(clk_i), .fifo_o());
  x_fifo fifo (.span(clk_i), .fifo_o());
endmodule
)";

TEST(SvNames, APrefixReachesNamesAlone) {
  const SvNames names = declared_names(text);
  EXPECT_EQ(names.modules, (decltype(names.modules){"fifo", "span"}));
  EXPECT_EQ(names.packages, (decltype(names.packages){"cfg_pkg"}));
  EXPECT_EQ(with_prefix(text, "x_", names), prefixed);
  EXPECT_EQ(with_prefix(text, "x_", {}), text);
  EXPECT_EQ(with_prefix("// a comment without an end", "x_", names), "// a comment without an end");
  EXPECT_EQ(with_prefix("\"a string without an end\\", "x_", names), "\"a string without an end\\");
}

TEST(SvNames, PrefixesThatBeginNamesAreLegal) {
  for (const char* legal : {"a", "_", "A9_", "begin_", "depth16_"})
    EXPECT_NO_THROW(check_prefix(legal)) << legal;
  for (const char* illegal : {"", "9a", "a-", "a b", "a$", "\xc3\xa4", "a\n"}) {
    EXPECT_THROW(check_prefix(illegal), InputError) << illegal;
  }
  for (const char* keyword : {"module", "accept_on", "xor", "s_until_with"}) {
    expect_refusal([&] { check_prefix(keyword); }, "keyword");
  }
}

TEST(SvNames, PrefixesThatMakeAnotherModulesNameAreRefused) {
  const SvNames names{{"divide", "row_divide"}, {}};
  EXPECT_NO_THROW(check_prefix("a_", names));
  expect_refusal([&] { check_prefix("row_", names); }, "row_divide");
}

}  // namespace
}  // namespace bitspan
