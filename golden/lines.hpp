// SPDX-License-Identifier: Apache-2.0
// The lines of config/lines.hpp in golden: which ones a triangle has, and the fields that hold the fixed
// ones.
#pragma once

#include <array>
#include <vector>

#include "config/lines.hpp"
#include "engine/records.hpp"

namespace bitspan::golden {

constexpr std::size_t index_of(LineId id) { return static_cast<std::size_t>(id); }
constexpr bool is_channel(LineId id) { return index_of(id) >= fixed_lines; }
constexpr std::int64_t channel_of(LineId id) { return static_cast<std::int64_t>(id) - fixed_lines; }

// u and v where their numerators are walked: the stages that walk them divide by h + B, too. A channel is
// divided at the pixel alone, by span or by its consumer.
constexpr bool is_divided(const Line& line) { return line.is_homogeneous() && !is_channel(line.id); }

// What a line is walked from: a vertex of a fixed line, whose numerators its stages form anew; what
// setup.channel has of a channel.
constexpr FormatId walked_from(const Line& line) { return is_channel(line.id) ? line.walked() : line.vertex; }

// The lines of a triangle, in their order; channels: those in use.
inline std::vector<Line> lines_of(const Config& config, const std::vector<LineId>& channels = {}) {
  std::vector<Line> out;
  for (int i = 0; i < fixed_lines; ++i) out.push_back(line_of(static_cast<LineId>(i), config.perspective));
  for (const LineId id : channels) out.push_back(line_of(id, config.perspective));
  return out;
}

template <class Record>
using FieldOf = std::int64_t Record::*;

// The fields of a fixed line, by its place in the table; null where a record has none for it.
struct EdgeFields {
  FieldOf<EdgeRecord> step, difference = nullptr;
};
inline constexpr std::array<EdgeFields, fixed_lines> edge_fields{{
    {&EdgeRecord::h_step},
    {&EdgeRecord::fu_step, &EdgeRecord::fu_diff},
    {&EdgeRecord::fv_step, &EdgeRecord::fv_diff},
    {&EdgeRecord::r_step},
    {&EdgeRecord::g_step},
    {&EdgeRecord::b_step},
    {&EdgeRecord::a_step},
}};

// A row's ends: the accumulator of the edge, and what is kept of it.
struct RowFields {
  FieldOf<RowRecord> l_acc, l, r_acc, r;
};
inline constexpr std::array<RowFields, fixed_lines> row_fields{{
    {&RowRecord::l_h_acc, &RowRecord::l_h, &RowRecord::r_h_acc, &RowRecord::r_h},
    {&RowRecord::l_fu, &RowRecord::l_u, &RowRecord::r_fu, &RowRecord::r_u},
    {&RowRecord::l_fv, &RowRecord::l_v, &RowRecord::r_fv, &RowRecord::r_v},
    {&RowRecord::l_r_acc, &RowRecord::l_r, &RowRecord::r_r_acc, &RowRecord::r_r},
    {&RowRecord::l_g_acc, &RowRecord::l_g, &RowRecord::r_g_acc, &RowRecord::r_g},
    {&RowRecord::l_b_acc, &RowRecord::l_b, &RowRecord::r_b_acc, &RowRecord::r_b},
    {&RowRecord::l_a_acc, &RowRecord::l_a, &RowRecord::r_a_acc, &RowRecord::r_a},
}};

// A plane's gradients, and the numerators at its vertices; base: what is taken off u or v in front of them.
template <class Record>
struct PlaneFields {
  FieldOf<Record> x, y;
  std::array<FieldOf<Record>, 3> at_vertex{};
  FieldOf<Record> base = nullptr;
};
inline constexpr std::array<PlaneFields<SetupPlaneRecord>, fixed_lines> setup_plane_fields = [] {
  using P = SetupPlaneRecord;
  return std::array<PlaneFields<P>, fixed_lines>{{
      {&P::h_x, &P::h_y},
      {&P::fu_x, &P::fu_y, {&P::fu0, &P::fu1, &P::fu2}, &P::u1},
      {&P::fv_x, &P::fv_y, {&P::fv0, &P::fv1, &P::fv2}, &P::v1},
      {&P::r_x, &P::r_y},
      {&P::g_x, &P::g_y},
      {&P::b_x, &P::b_y},
      {&P::a_x, &P::a_y},
  }};
}();
inline constexpr std::array<PlaneFields<PlaneRecord>, fixed_lines> plane_fields = [] {
  using P = PlaneRecord;
  return std::array<PlaneFields<P>, fixed_lines>{{
      {&P::h_x, &P::h_y},
      {&P::gu_x, &P::gu_y, {&P::gu0, &P::gu1, &P::gu2}},
      {&P::gv_x, &P::gv_y, {&P::gv0, &P::gv1, &P::gv2}},
      {&P::r_x, &P::r_y},
      {&P::g_x, &P::g_y},
      {&P::b_x, &P::b_y},
      {&P::a_x, &P::a_y},
  }};
}();

// A row's first value and its steps. h has one step along a row, and none along a row of constant depth.
struct PlaneRowFields {
  FieldOf<PlaneRowRecord> start, step0 = nullptr, step1 = nullptr;
};
inline constexpr std::array<PlaneRowFields, fixed_lines> plane_row_fields{{
    {&PlaneRowRecord::h},
    {&PlaneRowRecord::gu, &PlaneRowRecord::gu_step0, &PlaneRowRecord::gu_step1},
    {&PlaneRowRecord::gv, &PlaneRowRecord::gv_step0, &PlaneRowRecord::gv_step1},
    {&PlaneRowRecord::r, &PlaneRowRecord::r_step0, &PlaneRowRecord::r_step1},
    {&PlaneRowRecord::g, &PlaneRowRecord::g_step0, &PlaneRowRecord::g_step1},
    {&PlaneRowRecord::b, &PlaneRowRecord::b_step0, &PlaneRowRecord::b_step1},
    {&PlaneRowRecord::a, &PlaneRowRecord::a_step0, &PlaneRowRecord::a_step1},
}};
struct SpanFields {
  FieldOf<SpanRecord> start, step0, step1, difference = nullptr, base = nullptr;
};
inline constexpr std::array<SpanFields, fixed_lines> span_fields = [] {
  using S = SpanRecord;
  return std::array<SpanFields, fixed_lines>{{
      {&S::h, &S::h_step, &S::h_step},
      {&S::fu, &S::fu_step0, &S::fu_step1, &S::fu_diff, &S::u1},
      {&S::fv, &S::fv_step0, &S::fv_step1, &S::fv_diff, &S::v1},
      {&S::r, &S::r_step0, &S::r_step1},
      {&S::g, &S::g_step0, &S::g_step1},
      {&S::b, &S::b_step0, &S::b_step1},
      {&S::a, &S::a_step0, &S::a_step1},
  }};
}();

inline constexpr std::array<FieldOf<SetupChannelRecord>, 3> channel_vertices{
    &SetupChannelRecord::w0, &SetupChannelRecord::w1, &SetupChannelRecord::w2};
inline constexpr std::array<FieldOf<SetupChannelRecord>, 3> channel_products{
    &SetupChannelRecord::f0, &SetupChannelRecord::f1, &SetupChannelRecord::f2};
inline constexpr std::array<FieldOf<SetupChannelRecord>, 3> channel_steps{
    &SetupChannelRecord::step0, &SetupChannelRecord::step1, &SetupChannelRecord::step2};

// A pixel's registers. What finish() of the stage makes of a shade stands in the same field.
inline constexpr std::array<FieldOf<FragmentRecord>, fixed_lines> fragment_fields{
    &FragmentRecord::h, &FragmentRecord::fu, &FragmentRecord::fv, &FragmentRecord::r,
    &FragmentRecord::g, &FragmentRecord::b,  &FragmentRecord::a};

}  // namespace bitspan::golden
