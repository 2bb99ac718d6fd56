// SPDX-License-Identifier: Apache-2.0
// A folder's files that appear together, and only when each is complete.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "io/leftovers.hpp"

namespace bitspan {

// Makes files in a folder beside `directory`; commit() gives them their place. Without commit() the
// destructor removes them. All failures are InputError.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::string& directory);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  // Where to write the file `name`.
  std::string path(std::string_view name);
  // commit() removes the file `name` that an earlier run left, also where this one makes none.
  void leave_out(std::string_view name) { left_out_.emplace_back(name); }
  // Puts every file named before into the folder. Files of an existing folder that have other names stay.
  // There `last` goes first and comes last, so that a folder that has it is one whole set of files, also
  // where several programs write into it.
  void commit(std::string_view last);

 private:
  [[noreturn]] void fail(const std::error_code& error) const;

  std::string directory_;  // as the caller named it
  std::filesystem::path target_, temporary_;
  std::vector<std::string> names_, left_out_;
  std::optional<Leftover> leftover_;
};

}  // namespace bitspan
