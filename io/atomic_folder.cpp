// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "config/config.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// Held by one program at a time. A file system that has no locks goes without.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    while (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace

AtomicFolder::AtomicFolder(const std::string& directory)
    : directory_(directory), target_(fs::absolute(directory).lexically_normal()) {
  if (target_.filename().empty()) target_ = target_.parent_path();  // a trailing slash
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InputError(directory + ": cannot write: it is not a folder");
  }
  if (status.type() == fs::file_type::none) fail(error);  // such as a name too long
  temporary_ = temporary_path(target_.parent_path());
  leftover_.emplace(temporary_.string());
  if (::mkdir(temporary_.c_str(), 0755) != 0) {
    const int error_number = errno;
    temporary_.clear();  // never another's
    fail({error_number, std::generic_category()});
  }
}

AtomicFolder::~AtomicFolder() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void AtomicFolder::fail(const std::error_code& error) const {
  throw InputError(directory_ + ": cannot write: " + error.message());
}

std::string AtomicFolder::path(std::string_view name) {
  names_.emplace_back(name);
  return (temporary_ / name).string();
}

void AtomicFolder::commit(std::string_view last) {
  std::error_code error;
  if (!fs::exists(target_)) {
    fs::rename(temporary_, target_, error);
    if (!error) {
      temporary_.clear();
      return;
    }
    if (!fs::is_directory(target_)) fail(error);  // else another program was the first
  }
  // Of two programs, the later one's files replace all of the other's.
  const FolderLock lock(target_);
  const auto move = [&](std::string_view name) {
    fs::rename(temporary_ / name, target_ / name, error);
    if (error) throw InputError(directory_ + ": cannot write " + std::string(name) + ": " + error.message());
  };
  fs::remove(target_ / last, error);
  for (const std::string& name : left_out_) fs::remove(target_ / name, error);
  for (const std::string& name : names_) {
    if (name != last) move(name);
  }
  move(last);
}

}  // namespace bitspan
