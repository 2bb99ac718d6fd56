// Stage `span_setup`: a row to the increments of its span, with the per-row divide.
#pragma once

#include <functional>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// The modes with horizontal rows.
using SpanSetupStage = std::function<SpanRecord(const RowRecord&)>;
SpanSetupStage make_span_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

// const_depth_rows.
using PlaneSpanSetupStage = std::function<SpanRecord(const PlaneRecord&, const PlaneRowRecord&)>;
PlaneSpanSetupStage make_plane_span_setup(Arithmetic arithmetic, const Config& config,
                                          const Constants& constants);

}  // namespace bitspan::golden
