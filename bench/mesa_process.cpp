// SPDX-License-Identifier: Apache-2.0
#include "bench/mesa_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

#include "bench/measure.hpp"
#include "bench/mesa.hpp"
#include "bench/scenes.hpp"

namespace bitspan::bench {
namespace {

// Commands of one byte pass over the pipes, and answers of a length and that many bytes.
constexpr char command_draw = 'd';
constexpr char command_picture = 'p';
// The first answer: this and the renderer's name, or a reason alone.
constexpr char ready = '+';

// Moves all of size bytes, by calls that move some: call(bytes done, bytes left) as read and write answer.
template <class Call>
bool move_all(std::size_t size, Call call) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = call(done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}
bool write_all(int to, const void* data, std::size_t size) {
  const auto* const at = static_cast<const char*>(data);
  return move_all(size, [&](std::size_t done, std::size_t left) { return ::write(to, at + done, left); });
}
bool read_all(int from, void* data, std::size_t size) {
  auto* const at = static_cast<char*>(data);
  return move_all(size, [&](std::size_t done, std::size_t left) { return ::read(from, at + done, left); });
}

template <class Enum>
Enum value_of(std::string_view name) {
  const auto found = std::ranges::find(enum_names<Enum>, name);
  if (found == enum_names<Enum>.end()) throw InputError("no such mode: " + std::string(name));
  return static_cast<Enum>(found - enum_names<Enum>.begin());
}

bool answer(int to, const void* data, std::size_t size) {
  const auto length = static_cast<std::uint64_t>(size);
  return write_all(to, &length, sizeof length) && write_all(to, data, size);
}
bool answer(int to, const std::string& text) { return answer(to, text.data(), text.size()); }

struct Pipe {
  std::array<int, 2> end{-1, -1};
  Pipe() {
    if (pipe2(end.data(), O_CLOEXEC) != 0) {
      throw std::system_error(errno, std::generic_category(), "pipe");
    }
  }
};

std::vector<std::string> environment_for(const MesaOptions& options) {
  std::vector<std::string> out;
  for (char** e = environ; *e != nullptr; ++e) {
    const std::string_view entry(*e);
    if (!entry.starts_with("GALLIUM_DRIVER=") && !entry.starts_with("LP_NUM_THREADS=")) {
      out.emplace_back(entry);
    }
  }
  out.push_back("GALLIUM_DRIVER=" + options.driver);
  out.push_back("LP_NUM_THREADS=" + std::to_string(options.threads));
  return out;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> out;
  for (std::string& s : strings) {
    out.push_back(s.data());
  }
  out.push_back(nullptr);
  return out;
}

}  // namespace

MesaProcess::MesaProcess(const std::string& scene, const std::string& texture, const MesaOptions& options) {
  // A child that died shows as a failed write, not as the end of this program.
  std::signal(SIGPIPE, SIG_IGN);
  const Pipe commands, answers;
  to_child_ = commands.end[1];
  from_child_ = answers.end[0];
  std::vector<std::string> arguments{"/proc/self/exe",
                                     mesa_child_flag,
                                     scene,
                                     texture,
                                     std::string(to_string(options.filter)),
                                     std::to_string(options.depth_bits),
                                     std::string(to_string(options.mip))};
  std::vector<std::string> environment = environment_for(options);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, commands.end[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answers.end[1], STDOUT_FILENO);
  const int error = posix_spawn(&pid_, arguments[0].c_str(), &actions, nullptr, pointers(arguments).data(),
                                pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  close(commands.end[0]);
  close(answers.end[1]);
  std::uint64_t length = 0;
  std::string first;
  if (error == 0 && read_all(from_child_, &length, sizeof length)) {
    first.resize(length);
    read_all(from_child_, first.data(), length);
  }
  if (first.empty() || first[0] != ready) {
    end();
    throw InputError(options.driver + ": " + (first.empty() ? "the process did not start" : first));
  }
  renderer_ = first.substr(1);
}

MesaProcess::~MesaProcess() { end(); }

void MesaProcess::end() {
  for (int* end : {&to_child_, &from_child_}) {
    if (*end >= 0) {
      close(*end);
      *end = -1;
    }
  }
  if (pid_ > 0) {
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
}

void MesaProcess::ask(char command) {
  if (!write_all(to_child_, &command, 1)) {
    throw std::runtime_error("Mesa's process has ended");
  }
}

void MesaProcess::read(void* data, std::size_t size) {
  if (!read_all(from_child_, data, size)) {
    throw std::runtime_error("Mesa's process ended in the middle of an answer");
  }
}

double MesaProcess::draw() {
  ask(command_draw);
  std::uint64_t length = 0;
  double seconds = 0;
  read(&length, sizeof length);
  read(&seconds, sizeof seconds);
  return seconds;
}

std::vector<std::uint8_t> MesaProcess::picture() {
  ask(command_picture);
  std::uint64_t length = 0;
  read(&length, sizeof length);
  std::vector<std::uint8_t> out(length);
  read(out.data(), length);
  return out;
}

int mesa_child(int argc, char** argv) {
  // Answers go to a descriptor of their own; whatever the libraries print goes to standard error.
  const int to = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  std::optional<Mesa> mesa;
  try {
    if (argc != 7) {
      throw InputError("wrong number of arguments");
    }
    const auto filter = value_of<TextureFilter>(argv[4]);
    int depth_bits = 0;
    std::from_chars(argv[5], argv[5] + std::strlen(argv[5]), depth_bits);
    mesa.emplace(frame_scene(argv[2], argv[3]), filter, depth_bits, value_of<MipMode>(argv[6]));
  } catch (const std::exception& e) {
    answer(to, std::string(e.what()));
    return 1;
  }
  bool well = answer(to, ready + mesa->renderer());
  for (char command = 0; well && read_all(STDIN_FILENO, &command, 1);) {
    if (command == command_draw) {
      const double start = now_seconds();
      mesa->draw();
      const double seconds = now_seconds() - start;
      well = answer(to, &seconds, sizeof seconds);
    } else if (command == command_picture) {
      well = answer(to, mesa->picture().data(), mesa->picture().size());
    }
  }
  return 0;
}

}  // namespace bitspan::bench
