// SPDX-License-Identifier: Apache-2.0
// Random configurations and records for the tests of the RTL; the same seed gives the same ones.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "config/modes.hpp"
#include "engine/records.hpp"

namespace bitspan {

using Random = std::mt19937_64;

// Legal, with RTL, around config/depth16.toml; formats of any sign.
Config random_rtl_config(Random& random);

// Whether a design of the configuration has a mode of fog beside none and table.
inline bool has_other_mode(const Config& config) {
  return is_linear_in_distance(config.fog) || has_vertex_fog(config.fog);
}

// Raw values anywhere in the formats, ends of the ranges included; not what a scene would give.
std::int64_t random_raw(Random& random, const Format& format);
std::vector<RowRecord> random_rows(Random& random, const Config& config, int count, int longest);
std::vector<PlaneRowRecord> random_plane_rows(Random& random, const Config& config, int count, int longest);
// Of the channels that the configuration has: at the ends of a row, or where const_depth_rows starts.
std::vector<RowChannelRecord> random_ends(Random& random, const Config& config);
std::vector<SpanChannelRecord> random_starts(Random& random, const Config& config);
// A slope in -1..1 on plane.k, 0, 1 and -1 among them.
std::int64_t random_k(Random& random, const Config& config);

// One half, raw, where the format holds it.
std::optional<std::int64_t> half_of(const Format& format);

}  // namespace bitspan
