// SPDX-License-Identifier: Apache-2.0
// A unit that answers each fragment of the channel `in` on the channel `out`, in their order.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tests/rtl/stage_bench.hpp"

namespace bitspan {

// What is sent, and what has to come out for it.
struct Exchange {
  StageValues in, out;
};

struct UnitRun {
  std::size_t fragments = 0;
  std::uint64_t offered = 0, first_out = 0, last_out = 0;  // clocks
};

// Sends what `make` gives for fragments 0 to count - 1, each when the ones before are on their way. Throws
// std::logic_error with a text that ends in `about` where one comes out otherwise, is lost, doubled, or comes
// after the last.
UnitRun run_unit(StageBench& bench, const StageDesign& design, std::size_t count,
                 const std::function<Exchange(std::uint64_t)>& make, const std::string& about = "");

// The number that fragment n brings along, through 32 bits.
constexpr std::uint64_t mark_of(std::uint64_t n) { return n * 0x9e3779b1 & 0xffffffff; }

}  // namespace bitspan
