// SPDX-License-Identifier: Apache-2.0
// The stages that the timed model runs by a clock of their own, in the order of the pipeline. What each
// makes, and from what, stands in engine/stages.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "config/names.hpp"

namespace bitspan {

// Each has a section [timing.STAGE]. plane_walk takes the place of edge_walk in const_depth_rows, and its
// clock.
#define BITSPAN_STAGES(X) X(setup) X(edge_walk) X(span_setup) X(span) X(depth) X(texture) X(fog) X(merge)

#define BITSPAN_STAGE_ENUMERATOR(name) name,
#define BITSPAN_STAGE_NAME(name) #name,
enum class Stage : std::uint8_t { BITSPAN_STAGES(BITSPAN_STAGE_ENUMERATOR) count };
inline constexpr int stage_count = static_cast<int>(Stage::count);
inline constexpr std::array<std::string_view, stage_count> stage_names{BITSPAN_STAGES(BITSPAN_STAGE_NAME)};
template <>
inline constexpr auto enum_names<Stage> = stage_names;
#undef BITSPAN_STAGE_ENUMERATOR
#undef BITSPAN_STAGE_NAME

}  // namespace bitspan
