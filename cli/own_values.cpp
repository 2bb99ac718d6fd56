// SPDX-License-Identifier: Apache-2.0
#include "cli/own_values.hpp"

#include <numeric>

#include "tb/engine_rtl.hpp"

namespace bitspan {

std::uint64_t OwnValues::total() const {
  return std::accumulate(stages.begin(), stages.end(), frame + counters);
}

OwnValues own_values(const Comparison& pair, const Config& config) {
  OwnValues own;
  const auto stage = [&](RecordType type) -> std::uint64_t& {
    return own.stages[static_cast<std::size_t>(type)];
  };
  const auto records = [&](RecordType type) { return pair.stages[static_cast<std::size_t>(type)].records; };
  if (pair.other == "rtl") {
    stage(RecordType::span) = records(RecordType::span) * rtl_span_fields;
    stage(RecordType::fragment) = records(RecordType::fragment) * rtl_fragment_fields(config);
  } else if (pair.other == "systemc") {
    own.counters = pair.counters.values;
  } else {
    for (std::size_t t = 0; t < own.stages.size(); ++t) own.stages[t] = pair.stages[t].values;
    own.frame = pair.frame.values;
    own.counters = pair.counters.values;
  }
  return own;
}

}  // namespace bitspan
