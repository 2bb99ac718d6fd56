// SPDX-License-Identifier: Apache-2.0
// The pipeline in one table: each record that a stage makes, what one such record stands for, the records
// that it is made from, and the clock that the timed model makes it by.
//
// Engines, checkers and documents follow this table in what exists. How a value is computed is each engine's
// own.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "config/stages.hpp"

namespace bitspan {

// What there is one record for; `change` is a change of draw state.
enum class Per : std::uint8_t { scene, change, triangle, edge, row, pixel };

inline constexpr std::optional<Stage> no_clock;

// The lists read as tables.
// clang-format off

// ROW(X, record, fields, name, member, clock, per, made from ...), in the order of the pipeline:
//   record     the struct, and
//   fields     the list of its fields: both in engine/records.hpp
//   name       the stage's; STAGE.PART for the second record of a stage
//   member     the records' vector in Trace, and their RecordType
//   clock      Stage::NAME, or no_clock for what is made before the first clock
//   per        what there is one record for; of STAGE.channel, per channel in use
//   made from  the RecordTypes that feed it, in the order of the pipeline; of those of a mode, the ones that it has
#define BITSPAN_STAGE_TABLE(ROW, X)                                                                                     \
  ROW(X, ConstantsRecord, BITSPAN_CONSTANTS_RECORD, "constants",      constants, no_clock,          scene)              \
  ROW(X, StateRecord,     BITSPAN_STATE_RECORD,     "state",          state,     no_clock,          change,   constants) \
  ROW(X, SetupRecord,     BITSPAN_SETUP_RECORD,     "setup",          setup,     Stage::setup,      triangle, constants) \
  ROW(X, EdgeRecord,      BITSPAN_EDGE_RECORD,      "setup.edge",     edge,      Stage::setup,      edge,     setup)     \
  ROW(X, GradientRecord,  BITSPAN_GRADIENT_RECORD,  "setup.gradient", gradient,  Stage::setup,      triangle, setup)     \
  ROW(X, SetupPlaneRecord, BITSPAN_SETUP_PLANE_RECORD, "setup.plane",  setup_plane, Stage::setup,    triangle, setup)     \
  ROW(X, SetupChannelRecord, BITSPAN_SETUP_CHANNEL_RECORD, "setup.channel", setup_channel, Stage::setup, triangle, setup, setup_plane) \
  ROW(X, RowRecord,       BITSPAN_ROW_RECORD,       "edge_walk",      row,       Stage::edge_walk,  row,      edge)      \
  ROW(X, RowChannelRecord, BITSPAN_ROW_CHANNEL_RECORD, "edge_walk.channel", row_channel, Stage::edge_walk, row, setup_channel, row) \
  ROW(X, PlaneRecord,     BITSPAN_PLANE_RECORD,     "plane_walk",     plane,     Stage::edge_walk,  triangle, setup)     \
  ROW(X, PlaneRowRecord,  BITSPAN_PLANE_ROW_RECORD, "plane_walk.row", plane_row, Stage::edge_walk,  row,      plane)     \
  ROW(X, LineWalkRecord,  BITSPAN_LINE_WALK_RECORD, "line_walk",      line_walk, Stage::edge_walk,  triangle, setup)     \
  ROW(X, SpanRecord,      BITSPAN_SPAN_RECORD,      "span_setup",     span,      Stage::span_setup, row,      setup_plane, row, plane_row, line_walk) \
  ROW(X, SpanChannelRecord, BITSPAN_SPAN_CHANNEL_RECORD, "span_setup.channel", span_channel, Stage::span_setup, row, setup_channel, row_channel, span) \
  ROW(X, FragmentRecord,  BITSPAN_FRAGMENT_RECORD,  "span",           fragment,  Stage::span,       pixel,    span)      \
  ROW(X, FragmentChannelRecord, BITSPAN_FRAGMENT_CHANNEL_RECORD, "span.channel", fragment_channel, Stage::span, pixel, span_channel, fragment) \
  ROW(X, DepthRecord,     BITSPAN_DEPTH_RECORD,     "depth",          depth,     Stage::depth,      pixel,    gradient, fragment, fragment_channel) \
  ROW(X, StencilRecord,   BITSPAN_STENCIL_RECORD,   "stencil",        stencil,   Stage::depth,      pixel,    fragment, depth) \
  ROW(X, DistanceRecord,  BITSPAN_DISTANCE_RECORD,  "distance",       distance,  Stage::depth,      pixel,    fragment, depth) \
  ROW(X, LodRecord,       BITSPAN_LOD_RECORD,       "lod",            lod,       Stage::depth,      pixel,    gradient, fragment, depth, distance) \
  ROW(X, ProjectRecord,   BITSPAN_PROJECT_RECORD,   "project",        project,   Stage::depth,      pixel,    fragment, fragment_channel) \
  ROW(X, TextureRecord,   BITSPAN_TEXTURE_RECORD,   "texture",        texture,   Stage::texture,    pixel,    fragment, fragment_channel, depth, lod) \
  ROW(X, TextureSecondRecord, BITSPAN_TEXTURE_SECOND_RECORD, "texture.second", texture_second, Stage::texture, pixel, fragment, fragment_channel, depth, lod, project, texture) \
  ROW(X, LightRecord,     BITSPAN_LIGHT_RECORD,     "light",          light,     Stage::fog,        pixel,    fragment, fragment_channel, distance, texture, texture_second) \
  ROW(X, FogRecord,       BITSPAN_FOG_RECORD,       "fog",            fog,       Stage::fog,        pixel,    fragment, fragment_channel, distance, texture, texture_second, light) \
  ROW(X, CandidateRecord, BITSPAN_CANDIDATE_RECORD, "candidate",      candidate, Stage::merge,      pixel,    depth, texture, texture_second, fog) \
  ROW(X, MergeRecord,     BITSPAN_MERGE_RECORD,     "merge",          merge,     Stage::merge,      pixel,    depth, texture, texture_second, fog, candidate) \
  ROW(X, MergeAlphaRecord, BITSPAN_MERGE_ALPHA_RECORD, "merge.alpha", merge_alpha, Stage::merge,    pixel,    merge)

// clang-format on

// X(record, fields, name, member) for each row.
#define BITSPAN_RECORDS(X) BITSPAN_STAGE_TABLE(BITSPAN_RECORD_OF_ROW, X)
#define BITSPAN_RECORD_OF_ROW(X, Record, LIST, name, member, ...) X(Record, LIST, name, member)

enum class RecordType : std::uint8_t {
#define BITSPAN_RECORD_TYPE(Record, LIST, name, member) member,
  BITSPAN_RECORDS(BITSPAN_RECORD_TYPE)
#undef BITSPAN_RECORD_TYPE
      count
};
inline constexpr int record_types = static_cast<int>(RecordType::count);

// The records that feed one.
class RecordTypes {
 public:
  constexpr RecordTypes(std::initializer_list<RecordType> types) : size_(types.size()) {
    std::copy(types.begin(), types.end(), types_.begin());
  }
  constexpr const RecordType* begin() const { return types_.data(); }
  constexpr const RecordType* end() const { return types_.data() + size_; }
  constexpr std::size_t size() const { return size_; }

 private:
  std::array<RecordType, record_types> types_{};  // each at most once
  std::size_t size_;
};

struct StageRow {
  RecordType type;
  std::string_view name;
  std::optional<Stage> clock;
  Per per;
  RecordTypes made_from;

  // The name without its part: the heading of docs/numeric-spec.md that defines the record.
  constexpr std::string_view stage() const { return name.substr(0, name.find('.')); }
  // There is one per channel in use of what `per` says.
  constexpr bool per_channel() const { return name.ends_with(".channel"); }
};

inline constexpr auto stage_table = [] {
  using enum RecordType;
#define BITSPAN_STAGE_ROW(X, Record, LIST, name, member, clock, per, ...) \
  StageRow{member, name, clock, Per::per, {__VA_ARGS__}},
  return std::array<StageRow, record_types>{BITSPAN_STAGE_TABLE(BITSPAN_STAGE_ROW, )};
#undef BITSPAN_STAGE_ROW
}();

constexpr const StageRow& row_of(RecordType type) { return stage_table[static_cast<std::size_t>(type)]; }

// Whether a configuration or a draw state switches the record on, so that a run without any has it off.
constexpr bool is_switched(RecordType type) {
  return type == RecordType::state || type == RecordType::gradient || type == RecordType::setup_plane ||
         type == RecordType::line_walk || type == RecordType::stencil || type == RecordType::distance ||
         type == RecordType::lod || type == RecordType::project || type == RecordType::texture_second ||
         type == RecordType::light || type == RecordType::candidate || type == RecordType::merge_alpha ||
         row_of(type).per_channel();
}

}  // namespace bitspan
