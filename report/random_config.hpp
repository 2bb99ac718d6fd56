// Random legal configurations for the fuzzer.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "config/config.hpp"

namespace bitspan {

struct RandomConfigOptions {
  bool rtl_only = false;  // only what the RTL can be built for
  // Further rules, of engines that hold less; throws InputError for what is to be drawn again. May be empty.
  std::function<void(const Config&)> check;
};

// A configuration that check_config accepts, made from one of `bases` by changing widths, rounding, overflow,
// modes, reciprocal units and start offsets. Formats may overflow on the scenes drawn with it, and say so
// (overflow_expected). The same seed, bases and options give the same configuration. Its name is
// "random-SEED". bases: at least one, each legal.
Config random_config(std::uint64_t seed, std::span<const Config> bases,
                     const RandomConfigOptions& options = {});

}  // namespace bitspan
