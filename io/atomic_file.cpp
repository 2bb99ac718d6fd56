// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "config/config.hpp"

namespace bitspan {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 16;

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(path) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (path.empty()) fail(ENOENT);
  if (fs::is_symlink(path, code)) {
    const fs::path resolved = fs::weakly_canonical(path, code);
    if (!code) target_ = resolved.string();
  }
  struct stat info {};
  const bool exists = ::stat(target_.c_str(), &info) == 0;
  if (!exists && errno != ENOENT) fail(errno);  // such as a name too long
  if (exists && S_ISDIR(info.st_mode)) fail(EISDIR);
  if (exists && !S_ISREG(info.st_mode)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  // Renaming would replace a file that the user protected from writing.
  if (exists && ::access(target_.c_str(), W_OK) != 0) fail(errno);
  while (descriptor_ < 0) {
    const std::string name = temporary_path(fs::path(target_).parent_path()).string();
    leftover_.emplace(name);
    descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) {
      temporary_ = name;
    } else if (errno != EEXIST) {
      fail(errno);
    }
  }
  if (exists && ::fchmod(descriptor_, info.st_mode & 07777) != 0) {
    const int error_number = errno;
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
    fail(error_number);
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::fail(int error_number) const {
  throw InputError((path_.empty() ? "(empty name)" : path_) + ": cannot write: " +
                   std::strerror(error_number) + "; expected a file name in a folder that can be written");
}

void AtomicFile::write_all(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

void AtomicFile::flush() {
  write_all(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void AtomicFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > buffer_bytes) flush();
  if (bytes.size() >= buffer_bytes) {
    write_all(bytes.data(), bytes.size());
  } else {
    buffer_.append(bytes);
  }
}

void AtomicFile::write(std::span<const std::uint8_t> bytes) {
  write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void AtomicFile::commit() {
  flush();
  // Errors of delayed writing (a full disk over a network) show on close.
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void check_writable(const std::string& path) {
  struct stat info {};
  const bool special = ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
  // A pipe's reader would see its end.
  if (path.empty() || (special && ::access(path.c_str(), W_OK) == 0)) return;
  const AtomicFile file(path);
}

void make_writable_folder(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw InputError(path + ": cannot write: " + error.message() + "; expected a folder");
  check_writable((fs::path(path) / "written").string());
}

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  write_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace bitspan
