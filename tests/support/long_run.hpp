// SPDX-License-Identifier: Apache-2.0
// The long form of heavy checks: `./dev test --long`, or BITSPAN_LONG=1 in front of a test.
#pragma once

#include <cstdlib>

namespace bitspan {

inline bool is_long_run() { return std::getenv("BITSPAN_LONG") != nullptr; }

}  // namespace bitspan
