// SPDX-License-Identifier: Apache-2.0
// Files that appear complete or not at all.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/leftovers.hpp"

namespace bitspan {

// Writes bytes to a temporary file in the target's folder; commit() renames it onto the target. Without
// commit() the destructor removes it, and the target stays as it was. A target that is a device or a pipe is
// written directly. A symbolic link is followed. All failures are InputError "path: cannot write: reason".
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void write(std::span<const std::uint8_t> bytes);
  // Puts all written bytes under the target's name before it returns. Call it at most once.
  void commit();

 private:
  [[noreturn]] void fail(int error_number) const;
  void write_all(const char* data, std::size_t size);
  void flush();

  std::string path_;       // as the caller named it
  std::string target_;     // links resolved
  std::string temporary_;  // empty: the target is written directly
  std::optional<Leftover> leftover_;
  std::string buffer_;
  int descriptor_ = -1;
};

void write_file(const std::string& path, std::string_view bytes);
// Throws InputError where an AtomicFile of this path could not be made now, and leaves nothing behind: for a
// command to refuse a bad output before its work. An empty path is no output.
void check_writable(const std::string& path);
// Creates the folder where it is not there. Throws InputError where no file can be written into it.
void make_writable_folder(const std::string& path);
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace bitspan
