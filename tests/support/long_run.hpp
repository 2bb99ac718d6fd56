// SPDX-License-Identifier: Apache-2.0
// How much a heavy check does. tests/gate/run.py sets both variables.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <span>

namespace bitspan {

// The longest form: `./dev test --long`, or BITSPAN_LONG=1 in front of a test.
inline bool is_long_run() { return std::getenv("BITSPAN_LONG") != nullptr; }
// A short form, whose full form is one of the long tests: BITSPAN_GATE, a number that the commit chooses.
inline bool is_gate_run() { return std::getenv("BITSPAN_GATE") != nullptr; }

// Of numbered cases all; in the gate one of `parts`, by its number.
inline bool in_gate(std::size_t number, std::size_t parts) {
  return !is_gate_run() || number % parts == std::strtoull(std::getenv("BITSPAN_GATE"), nullptr, 10) % parts;
}
// All cases of an array, which must outlive the span; in the gate one of them, by its number.
template <class Cases>
auto in_gate(const Cases& cases) {
  const std::span all(std::data(cases), std::size(cases));
  if (!is_gate_run() || all.empty()) return all.subspan(0);
  return all.subspan(std::strtoull(std::getenv("BITSPAN_GATE"), nullptr, 10) % all.size(), 1);
}

}  // namespace bitspan
