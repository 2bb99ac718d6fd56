// SPDX-License-Identifier: Apache-2.0
// What travels through the FIFOs of the timed model: an item is a triangle, a row or a fragment with the
// records made of it so far.
#pragma once

#include <cstdint>

#include "engine/records.hpp"
#include "model/pipeline.hpp"
#include "model/stages/plane_walk.hpp"
#include "model/stages/setup.hpp"
#include "scene/scene.hpp"

namespace bitspan::timed {

struct TriangleItem {
  const Triangle* triangle = nullptr;
  std::int64_t index = 0;
  SetupRecord setup;
  model::Edges edges;
};

struct RowItem {
  model::Surface surface;    // of its triangle
  std::int64_t count = 0;    // pixels
  RowRecord row;             // edge_walk
  PlaneRowRecord plane_row;  // plane_walk
  bool is_line = false;
  LineWalkRecord line;            // line_walk, of a line
  model::PlaneGeometry geometry;  // plane_walk; line_walk, of a line
  SpanRecord span;
  // Where channels are in use.
  model::RowChannels channels;      // of its ends
  model::ChannelWalk channel_walk;  // along its span
};

struct FragmentItem {
  model::Surface surface;
  bool holds_pixel = false;  // mode cycle: as in FragmentWork
  FragmentRecord fragment;
  model::FragmentChannels channels;  // where some are in use
  DepthRecord depth;
  DistanceRecord distance;
  StencilRecord stencil;  // with the stencil test
  LodRecord lod;
  LodRecord second_lod;     // of the second texture unit, while it is on
  ProjectRecord projected;  // while its coordinates are a projector's
  TextureRecord texel;      // behind both texture units, and light
  FogRecord fog;
};

}  // namespace bitspan::timed
