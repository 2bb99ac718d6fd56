// The values of a timed run: an item's records, stage by stage. Each calls the stage function, counts its
// events and keeps its record for the trace; what the clock does with it is the caller's affair. Both modes
// take their values from here, each stage in the order of its items.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

// False where the triangle has no area.
bool setup_values(Run& run, TriangleItem& item);
// edge_walk's or plane_walk's record is there. Throws std::logic_error where the span has not the row's
// pixels.
void span_setup_values(Run& run, RowItem& item);
// The next fragment of the row; not where the state is finished.
void span_values(Run& run, const RowItem& row, model::SpanState& state, FragmentItem& item);
// A covered fragment; false where it is behind.
bool depth_values(Run& run, FragmentItem& item);
// False where it is killed.
bool texture_values(Run& run, FragmentItem& item);
void fog_values(Run& run, FragmentItem& item);
// Writes the frame.
void merge_values(Run& run, FragmentItem& item);

}  // namespace bitspan::timed
