// SPDX-License-Identifier: Apache-2.0
#include "tb/programs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "config/config.hpp"

extern char** environ;

namespace bitspan {

namespace fs = std::filesystem;

namespace {

std::string with_hint(std::string text, std::string_view hint) {
  return hint.empty() ? text : text.append("; ").append(hint);
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

// Looks seldom at what takes long.
ProgramEnd watch(pid_t child, const ProgramOptions& options) {
  using Clock = std::chrono::steady_clock;
  using How = ProgramEnd::How;
  constexpr std::chrono::milliseconds longest_nap(100);
  const Clock::time_point start = Clock::now();
  for (std::chrono::milliseconds nap(1);; nap = std::min(2 * nap, longest_nap)) {
    int status = 0;
    const pid_t done = ::waitpid(child, &status, WNOHANG);
    if (done == child) return {How::exited, code_of(status)};
    if (done < 0 && errno != EINTR) throw std::runtime_error("waitpid of a program fails");
    const bool cancelled = options.cancelled != nullptr && options.cancelled->load();
    const bool late = std::chrono::duration<double>(Clock::now() - start).count() > options.seconds;
    if (cancelled || late) {
      ::kill(options.group ? -child : child, SIGKILL);
      wait_for(child);
      return {cancelled ? How::cancelled : How::late, 128 + SIGKILL};
    }
    std::this_thread::sleep_for(nap);
  }
}

}  // namespace

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string read_text(const fs::path& path, std::string_view hint) {
  const std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(with_hint(path.string() + ": cannot be read", hint));
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write_text(const fs::path& path, std::string_view text, std::string_view hint) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw InputError(with_hint(path.string() + ": cannot be written", hint));
}

ScratchFolder::ScratchFolder(const fs::path& parent, std::string_view name, std::string_view hint) {
  std::random_device random;
  path_ = parent / fmt::format("{}-{}-{:08x}{:08x}", name, ::getpid(), random(), random());
  std::error_code error;
  leftover_.emplace(fs::absolute(path_, error).string());
  fs::create_directories(path_, error);
  if (error) {
    throw InputError(
        with_hint(fmt::format("{}: cannot be created ({})", path_.string(), error.message()), hint));
  }
}
ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (leftover_) fs::remove_all(path_, ignored);
}

ScratchFolder temporary_scratch_folder(std::string_view name) {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error) {
    throw InputError(
        with_hint(fmt::format("no folder for temporary files ({})", error.message()), temporary_hint));
  }
  return {parent, name, temporary_hint};
}

ProgramEnd run_program(const std::vector<std::string>& command, const ProgramOptions& options) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, options.folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, options.input.c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, options.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (options.group) {
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
  }
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, arguments.front(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed == ENOENT || failed == EACCES || failed == ENOTDIR) return {ProgramEnd::How::missing, 0};
  if (failed != 0) {
    throw ToolError(
        fmt::format("{}: does not start: {}", command.front(), std::generic_category().message(failed)));
  }
  const bool watched =
      options.cancelled != nullptr || options.seconds < std::numeric_limits<double>::infinity();
  return watched ? watch(child, options) : ProgramEnd{ProgramEnd::How::exited, code_of(wait_for(child))};
}

int run_program(const std::vector<std::string>& command, const fs::path& log, const std::string& needed_for) {
  ProgramOptions options;
  options.log = log;
  const ProgramEnd end = run_program(command, options);
  if (end.how == ProgramEnd::How::missing) {
    throw ToolError(fmt::format("{}: does not start; {} needs it on PATH", command.front(), needed_for));
  }
  return end.code;
}

}  // namespace bitspan
