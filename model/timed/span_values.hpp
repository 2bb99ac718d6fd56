// SPDX-License-Identifier: Apache-2.0
// The values of span_setup and span in a timed run, for both modes: each calls the stage function, counts its
// events and delivers its record. The other stages' values stand beside their clocks, in the stage's own
// file.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

// The digital line of a row, for start_span; null where it is horizontal.
const model::PlaneGeometry* geometry_of(const Run& run, const RowItem& item);
// edge_walk's, plane_walk's or line_walk's record is there. Throws std::logic_error where the span has not
// the row's pixels.
void span_setup_values(Run& run, RowItem& item);
// The next fragment of the row; not where the state is finished.
void span_values(Run& run, RowItem& row, model::SpanState& state, FragmentItem& item);

}  // namespace bitspan::timed
