// SPDX-License-Identifier: Apache-2.0
// How many of the values compared come from the engine under test itself, and not from stages that it takes
// from the model.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "report/compare.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct OwnValues {
  std::array<std::uint64_t, record_types> stages{};
  std::uint64_t frame = 0, counters = 0;

  std::uint64_t total() const;
};

// Counts the values of the pair's second engine, `other`, by EngineEntry::own. golden, model and ideal
// compute every value. rtl computes what comes out of the Verilated ports (tb/engine_rtl.hpp), and dut:NAME
// what its map has. systemc calls the model's stage functions for every record; it counts its counters
// itself.
OwnValues own_values(const Comparison& pair, const Config& config, const Scene& scene);

}  // namespace bitspan
