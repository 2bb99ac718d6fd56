// SPDX-License-Identifier: Apache-2.0
// The numbers of the interface's stages, and the record types that they stand for.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "engine/stages.hpp"
#include "lib/status.hpp"

namespace bitspan::capi {

// By the number. A record type may stand anywhere in the pipeline's table; its number here never changes.
inline constexpr std::array stage_types = [] {
  using enum RecordType;
  std::array<RecordType, record_types> types{};
  types.fill(count);
  types[BS_STAGE_CONSTANTS] = constants;
  types[BS_STAGE_SETUP] = setup;
  types[BS_STAGE_SETUP_EDGE] = edge;
  types[BS_STAGE_EDGE_WALK] = row;
  types[BS_STAGE_PLANE_WALK] = plane;
  types[BS_STAGE_PLANE_WALK_ROW] = plane_row;
  types[BS_STAGE_SPAN_SETUP] = span;
  types[BS_STAGE_SPAN] = fragment;
  types[BS_STAGE_DEPTH] = depth;
  types[BS_STAGE_TEXTURE] = texture;
  types[BS_STAGE_FOG] = fog;
  types[BS_STAGE_MERGE] = merge;
  types[BS_STAGE_STATE] = state;
  types[BS_STAGE_STENCIL] = stencil;
  types[BS_STAGE_MERGE_ALPHA] = merge_alpha;
  types[BS_STAGE_SETUP_GRADIENT] = gradient;
  types[BS_STAGE_LOD] = lod;
  types[BS_STAGE_DISTANCE] = distance;
  types[BS_STAGE_SETUP_PLANE] = setup_plane;
  types[BS_STAGE_TEXTURE_SECOND] = texture_second;
  types[BS_STAGE_SETUP_CHANNEL] = setup_channel;
  types[BS_STAGE_EDGE_WALK_CHANNEL] = row_channel;
  types[BS_STAGE_SPAN_SETUP_CHANNEL] = span_channel;
  types[BS_STAGE_SPAN_CHANNEL] = fragment_channel;
  types[BS_STAGE_PROJECT] = project;
  types[BS_STAGE_LIGHT] = light;
  types[BS_STAGE_CANDIDATE] = candidate;
  types[BS_STAGE_LINE_WALK] = line_walk;
  return types;
}();
static_assert(std::ranges::all_of(stage_table,
                                  [](const StageRow& row) {
                                    return std::ranges::count(stage_types, row.type) == 1;
                                  }),
              "every record type has a number in bitspan.h");

constexpr bool is_stage(bs_stage stage) { return stage >= 0 && stage < record_types; }

// Throws BS_BAD_INPUT where there is no such stage.
inline RecordType type_of(bs_stage stage, const char* function) {
  if (!is_stage(stage)) {
    fail(BS_BAD_INPUT, std::string(function) + ": stage: " + std::to_string(stage) +
                           " is no stage; expected 0 to " + std::to_string(record_types - 1));
  }
  return stage_types[static_cast<std::size_t>(stage)];
}

}  // namespace bitspan::capi
