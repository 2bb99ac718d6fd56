// SPDX-License-Identifier: Apache-2.0
#include "lib/status.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>
#include <utility>

#include "config/config.hpp"

namespace bitspan::capi {
namespace {

// Of a fixed size: it must hold a text where there is no memory.
thread_local std::array<char, 2048> last_error{};

void set_last_error(std::string_view text) noexcept {
  const std::size_t length = std::min(text.size(), last_error.size() - 1);
  std::memcpy(last_error.data(), text.data(), length);
  last_error[length] = '\0';
}

}  // namespace

void fail(bs_status status, std::string text) { throw Failure{status, std::move(text)}; }

bs_status report_exception() noexcept {
  try {
    throw;
  } catch (const Failure& failure) {
    set_last_error(failure.text);
    return failure.status;
  } catch (const InputError& error) {
    set_last_error(error.what());
    return BS_BAD_INPUT;
  } catch (const std::bad_alloc&) {
    set_last_error("out of memory; expected a smaller picture, scene or trace");
    return BS_NO_MEMORY;
  } catch (const std::exception& error) {
    set_last_error(error.what());
    return BS_INTERNAL;
  } catch (...) {
    set_last_error("an exception of unknown type; expected none");
    return BS_INTERNAL;
  }
}

void need(const void* pointer, const char* what) {
  if (pointer == nullptr) fail(BS_BAD_INPUT, std::string(what) + ": is NULL; expected a pointer");
}

}  // namespace bitspan::capi

const char* bs_last_error(void) { return bitspan::capi::last_error.data(); }
