// SPDX-License-Identifier: Apache-2.0
// Stage `span_setup`: makes the start values and increments of a span from a row, with the divide per row.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// The first two append a record per channel in use.

// For the modes with horizontal rows.
using SpanSetupStage = std::function<SpanRecord(const RowRecord&, std::span<const RowChannelRecord>,
                                                std::vector<SpanChannelRecord>&)>;
SpanSetupStage make_span_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

// The same with slope.row = plane, by the triangle's setup records.
using TriangleSpanSetupStage =
    std::function<SpanRecord(const RowRecord&, const SetupRecord&, const SetupPlaneRecord&,
                             std::span<const SetupChannelRecord>, std::vector<SpanChannelRecord>&)>;
TriangleSpanSetupStage make_triangle_span_setup(Arithmetic arithmetic, const Config& config,
                                                const Constants& constants);

// For const_depth_rows, where plane_walk has formed the channels.
using PlaneSpanSetupStage = std::function<SpanRecord(const PlaneRecord&, const PlaneRowRecord&)>;
PlaneSpanSetupStage make_plane_span_setup(Arithmetic arithmetic, const Config& config,
                                          const Constants& constants);

}  // namespace bitspan::golden
