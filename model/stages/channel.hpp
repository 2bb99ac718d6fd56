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
#include "model/channels.hpp"
#include "model/numeric/adder.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/light.hpp"
#include "model/stages/plane_walk.hpp"
#include "model/stages/setup.hpp"
#include "model/stages/setup_plane.hpp"
#include "model/stages/span.hpp"
#include "model/stages/span_setup.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// The registers of one channel in use.
struct ChannelForm {
  int number = 0;
  LineId line = LineId::count;
  bool homogeneous = false;
  bool span_divides = false;  // value is of the quotient by h + B
  Register vertex, walked, edge_step, edge_acc, edge, gradient, step, acc, value;
  Exact edge_offset, row_offset;
  Adder along_edge;         // edge_acc and edge_step
  Adder along_row;          // acc and step
  bool fits_int64 = false;  // what a fragment takes does, also on the grid of value
  // Where the span divides by R_pixel: bits that the product with m takes beyond acc, on every grid on the
  // way to value.
  int product_growth = 0;
  // For lanes of rows whose ends carry values.
  Narrowing at_edge;  // edge of edge_acc
  RowLine row;
  bool row_fits_lanes() const { return at_edge.fits_lanes && row.fits_lanes(); }
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
  Exact zmax;                  // 2^depth.bits - 1
  ReciprocalUnit pixel_unit;   // what m and e of a fragment stand for
  InverseDepth q;              // h + B of a fragment
  bool by_reciprocal = false;  // the span has m and e; else it divides
  LightStage light;            // of the channel light
  // Channels in the places of fields that depth and texture read, and those of light, by their place in
  // in_use; -1: none.
  int depth_at = -1, shades_at = -1, second_at = -1, normal_at = -1, light_at = -1, relief_at = -1;

  bool any() const { return !in_use.empty(); }
  bool fits_int64() const { return std::ranges::all_of(in_use, &ChannelForm::fits_int64); }
  bool rows_fit_lanes() const { return std::ranges::all_of(in_use, &ChannelForm::row_fits_lanes); }
  int size() const { return static_cast<int>(in_use.size()); }
  // In in_use; -1: none.
  int place_of(LineId line) const {
    const auto at = std::ranges::find(in_use, line, &ChannelForm::line);
    return at == in_use.end() ? -1 : static_cast<int>(at - in_use.begin());
  }
};
// Divides of an edge that has height, and of a row that has a length, beside those of the other lines.
std::uint64_t divides_of_edge(const ChannelStage& stage);
std::uint64_t divides_of_row(const ChannelStage& stage);
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

// The accumulator of an edge (0, 1 or 2) on the first row that it may have pixels in.
template <class Watch = NoObserve>
ChannelEdge start_edge(const ChannelStage& stage, const TriangleChannels& triangle, std::size_t channel,
                       std::int64_t edge, Watch watch = {});
// What an edge adds to it per row.
inline std::int64_t edge_step(const SetupChannelRecord& record, std::int64_t edge) {
  return edge == 0 ? record.step0 : edge == 1 ? record.step1 : record.step2;
}

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

// The fragment as depth and the first texture unit read it, with the channels that stand for its fields; and
// as the second unit does. `own` holds a copy where there are some.
inline const FragmentRecord& as_drawn(const ChannelStage& stage, const FragmentRecord& fragment,
                                      const FragmentChannels* channels, FragmentRecord& own) {
  if (stage.depth_at < 0 && stage.shades_at < 0) return fragment;
  own = fragment;
  const auto w = [&](int at) { return (*channels)[static_cast<std::size_t>(at)].w; };
  if (stage.depth_at >= 0) own.h = w(stage.depth_at);
  for (int c = 0; c < channel_count && stage.shades_at >= 0; ++c) {
    own.*fragment_shades[static_cast<std::size_t>(c)] = w(stage.shades_at + c);
  }
  return own;
}
inline const FragmentRecord& as_second(const ChannelStage& stage, const FragmentRecord& fragment,
                                       const FragmentChannels* channels, FragmentRecord& own) {
  if (stage.second_at < 0) return fragment;
  own = fragment;
  own.u = (*channels)[static_cast<std::size_t>(stage.second_at)].w;
  own.v = (*channels)[static_cast<std::size_t>(stage.second_at) + 1].w;
  return own;
}

// What light takes.
inline LightChannels light_channels(const ChannelStage& stage, const FragmentRecord& fragment,
                                    const FragmentChannels* channels) {
  LightChannels out;
  const auto w = [&](int at) { return (*channels)[static_cast<std::size_t>(at)].w; };
  if (stage.normal_at >= 0) out.normal = {w(stage.normal_at), w(stage.normal_at + 1), w(stage.normal_at + 2)};
  if (stage.light_at >= 0) out.value = w(stage.light_at);
  if (stage.relief_at >= 0) {
    out.place = {w(stage.relief_at), w(stage.relief_at + 1), w(stage.relief_at + 2)};
    out.at = {stage.second_at >= 0 ? w(stage.second_at) : fragment.u,
              stage.second_at >= 0 ? w(stage.second_at + 1) : fragment.v};
  }
  return out;
}

// The value of a channel that is in use.
std::int64_t channel_value(const FragmentChannels& channels, LineId line);

}  // namespace bitspan::model
