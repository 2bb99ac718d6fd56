// SPDX-License-Identifier: Apache-2.0
// Which points other programs are measuring now, so that several work on one database and none does twice
// what another does.
#pragma once

#include <string>
#include <string_view>

namespace bitspan {

// A point is claimed by a lock on one byte of a file beside the database; which byte, its hash says. The
// system gives the lock back when the program ends, however it ends. Where the file system has no such locks,
// every claim succeeds: a point may then be measured twice, with the same result.
class Claims {
 public:
  explicit Claims(const std::string& database);  // the file is FILE-claims
  ~Claims();                                     // removes it where no other program has it open
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  bool take(std::string_view hash);  // false: another program has it
  void give_back(std::string_view hash);

 private:
  std::string path_;
  int file_ = -1;
};

}  // namespace bitspan
