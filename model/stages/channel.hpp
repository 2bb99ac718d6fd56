// SPDX-License-Identifier: Apache-2.0
// The channels: what is interpolated beside the fields of setup, edge_walk, span_setup and span, each from
// the record of that stage that it belongs to. docs/numeric-spec.md, "Channels" (F4).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "config/lines.hpp"
#include "engine/records.hpp"
#include "model/numeric/adder.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/plane_walk.hpp"
#include "model/stages/setup.hpp"
#include "model/stages/setup_plane.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// The registers of one channel in use.
struct ChannelForm {
  int number = 0;
  LineId line = LineId::count;
  bool homogeneous = false;
  Register vertex, walked, edge_step, edge_acc, edge, gradient, step, acc, value;
  Exact edge_offset, row_offset;
  Adder along_row;          // acc and step
  bool fits_int64 = false;  // what a fragment takes does, also on the grid of value
};

struct ChannelStage {
  std::vector<ChannelForm> in_use;
  bool const_depth_rows = false, by_plane = false;
  SlopeForm edge_form = SlopeForm::divide, row_form = SlopeForm::divide;
  ReciprocalUnit edge_unit, row_unit;  // what m and e of an edge, a plane or a row stand for
  int subpixel_bits = 0;
  Register coordinate, vertex_h, x;
  Exact b;
  double fog_distance = 1;     // of the scene
  int projector_exponent = 0;  // X, Y and W are divided by 2^this

  bool any() const { return !in_use.empty(); }
  bool fits_int64() const { return std::ranges::all_of(in_use, &ChannelForm::fits_int64); }
  int size() const { return static_cast<int>(in_use.size()); }
};
ChannelStage prepare_channels(const Config& config, const Constants& constants, const Scene& scene);

// By the place of a channel in in_use.
template <class T>
using PerChannel = std::array<T, channel_limit>;

// A line along one edge.
struct ChannelEdge {
  bool started = false;
  std::int64_t y = 0, acc = 0;  // the row that it stands on
};
// The channels of a triangle, and its edges as they are walked.
struct TriangleChannels {
  SetupRecord setup;
  PerChannel<SetupChannelRecord> record;
  PerChannel<std::array<ChannelEdge, 3>> edges;
  int divides = 0;  // of edges or of the plane
};
using RowChannels = PerChannel<RowChannelRecord>;
struct SpanChannels {
  PerChannel<SpanChannelRecord> record;
  int divides = 0;  // of the row
};
using FragmentChannels = PerChannel<FragmentChannelRecord>;

// setup: of the same triangle. edges: of the modes with horizontal rows, whose m and e are taken; plane: with
// slope.row = plane; else null.
template <class Watch = NoObserve>
TriangleChannels setup_channels(const ChannelStage& stage, const Triangle& triangle, const SetupRecord& setup,
                                const Edges* edges, const TrianglePlane* plane, Watch watch = {});

// Of a row whose ends carry values, in the order of the triangle's rows.
template <class Watch = NoObserve>
RowChannels row_channels(const ChannelStage& stage, TriangleChannels& triangle, const RowRecord& row,
                         Watch watch = {});

// Of the span of a row. row, ends: of a row whose ends carry values, else null. geometry: const_depth_rows,
// else null.
template <class Watch = NoObserve>
SpanChannels span_channels(const ChannelStage& stage, const TriangleChannels& triangle,
                           const SpanRecord& span, const RowRecord* row, const RowChannels* ends,
                           const PlaneGeometry* geometry, Watch watch = {});

// Along a span: the channels of its fragments, from the first one on.
struct ChannelWalk {
  const PlaneGeometry* geometry = nullptr;  // const_depth_rows, else null; it must outlive the walk
  PerChannel<SpanChannelRecord> span;       // w: of the fragment before
  bool started = false;
  std::int64_t x = 0, y = 0;  // of the fragment before
};
template <class Watch = NoObserve>
FragmentChannels fragment_channels(const ChannelStage& stage, ChannelWalk& walk,
                                   const FragmentRecord& fragment, Watch watch = {});

// The value of a channel that is in use.
std::int64_t channel_value(const FragmentChannels& channels, LineId line);

}  // namespace bitspan::model
