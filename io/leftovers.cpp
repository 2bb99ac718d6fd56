// SPDX-License-Identifier: Apache-2.0
#include "io/leftovers.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>
#include <random>

namespace bitspan {

namespace {

enum class State : int { free, filling, file, folder };

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

Leftover::Leftover(const std::string& path, Kind kind) : slot_(nullptr) {
  if (path.size() >= PATH_MAX) return;
  slot_ = free_slot();
  // The slot may be read by a signal's handler: it must not change, nor must a file come after it.
  while (ending) ::pause();
  std::memcpy(slot_->path.data(), path.c_str(), path.size() + 1);
  slot_->state = kind == Kind::file ? State::file : State::folder;
}

Leftover::~Leftover() {
  if (slot_ != nullptr) slot_->state = State::free;
}

Leftover::Leftover(Leftover&& other) noexcept : slot_(other.slot_) { other.slot_ = nullptr; }

std::filesystem::path temporary_path(const std::filesystem::path& folder) {
  static std::atomic<unsigned> serial{0};
  // Another system may have a program of the same number in a folder that both share.
  static const std::string own = std::to_string(std::random_device()());
  return folder / (".bitspan-" + std::to_string(::getpid()) + "-" + own + "-" + std::to_string(serial++));
}

void remove_leftovers() {
  ending = true;
  for (const LeftoverSlot* slot = slots; slot != nullptr; slot = slot->next) {
    if (slot->state == State::file) ::unlink(slot->path.data());
  }
  for (const LeftoverSlot* slot = slots; slot != nullptr; slot = slot->next) {
    if (slot->state == State::folder) ::rmdir(slot->path.data());
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
