// SPDX-License-Identifier: Apache-2.0
// SystemC's five overflow modes, n_bits = 0.
#pragma once

#include <cstdint>

#include "model/numeric/exact.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

// What a register keeps of a rounded value that is out of its range. low: the value's low 128 bits, two's
// complement (so that a value of any size can be told); negative: its sign.
std::int64_t overflow(uint128 low, bool negative, const Register& r);

}  // namespace bitspan::model
