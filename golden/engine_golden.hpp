// SPDX-License-Identifier: Apache-2.0
// The quantised golden: the stages of docs/numeric-spec.md in floating point, exact in front of every Q.
#pragma once

#include <memory>

#include "engine/engine.hpp"
#include "golden/precision.hpp"

namespace bitspan {

// Says whether make_golden verifies every sum and product: in builds with assertions and under a sanitizer.
bool golden_checks_by_default();

// Throws InputError where the configuration asks for more than 113 significant bits.
std::unique_ptr<Engine> make_golden(const Config& config);

// Does the same, and verifies every sum and product (slow) where `checked` is set.
std::unique_ptr<Engine> make_golden(const Config& config, bool checked);

// Does the same with types of the caller's choice, to show what they do; exact only where they have the bits.
std::unique_ptr<Engine> make_golden(const Config& config, const golden::Precision& precision, bool checked);

}  // namespace bitspan
