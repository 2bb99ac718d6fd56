// SPDX-License-Identifier: Apache-2.0
#include "io/leftovers.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <random>
#include <string_view>

namespace bitspan {

namespace {

enum class State : int { free, filling, kept };

}  // namespace

// Slots are never freed: a signal may come at any time, and to any thread.
struct LeftoverSlot {
  std::atomic<State> state{State::filling};
  std::array<char, PATH_MAX> path{};
  LeftoverSlot* next = nullptr;
};

namespace {

static_assert(std::atomic<State>::is_always_lock_free && std::atomic<LeftoverSlot*>::is_always_lock_free);

std::atomic<LeftoverSlot*> slots{nullptr};
std::atomic<bool> ending{false};
std::atomic<pid_t> owner{0};

LeftoverSlot* free_slot() {
  for (LeftoverSlot* slot = slots; slot != nullptr; slot = slot->next) {
    State state = State::free;
    if (slot->state.compare_exchange_strong(state, State::filling)) return slot;
  }
  auto* slot = new LeftoverSlot;
  slot->next = slots;
  while (!slots.compare_exchange_weak(slot->next, slot)) {
  }
  return slot;
}

// How deep a folder of ours can be, which bounds the stack that remove_tree takes.
constexpr int deepest = 16;

// Removes the file or the folder `name` of an open folder. Async-signal-safe, so without readdir. A program
// that we started may still write into the folder: a folder that has filled again is read again, a few times.
// NOLINTNEXTLINE(misc-no-recursion): `depth` bounds it
void remove_tree(int parent, const char* name, int depth = 0) {
  if (::unlinkat(parent, name, 0) == 0 || errno == ENOENT || depth == deepest) return;
  for (int turn = 0; turn < 8 && ::unlinkat(parent, name, AT_REMOVEDIR) != 0; ++turn) {
    const int folder = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0) return;
    alignas(dirent64) std::array<char, 2048> entries{};
    for (long size = 0; (size = ::syscall(SYS_getdents64, folder, entries.data(), entries.size())) > 0;) {
      for (long at = 0; at < size;) {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as the system call writes them
        const auto* entry = reinterpret_cast<const dirent64*>(&entries[static_cast<std::size_t>(at)]);
        const std::string_view found = entry->d_name;
        if (found != "." && found != "..") remove_tree(folder, entry->d_name, depth + 1);
        at += entry->d_reclen;
      }
    }
    ::close(folder);
  }
}

// A child that was forked has the list, but not the files.
void on_signal(int number) {
  const int error_number = errno;
  if (::getpid() == owner) remove_leftovers();
  struct sigaction by_default {};
  by_default.sa_handler = SIG_DFL;
  ::sigaction(number, &by_default, nullptr);
  ::raise(number);  // comes when this returns
  errno = error_number;
}

}  // namespace

Leftover::Leftover(const std::string& path) : slot_(nullptr) {
  if (path.size() >= PATH_MAX) return;
  slot_ = free_slot();
  // The slot may be read by a signal's handler: it must not change, nor must a file come after it.
  while (ending) ::pause();
  std::memcpy(slot_->path.data(), path.c_str(), path.size() + 1);
  slot_->state = State::kept;
}

Leftover::~Leftover() {
  if (slot_ != nullptr) slot_->state = State::free;
}

std::filesystem::path temporary_path(const std::filesystem::path& folder) {
  static std::atomic<unsigned> serial{0};
  // Another system may have a program of the same number in a folder that both share.
  static const std::string own = std::to_string(std::random_device()());
  return folder / (".bitspan-" + std::to_string(::getpid()) + "-" + own + "-" + std::to_string(serial++));
}

void remove_leftovers() {
  ending = true;
  for (const LeftoverSlot* slot = slots; slot != nullptr; slot = slot->next) {
    if (slot->state == State::kept) remove_tree(AT_FDCWD, slot->path.data());
  }
}

void remove_leftovers_on_signals() {
  owner = ::getpid();
  ::signal(SIGXFSZ, SIG_IGN);
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGXCPU}) {
    struct sigaction action {};
    if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
    action.sa_handler = on_signal;
    sigfillset(&action.sa_mask);
    ::sigaction(number, &action, nullptr);
  }
}

}  // namespace bitspan
