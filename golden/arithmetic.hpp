// SPDX-License-Identifier: Apache-2.0
// Which floating-point type a stage computes in, as a run-time value.
#pragma once

#include <cstdint>
#include <string_view>

namespace bitspan::golden {

enum class Width : std::uint8_t { f64, x87, quad };

constexpr int significant_bits(Width width) {
  return width == Width::f64 ? 53 : width == Width::x87 ? 64 : 113;
}
constexpr std::string_view to_string(Width width) {
  return width == Width::f64 ? "double" : width == Width::x87 ? "long double" : "quad";
}

struct Arithmetic {
  Width width = Width::quad;
  bool checked = false;  // verify every sum and product; throws InexactError
};

}  // namespace bitspan::golden
