// SPDX-License-Identifier: Apache-2.0
// FNV-1a: a name for a content, the same on every machine. Not for contents made to collide.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace bitspan {

// Of 64 bits; `bytes` is any range of bytes.
std::uint64_t fnv64(const auto& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const auto byte : bytes) hash = (hash ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3U;
  return hash;
}

// Of 128 bits.
class Fnv128 {
 public:
  void byte(std::uint8_t value) {
    state_ ^= value;
    state_ *= (static_cast<unsigned __int128>(1) << 88) + 0x13b;
  }
  // In an order of bytes that does not depend on the machine.
  void number(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void number(int value) { number(static_cast<std::uint64_t>(value)); }
  void number(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  // With its length, so that the borders of texts count.
  void text(std::string_view text) {
    number(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) byte(static_cast<std::uint8_t>(c));
  }
  // 32 digits.
  std::string hex() const {
    char digits[33];
    std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(state_ >> 64),
                  static_cast<unsigned long long>(state_));
    return digits;
  }

 private:
  unsigned __int128 state_ =
      (static_cast<unsigned __int128>(0x6c62272e07bb0142U) << 64) | 0x62b821756295c58dU;
};

}  // namespace bitspan
