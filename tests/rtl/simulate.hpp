// A SystemVerilog bench of a test's own, run by a simulator; the bench has no inputs and prints what it
// finds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tb/programs.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {

// A folder that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  // Writes a file in it and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

std::string read_file(const std::filesystem::path& path);

// What the bench printed, its lines as they are. Throws std::runtime_error with the log where a tool refuses
// or the simulation ends with an error.
std::string run_icarus(const std::vector<std::filesystem::path>& sources, const std::string& top,
                       const std::vector<std::string>& arguments = {});
std::string run_verilator(const std::vector<std::filesystem::path>& sources, const std::string& top,
                          const std::vector<std::string>& flags = verilator_safe_flags());

}  // namespace bitspan
