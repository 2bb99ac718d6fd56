// SPDX-License-Identifier: Apache-2.0
#include "scene/assimp.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "config/config.hpp"
#include "config/one_line.hpp"
#include "io/data_folder.hpp"
#include "scene/mesh_binary.hpp"

namespace bitspan {
namespace {

using Clock = std::chrono::steady_clock;

// The program while it runs, with the pipe that its answer comes through. The destructor ends it.
class Child {
 public:
  Child(const std::string& program, const std::string& file);
  ~Child() {
    ::close(pipe_);
    if (pid_ > 0) {
      ::kill(-pid_, SIGKILL);
      wait();
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Returns fewer bytes where the answer ends before. Throws std::runtime_error at the deadline.
  std::vector<std::uint8_t> read(std::uint64_t count, Clock::time_point deadline);
  // Waits for the end and returns what is to say of it, "" for a good one.
  std::string wait();

 private:
  pid_t pid_ = -1;
  int pipe_ = -1;
};

Child::Child(const std::string& program, const std::string& file) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  pipe_ = ends[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // The host's own signal masks and handlers are not the program's; a group, so that nothing of it stays.
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::string name = program, argument = file;
  const std::array<char*, 3> arguments{name.data(), argument.data(), nullptr};
  const int error = ::posix_spawn(&pid_, name.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error == 0) return;
  ::close(pipe_);
  pid_ = -1;
  throw std::runtime_error(program + " does not run: " + std::strerror(error));
}

std::vector<std::uint8_t> Child::read(std::uint64_t count, Clock::time_point deadline) {
  constexpr std::uint64_t step = std::uint64_t{1} << 24;  // memory follows what has come
  std::vector<std::uint8_t> out;
  std::uint64_t have = 0;
  while (have < count) {
    if (have == out.size()) out.resize(std::min(count, have + std::max(step, have)));
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd event{pipe_, POLLIN, 0};
    const int ready = left <= 0 ? 0 : ::poll(&event, 1, static_cast<int>(std::min<long>(left, 1 << 30)));
    if (ready == 0) throw std::runtime_error("it has not been read in time");
    if (ready < 0) {
      if (errno == EINTR) continue;
      throw std::runtime_error(std::strerror(errno));
    }
    const ssize_t got = ::read(pipe_, &out[have], out.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    have += static_cast<std::uint64_t>(got);
  }
  out.resize(have);
  return out;
}

std::string Child::wait() {
  int status = 0;
  pid_t ended = -1;
  do {
    ended = ::waitpid(pid_, &status, 0);
  } while (ended < 0 && errno == EINTR);
  pid_ = -1;
  if (ended < 0) return "";  // a host that ignores SIGCHLD
  if (WIFEXITED(status)) {
    return WEXITSTATUS(status) == 0 ? ""
                                    : "bitspan-assimp ended with code " + std::to_string(WEXITSTATUS(status));
  }
  const int signal = WTERMSIG(status);
  return signal == SIGXCPU
             ? "it takes more than 60 s of the processor"
             : "Assimp was ended by signal " + std::to_string(signal) + ", " + ::strsignal(signal);
}

MeshAnswer answer_of(Child& child, double seconds) {
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  const std::vector<std::uint8_t> header = child.read(mesh_header_bytes, deadline);
  if (header.size() < mesh_header_bytes) {
    const std::string end = child.wait();
    throw std::runtime_error(end.empty() ? "bitspan-assimp gave no answer" : end);
  }
  const std::uint64_t size = mesh_payload_bytes(header);
  const std::vector<std::uint8_t> payload = child.read(size, deadline);
  if (payload.size() < size) {
    const std::string end = child.wait();
    throw std::runtime_error(end.empty() ? "the answer of bitspan-assimp ends too early" : end);
  }
  return decode_mesh(header, payload);
}

}  // namespace

MeshFile read_by_assimp(const std::string& path, double seconds) {
  std::string reason;
  try {
    Child child(assimp_program().string(), path);
    MeshAnswer answer = answer_of(child, seconds);
    if (answer.error.empty()) return std::move(answer.mesh);
    reason = answer.error;
  } catch (const std::runtime_error& error) {
    reason = error.what();
  }
  throw InputError(path + ": cannot read the mesh: " + one_line(reason) +
                   "; expected OBJ, PLY, glTF or another format that Assimp reads");
}

}  // namespace bitspan
