// SPDX-License-Identifier: Apache-2.0
// Equality of numbers that a NaN and the sign of a zero count in.
#pragma once

#include <cstring>
#include <vector>

namespace bitspan {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace bitspan
