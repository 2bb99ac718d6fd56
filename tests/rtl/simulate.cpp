// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/simulate.hpp"

#include <stdexcept>

#include "tests/support/files.hpp"

namespace bitspan {
namespace {

void run_or_throw(const std::vector<std::string>& command, const std::filesystem::path& log) {
  const int code = run_program(command, log, "this test");
  if (code != 0) {
    throw std::runtime_error(command.front() + " ended with " + std::to_string(code) + "\n" + read_file(log));
  }
}

}  // namespace

std::string run_icarus(const std::vector<std::filesystem::path>& sources, const std::string& top,
                       const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string program = folder.path("bench.vvp");
  std::vector<std::string> command = {"iverilog", "-g2012", "-o", program, "-s", top};
  for (const auto& source : sources) command.push_back(source.string());
  run_or_throw(command, folder.path("iverilog.log"));
  command = {"vvp", "-N", program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  run_or_throw(command, folder.path("vvp.log"));
  return folder.read("vvp.log");
}

std::string run_verilator(const std::vector<std::filesystem::path>& sources, const std::string& top,
                          const std::vector<std::string>& flags) {
  const TemporaryFolder folder;
  std::vector<std::string> command = {"verilator",    "--binary", "--assert", "-Wno-fatal",     "-Wno-lint",
                                      "--top-module", top,        "--Mdir",   folder.path("v"), "-o",
                                      "sim",          "-CFLAGS",  "-O0"};
  command.insert(command.end(), flags.begin(), flags.end());
  for (const auto& source : sources) command.push_back(source.string());
  run_or_throw(command, folder.path("verilator.log"));
  run_or_throw({folder.path("v/sim")}, folder.path("sim.log"));
  return folder.read("sim.log");
}

}  // namespace bitspan
