// SPDX-License-Identifier: Apache-2.0
// Other people's programs as child processes, and the files that pass between them and us.
#pragma once

#include <atomic>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "io/leftovers.hpp"

namespace bitspan {

// A program that we need is missing, or broke on what we gave it: nothing that the user's input could mend.
// The text is one line. The command line prints it and exits with 3.
struct ToolError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Returns a variable of the environment; empty where it is not set.
std::string environment(const char* name);

// Read and write whole files. Throw InputError "path: cannot be read; HINT".
std::string read_text(const std::filesystem::path& path, std::string_view hint = {});
void write_text(const std::filesystem::path& path, std::string_view text, std::string_view hint = {});

// A folder for intermediate files below `parent`, removed by the destructor, and by a signal that ends the
// program (io/leftovers), unless it is kept for its logs. `name` begins its name. Throws InputError where it
// cannot be made; `hint` ends the message.
class ScratchFolder {
 public:
  ScratchFolder(const std::filesystem::path& parent, std::string_view name, std::string_view hint);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  void keep() { leftover_.reset(); }

 private:
  std::filesystem::path path_;
  std::optional<Leftover> leftover_;
};
inline constexpr std::string_view temporary_hint = "TMPDIR names the folder for it";
// Makes one in the folder for temporary files.
ScratchFolder temporary_scratch_folder(std::string_view name);

struct ProgramOptions {
  std::filesystem::path log;  // gets both outputs
  std::filesystem::path input =
      "/dev/null";                     // from the folder, as the log is, where they are not whole paths
  std::filesystem::path folder = ".";  // where it runs
  double seconds = std::numeric_limits<double>::infinity();  // after them it is killed
  const std::atomic<bool>* cancelled = nullptr;              // it is killed once this is set
  bool group = false;  // a process group of its own, killed as a whole: for programs that start others
};

struct ProgramEnd {
  enum class How { exited, missing, late, cancelled };
  How how = How::exited;
  int code = 0;  // exit code; 128 and the signal's number where one ended it
};

// Runs a program found on PATH. `missing` says that there is none of this name. Throws ToolError where it
// does not start for any other reason.
ProgramEnd run_program(const std::vector<std::string>& command, const ProgramOptions& options);

// Does the same and returns the exit code alone. Also throws ToolError where the program is missing;
// `needed_for` ends the message.
int run_program(const std::vector<std::string>& command, const std::filesystem::path& log,
                const std::string& needed_for);

}  // namespace bitspan
