// SPDX-License-Identifier: Apache-2.0
// Stage `plane_walk`: makes rows of constant depth from a triangle; const_depth_rows only. [N1, N2]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

struct PlaneRows {
  PlaneRecord plane;
  std::vector<PlaneRowRecord> rows;
  std::vector<SpanChannelRecord> channels;  // of each row, those in use
  std::vector<std::uint8_t> covered;        // 1 or 0 for each walked pixel, row after row

  // The stage works in these and keeps them from triangle to triangle. A Column holds the covered pixels of
  // one column of the major axis (minor coordinates first..last, none where first > last) and the digital
  // line there. An Extent holds the first and last column of a row.
  struct Column {
    std::int64_t first, last, line;
  };
  struct Extent {
    std::int64_t first, last;
  };
  std::vector<Column> columns;
  std::vector<Extent> extents;
};

// Takes a triangle, writes the gradients of its channels, and replaces what `out` held.
using PlaneWalkStage =
    std::function<void(const SetupRecord&, std::span<SetupChannelRecord> channels, PlaneRows& out)>;
PlaneWalkStage make_plane_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                               int width, int height);

}  // namespace bitspan::golden
