// SPDX-License-Identifier: Apache-2.0
// Two configurations under prefixes of their own, read together: Verilator's lint is silent, Yosys checks the
// design, and Icarus runs both span interpolators in one simulation, each with its own records.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "engine/sv_names.hpp"
#include "tb/rtl_folder.hpp"
#include "tests/rtl/icarus_case.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/simulate.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

constexpr RtlChoice both_parts(const char* prefix) {
  return {.interpolator = true, .pixels = true, .prefix = prefix};
}

std::vector<fs::path> listed(const fs::path& folder, const std::string& list) {
  std::vector<fs::path> out;
  std::istringstream names(read_file(folder / list));
  for (std::string name; std::getline(names, name);) out.push_back(folder / name);
  return out;
}

// `depth16` as a_ in the folder a, and `narrow` as b_ in the folder b.
struct TwoFolders {
  TwoFolders() {
    write_rtl_folder(shipped_config("depth16"), both_parts("a_"), folder.path("a"));
    write_rtl_folder(shipped_config("narrow"), both_parts("b_"), folder.path("b"));
    sources = listed(folder.path("a"), "a_bitspan.f");
    for (const fs::path& source : listed(folder.path("b"), "b_bitspan.f")) sources.push_back(source);
  }
  TemporaryFolder folder;
  std::vector<fs::path> sources;
};

// The ports of a module, as `input logic [a_bitspan_cfg_pkg::SpanHW-1:0] h_i`.
std::vector<std::smatch> ports_of(const std::string& header) {
  static const std::regex port(R"re(\n +((?:input|output) +logic(?: \[[^\]]+\])?) (\w+))re");
  return {std::sregex_iterator(header.begin(), header.end(), port), {}};
}

// A module with an instance of each top, and with all their ports.
std::string module_of_tops(const TemporaryFolder& folder) {
  std::string ports;
  std::string instances;
  for (const char* part : {"a", "b"}) {
    for (const char* top : {"span_interpolator", "pixel_pipe"}) {
      const std::string name = fmt::format("{}_{}", part, top);
      const std::string text = folder.read(fmt::format("{}/{}.sv", part, name));
      const std::string header = text.substr(0, text.find("\n);"));
      std::string connections;
      for (const std::smatch& port : ports_of(header)) {
        ports += fmt::format("{}\n  {} {}_{}", ports.empty() ? "" : ",", port.str(1), name, port.str(2));
        connections += fmt::format("{}\n      .{}({}_{})", connections.empty() ? "" : ",", port.str(2), name,
                                   port.str(2));
      }
      instances += fmt::format("  {0} u_{0} ({1}\n  );\n", name, connections);
    }
  }
  return "module tops (" + ports + "\n);\n" + instances + "endmodule\n";
}

TEST(TwoConfigurations, VerilatorLintIsSilent) {
  const TwoFolders two;
  std::vector<std::string> command = {"verilator",       "--lint-only", "-Wall",        "--assert",
                                      "--max-num-width", "1048576",     "--top-module", "tops"};
  for (const fs::path& source : two.sources) command.push_back(source.string());
  command.push_back(two.folder.write("tops.sv", module_of_tops(two.folder)));
  const auto log = two.folder.path("lint.log");
  EXPECT_EQ(run_program(command, log, "this test"), 0);
  EXPECT_EQ(read_file(log), "");
}

TEST(TwoConfigurations, YosysReadsAndChecks) {
  const TwoFolders two;
  std::string script = "read_verilog -sv -DSYNTHESIS";
  for (const fs::path& source : two.sources) script += ' ' + source.string();
  script += ' ' + two.folder.write("tops.sv", module_of_tops(two.folder));
  script += "; hierarchy -check -top tops; proc; check -assert";
  const auto log = two.folder.path("yosys.log");
  EXPECT_EQ(run_program({"yosys", "-q", "-p", script}, log, "this test"), 0) << read_file(log);
}

// Both benches in one simulation, which ends with the later of them, beside the elaborated pixel stages.
TEST(TwoConfigurations, IcarusRunsBoth) {
  TwoFolders two;
  std::string top = "module two;\n  tops u_tops ();\n";
  std::vector<std::string> arguments;
  std::vector<std::string> expected;
  Random random(12);
  for (const auto& [part, name] : {std::pair("a", "depth16"), std::pair("b", "narrow")}) {
    const Config c = shipped_config(name);
    fs::create_directory(two.folder.path(fmt::format("{}-case", part)));
    const InterpolatorCase given = make_interpolator_case(random, c, 30, 6);
    const TemporaryFolder files;
    IcarusRun run = prepare_icarus(files, c, given);
    for (const std::string& argument : run.arguments) {
      const std::size_t equals = argument.find('=');
      const std::string key = argument.substr(1, equals - 1);
      if (key == "seed") continue;
      const std::string copy =
          two.folder.write(fmt::format("{}-case/{}", part, key), read_file(argument.substr(equals + 1)));
      arguments.push_back(fmt::format("+{}_{}={}", part, key, copy));
    }
    expected.push_back(run.expected);
    std::string bench = read_file(run.sources.back());
    SvNames names = declared_names(bench);
    names.modules.insert("span_interpolator");
    names.packages.insert("bitspan_cfg_pkg");
    bench = with_prefix(bench, fmt::format("{}_", part), names);
    bench = std::regex_replace(bench, std::regex("open\\(\""), fmt::format("open(\"{}_", part));
    bench = std::regex_replace(bench, std::regex("\\$finish;"), "");
    two.sources.emplace_back(two.folder.write(fmt::format("{}_icarus_tb.sv", part), bench));
    top += fmt::format("  {0}_icarus_tb u_{0} ();\n", part);
  }
  two.sources.emplace_back(two.folder.write("tops.sv", module_of_tops(two.folder)));
  two.sources.emplace_back(two.folder.write("two.sv", top + "endmodule\n"));
  const std::string printed = run_icarus(two.sources, "two", arguments);
  for (const std::string& line : expected) EXPECT_NE(printed.find(line), std::string::npos) << printed;
  EXPECT_NE(expected[0], expected[1]);
}

// Every module and package has the prefix, and no file is another one than without it.
TEST(TwoConfigurations, TheSourcesDifferInNothingElse) {
  const TemporaryFolder folder;
  const fs::path plain = folder.path("plain");
  write_rtl_folder(shipped_config("depth16"), both_parts("other_"), folder.path("other"));
  write_rtl_folder(shipped_config("depth16"), both_parts(""), plain.string());
  const std::vector<fs::path> prefixed = listed(folder.path("other"), "other_bitspan.f");
  const std::vector<fs::path> sources = listed(plain, "bitspan.f");
  ASSERT_EQ(prefixed.size(), sources.size());
  SvNames all;
  for (const fs::path& source : sources) {
    SvNames names = declared_names(read_file(source));
    EXPECT_EQ(names.modules.size() + names.packages.size(), 1U) << source;
    all.modules.merge(names.modules);
    all.packages.merge(names.packages);
  }
  EXPECT_EQ(all.modules.size() + all.packages.size(), sources.size());
  EXPECT_EQ(all.packages.size(), 2U);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string text = read_file(prefixed[i]);
    EXPECT_EQ(prefixed[i].filename().string(), "other_" + sources[i].filename().string());
    const SvNames names = declared_names(text);
    for (const std::string& name : names.modules) EXPECT_TRUE(all.modules.contains(name.substr(6))) << name;
    EXPECT_EQ(std::regex_replace(text, std::regex("\\bother_(\\w+)"), "$1"), read_file(sources[i]));
  }
  // The sources are those that are compiled here.
  for (const fs::path& source : rtl_sources())
    EXPECT_EQ(read_file(plain / source.filename()), read_file(source));
}

TEST(TwoConfigurations, AFolderIsWholeOrNotThere) {
  const TemporaryFolder folder;
  const Config c = shipped_config("narrow");
  EXPECT_EQ(write_rtl_folder(c, {.interpolator = true, .pixels = false, .prefix = ""}, folder.path("empty")),
            static_cast<int>(rtl_sources().size()) + 2);
  const auto refused = [&](const RtlChoice& choice, const std::string& path, std::string_view part) {
    expect_refusal([&] { write_rtl_folder(c, choice, path); }, part);
  };
  refused(both_parts("a_"), folder.path("empty"), "is there already");
  const std::string file = folder.write("file", "");
  refused(both_parts("a_"), file, "is there already");
  refused(both_parts("a_"), file + "/below", "below");
  refused(both_parts("row_"), folder.path("none"), "row_divide");
  const int files = folder.files();
  {
    // A source that is not there is missed in the middle of the work.
    const RtlCopy copy;
    fs::remove(fs::path(copy.path()) / "rtl/merge.sv");
    refused(both_parts("a_"), folder.path("none"), "merge.sv");
  }
  EXPECT_EQ(folder.files(), files);
  fs::create_directory(folder.path("made"));
  EXPECT_NO_THROW(write_rtl_folder(c, both_parts("a_"), folder.path("made/")));
  EXPECT_TRUE(fs::exists(folder.path("made/a_bitspan.f")));
}

}  // namespace
}  // namespace bitspan
