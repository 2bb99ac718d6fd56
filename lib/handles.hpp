// SPDX-License-Identifier: Apache-2.0
// Handles are numbers that are never given twice, and not addresses: so a closed handle, or one of another
// kind, is found out without touching memory.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "lib/status.hpp"

namespace bitspan::capi {

// The next number, over all kinds of handles.
std::uintptr_t next_handle();

// The live objects of one kind. A call that works on an object keeps it alive, also where another thread
// closes its handle.
template <class Handle, class Object>
class Handles {
 public:
  explicit Handles(const char* kind) : kind_(kind) {}

  Handle* add(std::shared_ptr<Object> object) {
    const std::uintptr_t number = next_handle();
    const std::unique_lock lock(mutex_);
    objects_.emplace(number, std::move(object));
    return std::bit_cast<Handle*>(number);
  }
  // Throws BS_BAD_HANDLE. `function` is the caller's, for the message.
  std::shared_ptr<Object> find(const Handle* handle, const char* function) const {
    {
      const std::shared_lock lock(mutex_);
      const auto at = objects_.find(std::bit_cast<std::uintptr_t>(handle));
      if (at != objects_.end()) return at->second;
    }
    fail(BS_BAD_HANDLE, std::string(function) + ": " + kind_ +
                            (handle == nullptr ? ": is NULL" : ": is closed, or no such handle") +
                            "; expected a live " + kind_);
  }
  // Does nothing where the handle is not live. The object may end here, outside of the lock.
  void remove(const Handle* handle) {
    std::shared_ptr<Object> object;
    const std::unique_lock lock(mutex_);
    const auto at = objects_.find(std::bit_cast<std::uintptr_t>(handle));
    if (at == objects_.end()) return;
    object = std::move(at->second);
    objects_.erase(at);
  }

 private:
  const char* kind_;
  mutable std::shared_mutex mutex_;
  std::unordered_map<std::uintptr_t, std::shared_ptr<Object>> objects_;
};

}  // namespace bitspan::capi
