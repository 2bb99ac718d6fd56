#include "tests/rtl/simulate.hpp"

#include <unistd.h>

#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>

namespace bitspan {
namespace {

void run_or_throw(const std::vector<std::string>& command, const std::filesystem::path& log) {
  const int code = run_program(command, log, "this test");
  if (code != 0) {
    throw std::runtime_error(command.front() + " ended with " + std::to_string(code) + "\n" + read_file(log));
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::random_device random;
  path_ = std::filesystem::temp_directory_path() /
          ("bitspan-rtl-" + std::to_string(::getpid()) + "-" + std::to_string(random()));
  std::filesystem::create_directories(path_);
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}
std::filesystem::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name) << text;
  return path_ / name;
}

std::string read_file(const std::filesystem::path& path) {
  const std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string run_icarus(const std::vector<std::filesystem::path>& sources, const std::string& top,
                       const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string program = (folder.path() / "bench.vvp").string();
  std::vector<std::string> command = {"iverilog", "-g2012", "-o", program, "-s", top};
  for (const auto& source : sources) command.push_back(source.string());
  run_or_throw(command, folder.path() / "iverilog.log");
  command = {"vvp", "-N", program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  run_or_throw(command, folder.path() / "vvp.log");
  return read_file(folder.path() / "vvp.log");
}

std::string run_verilator(const std::vector<std::filesystem::path>& sources, const std::string& top,
                          const std::vector<std::string>& flags) {
  const TemporaryFolder folder;
  std::vector<std::string> command = {"verilator",  "--binary",  "--assert",
                                      "-Wno-fatal", "-Wno-lint", "--top-module",
                                      top,          "--Mdir",    (folder.path() / "v").string(),
                                      "-o",         "sim",       "-CFLAGS",
                                      "-O0"};
  command.insert(command.end(), flags.begin(), flags.end());
  for (const auto& source : sources) command.push_back(source.string());
  run_or_throw(command, folder.path() / "verilator.log");
  run_or_throw({(folder.path() / "v/sim").string()}, folder.path() / "sim.log");
  return read_file(folder.path() / "sim.log");
}

}  // namespace bitspan
