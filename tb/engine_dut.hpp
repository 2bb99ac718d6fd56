// SPDX-License-Identifier: Apache-2.0
// The engines `dut:NAME`: designs of the user's, whose ports a map binds to record fields (tb/dut_map.hpp).
//
// The model makes the records that the design is fed with. What the design delivers takes the place of the
// model's values in the records of the map's output stage; fields that no port carries are the model's.
// Behind span, the model goes on with the design's pixels; behind span_setup, with its own.
#pragma once

#include <string_view>

#include "engine/registry.hpp"

namespace bitspan {

inline constexpr std::string_view dut_prefix = "dut:";

// The entry of "dut:NAME", from the folder of designs (tb/dut_store.hpp). Throws InputError where there is no
// design of the name, or where what the folder holds is damaged.
EngineEntry dut_entry(std::string_view name);

}  // namespace bitspan
