// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "config/config.hpp"

namespace bitspan {

namespace fs = std::filesystem;

AtomicFolder::AtomicFolder(const std::string& directory)
    : directory_(directory), target_(fs::absolute(directory).lexically_normal()) {
  if (target_.filename().empty()) target_ = target_.parent_path();  // a trailing slash
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InputError(directory + ": cannot write: it is not a folder");
  }
  std::string name = target_.filename().string();
  name = (target_.parent_path() / std::string(".").append(name).append(".XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) {
    throw InputError(target_.string() + ": cannot write: " + std::strerror(errno));
  }
  chmod(name.c_str(), 0755);
  temporary_ = name;
}

AtomicFolder::~AtomicFolder() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

std::string AtomicFolder::path(std::string_view name) {
  names_.emplace_back(name);
  return (temporary_ / name).string();
}

void AtomicFolder::commit(std::string_view last) {
  std::error_code error;
  if (!fs::exists(target_)) {
    fs::rename(temporary_, target_, error);
    if (error) throw InputError(directory_ + ": cannot write: " + error.message());
    temporary_.clear();
    return;
  }
  const auto move = [&](std::string_view name) {
    fs::rename(temporary_ / name, target_ / name, error);
    if (error) throw InputError(directory_ + ": cannot write " + std::string(name) + ": " + error.message());
  };
  fs::remove(target_ / last, error);
  for (const std::string& name : names_) {
    if (name != last) move(name);
  }
  move(last);
}

}  // namespace bitspan
