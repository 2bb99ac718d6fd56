// SPDX-License-Identifier: Apache-2.0
// A unit with the channels `in` and `out` alone, which answers in the order in which it takes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
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

// A test of 10^8 transfers, for which StageBench has too much to do per clock.
struct UnitStream {
  // Writes the fields of the next transfer on `in`; false where there is none any more.
  std::function<bool(std::span<std::uint64_t> in)> offer;
  // Writes the fields that the next transfer on `out` must have. Called `count` times.
  std::function<void(std::span<std::uint64_t> out)> expect;
  std::uint64_t count = 0;  // transfers on `out`
};

// Runs a design without gaps and stalls until `count` transfers came out, and some clocks more. Returns the
// clocks until the last one. Throws std::logic_error where one comes out otherwise, is lost, doubled, or
// comes after the last.
std::uint64_t run_stream(const StageDesign& design, const UnitStream& stream);

// The number that fragment n brings along, through 32 bits.
constexpr std::uint64_t mark_of(std::uint64_t n) { return n * 0x9e3779b1 & 0xffffffff; }

}  // namespace bitspan
