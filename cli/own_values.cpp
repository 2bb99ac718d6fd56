// SPDX-License-Identifier: Apache-2.0
#include "cli/own_values.hpp"

#include <numeric>

#include "engine/registry.hpp"

namespace bitspan {

std::uint64_t OwnValues::total() const {
  return std::accumulate(stages.begin(), stages.end(), frame + counters);
}

OwnValues own_values(const Comparison& pair, const Config& config, const Scene& scene) {
  OwnValues own;
  if (const EngineEntry& engine = find_engine(pair.other); engine.own) {
    const EngineOwn per = engine.own(config, scene);
    for (std::size_t t = 0; t < own.stages.size(); ++t)
      own.stages[t] = pair.stages[t].records * per.fields[t];
    own.frame = pair.frame.records * per.picture;
    own.counters = per.counters;
  } else {
    for (std::size_t t = 0; t < own.stages.size(); ++t) own.stages[t] = pair.stages[t].values;
    own.frame = pair.frame.values;
    own.counters = pair.counters.values;
  }
  return own;
}

}  // namespace bitspan
