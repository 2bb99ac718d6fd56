// SPDX-License-Identifier: Apache-2.0
// From exceptions to what the C interface returns, and the text of the last failure.
#pragma once

#include <string>

#include "bitspan/bitspan.h"

namespace bitspan::capi {

// What a function of the interface throws, beside the InputError of the folders below.
struct Failure {
  bs_status status;
  std::string text;
};
[[noreturn]] void fail(bs_status status, std::string text);

// Turns the exception being handled into a status and this thread's last error.
bs_status report_exception() noexcept;

// Runs the body of a function of the interface.
template <class Body>
bs_status call(const Body& body) noexcept {
  try {
    body();
    return BS_OK;
  } catch (...) {
    return report_exception();
  }
}
// The same for one that returns a value, or `failed`.
template <class Value, class Body>
Value call_or(Value failed, const Body& body) noexcept {
  try {
    return body();
  } catch (...) {
    report_exception();
    return failed;
  }
}

// Throws BS_BAD_INPUT where a pointer is NULL; `what` is "bs_open: out".
void need(const void* pointer, const char* what);

}  // namespace bitspan::capi
