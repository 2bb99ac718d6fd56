// SPDX-License-Identifier: Apache-2.0
// The cache of Verilated libraries: found again, made by two at once, and what is said when it cannot be
// made.
#include <gtest/gtest.h>

#include <thread>

#include "tb/rtl_build.hpp"
#include "tb/rtl_coverage.hpp"
#include "tb/rtl_stream.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"
#include "tests/support/tool_error.hpp"

namespace bitspan {
namespace {

Config narrow() { return shipped_config("narrow"); }

std::string message_of(const Config& c) {
  return input_error([&c] { build_rtl(c); });
}

TEST(Build, TwoAtOnceAndThenFromTheCache) {
  const TemporaryFolder cache;
  const Environment environment("BITSPAN_CACHE", cache.path());
  std::filesystem::path a;
  std::filesystem::path b;
  std::thread first([&] { a = build_rtl(narrow()); });
  std::thread second([&] { b = build_rtl(narrow()); });
  first.join();
  second.join();
  EXPECT_EQ(a, b);
  Rtl rtl(narrow());
  RtlDrive drive{};
  RtlSample sample{};
  rtl.clock(drive, sample);
  EXPECT_TRUE(sample.in_ready);
  EXPECT_FALSE(sample.out_valid);
  // Nothing half-made stays behind; the name of a configuration and what the RTL does not have do not count.
  for (const auto& entry : std::filesystem::directory_iterator(cache.path()))
    EXPECT_TRUE(entry.is_regular_file());
  const Environment no_tools("PATH", "/nonexistent");
  Config same = narrow();
  same.name = "other";
  same.fog = same.fog == FogMode::none ? FogMode::linear : FogMode::none;
  EXPECT_EQ(build_rtl(same), a);
}

TEST(Build, SaysWhatIsMissing) {
  const TemporaryFolder cache;
  const Environment environment("BITSPAN_CACHE", cache.path());
  {
    const Environment no_tools("PATH", "/nonexistent");
    const std::string message = tool_error([] { build_rtl(narrow()); });
    EXPECT_NE(message.find("needs it on PATH"), std::string::npos) << message;
  }
  {
    const Environment no_compiler("CXX", "no-such-compiler");
    const std::string message = tool_error([] { build_rtl(narrow()); });
    EXPECT_NE(message.find("no-such-compiler"), std::string::npos) << message;
  }
  {
    const Environment root("BITSPAN_ROOT", cache.path());
    EXPECT_NE(message_of(narrow()).find("BITSPAN_ROOT"), std::string::npos) << message_of(narrow());
  }
  const Environment file("BITSPAN_CACHE", cache.write("file", "") + "/cache");
  EXPECT_NE(message_of(narrow()).find("BITSPAN_CACHE"), std::string::npos) << message_of(narrow());
}

// Verilator's refusal of sources that the user named is the user's affair: InputError, and the log stays.
TEST(Build, RefusesSourcesThatVerilatorRefuses) {
  const RtlCopy copy;
  copy.replace("rtl/span.sv", "endmodule", "endmodul");
  const std::string message = message_of(narrow());
  EXPECT_NE(message.find("verilator refused"), std::string::npos) << message;
}

TEST(Build, TheHashOfTheSourcesTellsThemApart) {
  const std::string own = rtl_sources_hash();
  EXPECT_EQ(own.size(), 32U);
  const RtlCopy copy;
  EXPECT_EQ(rtl_sources_hash(), own);
  copy.replace("rtl/span.sv", "endmodule", "endmodule ");
  EXPECT_NE(rtl_sources_hash(), own);
}

// RTL whose structure is not what the package says does not run.
TEST(Build, LatencyThatDiffersFromThePackageIsSeen) {
  const RtlCopy copy;
  copy.replace("rtl/span.sv", "RecipTick = 1 + PixelUnitClocks;", "RecipTick = 2 + PixelUnitClocks;");
  try {
    const Rtl rtl(narrow());
    FAIL() << "no assertion failed";
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("span: has"), std::string::npos) << e.what();
  }
}

// Both directions of a channel, and no port that is only spelled like one.
TEST(Build, CoversWatchEveryChannelOfAModule) {
  const std::string covers = handshake_covers(
      {"module sink (\n  input logic clk_i,\n  input logic in_valid_i,\n  output logic in_ready_o,\n"
       "  output logic [3:0] out_valid_o,\n  input  logic out_ready_i,\n  output logic "
       "tap_valid_o\n);\nendmodule\n",
       "module cell_of_it (\n  input logic a_i\n);\nendmodule\n"});
  const auto has = [&](std::string_view part) { return covers.find(part) != std::string::npos; };
  EXPECT_TRUE(has("bind sink sink_handshakes")) << covers;
  for (const char* point : {"in_transfer:", "in_stall:", "in_idle:", "in_back_to_back:", "out_stall:"}) {
    EXPECT_TRUE(has(point)) << point << '\n' << covers;
  }
  EXPECT_TRUE(has(".out_valid(out_valid_o), .out_ready(out_ready_i)")) << covers;
  EXPECT_FALSE(has("tap")) << covers;
  EXPECT_FALSE(has("cell_of_it")) << covers;
}

TEST(Build, RecordsThatDoNotFitAreRefused) {
  const Config c = narrow();
  RowRecord row;
  row.x_first = std::int64_t{1} << 40;
  row.x_last = row.x_first;
  EXPECT_THROW(rtl_inputs(c, row, 1), std::logic_error);
}

}  // namespace
}  // namespace bitspan
