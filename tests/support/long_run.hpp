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

inline std::size_t gate_number() { return std::strtoull(std::getenv("BITSPAN_GATE"), nullptr, 10); }

// Of numbered cases all; in the gate one of `parts`, by its number.
inline bool in_gate(std::size_t number, std::size_t parts) {
  return !is_gate_run() || number % parts == gate_number() % parts;
}
// All cases of an array, which must outlive the span; in the gate one of them, by its number.
template <class Cases>
auto in_gate(const Cases& cases) {
  const std::span all(std::data(cases), std::size(cases));
  return !is_gate_run() || all.empty() ? all : all.subspan(gate_number() % all.size(), 1);
}

}  // namespace bitspan
