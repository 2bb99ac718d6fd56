// SPDX-License-Identifier: Apache-2.0
// Colour and alpha are four fields with one arithmetic: their members by channel, red, green, blue, alpha.
#pragma once

#include <array>
#include <cstdint>

#include "engine/records.hpp"

namespace bitspan::model {

inline constexpr int channel_count = 4;
template <class R>
using Channels = std::array<std::int64_t R::*, channel_count>;

inline constexpr Channels<EdgeRecord> edge_steps{&EdgeRecord::r_step, &EdgeRecord::g_step,
                                                 &EdgeRecord::b_step, &EdgeRecord::a_step};
inline constexpr Channels<PlaneRecord> plane_x{&PlaneRecord::r_x, &PlaneRecord::g_x, &PlaneRecord::b_x,
                                               &PlaneRecord::a_x};
inline constexpr Channels<PlaneRecord> plane_y{&PlaneRecord::r_y, &PlaneRecord::g_y, &PlaneRecord::b_y,
                                               &PlaneRecord::a_y};
inline constexpr Channels<SetupPlaneRecord> setup_plane_x{&SetupPlaneRecord::r_x, &SetupPlaneRecord::g_x,
                                                          &SetupPlaneRecord::b_x, &SetupPlaneRecord::a_x};
inline constexpr Channels<SetupPlaneRecord> setup_plane_y{&SetupPlaneRecord::r_y, &SetupPlaneRecord::g_y,
                                                          &SetupPlaneRecord::b_y, &SetupPlaneRecord::a_y};
inline constexpr Channels<PlaneRowRecord> plane_row_starts{&PlaneRowRecord::r, &PlaneRowRecord::g,
                                                           &PlaneRowRecord::b, &PlaneRowRecord::a};
inline constexpr Channels<PlaneRowRecord> plane_row_steps0{
    &PlaneRowRecord::r_step0, &PlaneRowRecord::g_step0, &PlaneRowRecord::b_step0, &PlaneRowRecord::a_step0};
inline constexpr Channels<PlaneRowRecord> plane_row_steps1{
    &PlaneRowRecord::r_step1, &PlaneRowRecord::g_step1, &PlaneRowRecord::b_step1, &PlaneRowRecord::a_step1};
inline constexpr Channels<SpanRecord> span_starts{&SpanRecord::r, &SpanRecord::g, &SpanRecord::b,
                                                  &SpanRecord::a};
inline constexpr Channels<SpanRecord> span_steps0{&SpanRecord::r_step0, &SpanRecord::g_step0,
                                                  &SpanRecord::b_step0, &SpanRecord::a_step0};
inline constexpr Channels<SpanRecord> span_steps1{&SpanRecord::r_step1, &SpanRecord::g_step1,
                                                  &SpanRecord::b_step1, &SpanRecord::a_step1};
inline constexpr Channels<FragmentRecord> fragment_shades{&FragmentRecord::r, &FragmentRecord::g,
                                                          &FragmentRecord::b, &FragmentRecord::a};

}  // namespace bitspan::model
