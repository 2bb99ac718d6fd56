// SPDX-License-Identifier: Apache-2.0
#include "study/claims.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>

namespace bitspan {
namespace {

// Such a lock belongs to the open file and not to the process, so two of them inside one program exclude each
// other, too.
bool lock(int file, short type, off_t start, off_t length) {
  struct ::flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  range.l_start = start;
  range.l_len = length;
  return ::fcntl(file, F_OFD_SETLK, &range) == 0 || (errno != EAGAIN && errno != EACCES);
}

// 60 bits of the hash; equal ones cost no more than a wait.
off_t byte_of(std::string_view hash) {
  std::uint64_t out = 0;
  const std::string_view digits = hash.substr(0, 15);
  std::from_chars(digits.data(), digits.data() + digits.size(), out, 16);
  return static_cast<off_t>(out);
}

// Behind all claims is a byte that everyone who has the file open shares.
constexpr off_t presence = off_t{1} << 60;

}  // namespace

Claims::Claims(const std::string& database)
    : path_(database + "-claims"), file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (file_ >= 0) lock(file_, F_RDLCK, presence, 1);
}

Claims::~Claims() {
  if (file_ < 0) return;
  if (lock(file_, F_WRLCK, 0, 0)) ::unlink(path_.c_str());
  ::close(file_);
}

bool Claims::take(std::string_view hash) { return file_ < 0 || lock(file_, F_WRLCK, byte_of(hash), 1); }

void Claims::give_back(std::string_view hash) {
  if (file_ >= 0) lock(file_, F_UNLCK, byte_of(hash), 1);
}

}  // namespace bitspan
