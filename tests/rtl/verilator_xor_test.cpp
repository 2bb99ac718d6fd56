// SPDX-License-Identifier: Apache-2.0
// Verilator 5.006 miscompiles this tree of XOR, silently, without the flag that every build here has: about
// half of the inputs are wrong then.
#include <gtest/gtest.h>

#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

// `wrong` is 0 for every x.
constexpr const char* bench = R"(
module bench;
  logic [39:0] x;
  logic wrong;
  assign wrong = {x[38:32], x[38] ^ x[31] ^ x[38]} != x[38:31];
  initial begin
    int count;
    count = 0;
    for (int i = 0; i < 1000; i++) begin
      x = {8'($urandom()), $urandom()};
      #1;
      if (wrong) count++;
    end
    $display("wrong %0d", count);
    $finish;
  end
endmodule
)";

std::string count_of(const std::vector<std::string>& flags) {
  const TemporaryFolder folder;
  const std::string printed = run_verilator({folder.write("bench.sv", bench)}, "bench", flags);
  const std::size_t at = printed.find("wrong ");
  return at == std::string::npos ? printed : printed.substr(at, printed.find('\n', at) - at);
}

TEST(VerilatorXor, RightWithTheFlagsOfEveryBuild) { EXPECT_EQ(count_of(verilator_safe_flags()), "wrong 0"); }

}  // namespace
}  // namespace bitspan
