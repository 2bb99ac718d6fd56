// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "io/message.hpp"

namespace bitspan {
namespace {

// "50 s", "4 min", "2.5 h"
std::string duration_text(double seconds) {
  if (seconds < 100) {
    return fmt::format("{:.0f} s", seconds);
  }
  return seconds < 6000 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

Progress::Progress(std::string label)
    : label_(std::move(label)),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      next_(start_) {}

Progress::~Progress() {
  if (shown_) {
    say("\r\x1b[K");
  }
}

void Progress::update(std::size_t done, std::size_t total) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now < next_) {
    return;
  }
  next_ = now + std::chrono::milliseconds(100);
  shown_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::string left;
  if (done > 0 && done < total && seconds > 2) {
    left = ", " + duration_text(seconds / static_cast<double>(done) * static_cast<double>(total - done)) +
           " left";
  }
  const std::string all = total == 0 ? "" : fmt::format(" of {}", total);
  say(fmt::format("\r\x1b[K{}: {}{}{}", label_, done, all, left));
}

}  // namespace bitspan
