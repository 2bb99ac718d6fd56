// SPDX-License-Identifier: Apache-2.0
// Temporary files that a signal may catch half-written.
#pragma once

#include <filesystem>
#include <string>

namespace bitspan {

struct LeftoverSlot;

// While one exists, a signal that ends the program removes the file at this path first, or the folder with
// all that it holds (see remove_leftovers_on_signals). A path too long for the system is not kept, for
// nothing can lie there.
class Leftover {
 public:
  explicit Leftover(const std::string& path);
  ~Leftover();
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;

 private:
  LeftoverSlot* slot_;
};

// Returns a path in `folder` that nothing has, with a short name: a name that takes all the bytes a system
// allows leaves none for a suffix.
std::filesystem::path temporary_path(const std::filesystem::path& folder);

// Async-signal-safe. After it no Leftover can be made: the program ends.
void remove_leftovers();

// For a program, not for a library: SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE and SIGXCPU remove the
// leftovers and then end the program as they do. Signals that are ignored stay so. SIGXFSZ is ignored, so
// that writing past a limit of size fails as on a full disk.
void remove_leftovers_on_signals();

}  // namespace bitspan
