// SPDX-License-Identifier: Apache-2.0
// Stage `span_setup`: makes the start values and increments of a span from a row, with the divide per row.
#pragma once

#include <functional>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// For the modes with horizontal rows.
using SpanSetupStage = std::function<SpanRecord(const RowRecord&)>;
SpanSetupStage make_span_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

// The same with slope.row = plane, by the triangle's setup records.
using TriangleSpanSetupStage =
    std::function<SpanRecord(const RowRecord&, const SetupRecord&, const SetupPlaneRecord&)>;
TriangleSpanSetupStage make_triangle_span_setup(Arithmetic arithmetic, const Config& config);

// For const_depth_rows.
using PlaneSpanSetupStage = std::function<SpanRecord(const PlaneRecord&, const PlaneRowRecord&)>;
PlaneSpanSetupStage make_plane_span_setup(Arithmetic arithmetic, const Config& config,
                                          const Constants& constants);

}  // namespace bitspan::golden
