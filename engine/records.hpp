// SPDX-License-Identifier: Apache-2.0
// The records that pass between stages: names and formats, no arithmetic. engine/stages.hpp has the table of
// them.
//
// Golden, model, SystemC and RTL all deliver these, as raw integers on the field's format, and so can be
// compared bit for bit. A record is a plain struct of int64_t fields only; `fields<R>` names each of them and
// says how its raw value is decoded. docs/numeric-spec.md defines every field in the value domain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <ranges>
#include <span>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/stages.hpp"
#include "scene/draw_state.hpp"

namespace bitspan {

// How a raw field is decoded.
enum class FieldKind : std::uint8_t {
  integer,         // an index, a count, a flag: raw is the value
  format,          // on config.format(id)
  coordinate,      // on config.coordinate_format()
  depth_code,      // on config.depth_format()
  edge_mantissa,   // on config.edge_reciprocal.output
  row_mantissa,    // on config.row_reciprocal.output
  pixel_mantissa,  // on config.pixel_reciprocal.output
  phase,           // unsigned, no integer bits, the fraction bits of plane.k
  texture_acc,     // span.f in delta_f and hyperbolic, span.uv_acc in const_depth_rows and affine
  texture_step,    // span.f_step in delta_f and hyperbolic, span.uv_step in const_depth_rows and affine
  channel_vertex,  // on the registers of the record's channel, config/lines.hpp
  channel_product,
  channel_edge_step,
  channel_edge_acc,
  channel_edge,
  channel_gradient,
  channel_step,
  channel_acc,
  channel_value,
};

struct Field {
  std::string_view name;
  FieldKind kind;
  FormatId format;  // for FieldKind::format
};

// The register that holds a field, where it is one of [formats]; channel: of the record, which only records
// per channel have.
std::optional<FormatId> register_of(const Field& field, const Config& config, std::int64_t channel = 0);
// The format a field's raw value is on; none for integers.
std::optional<Format> format_of(const Field& field, const Config& config, std::int64_t channel = 0);

// The lists read as tables.
// clang-format off

// The configuration's constants, one record per scene; docs/numeric-spec.md, "Constants".
#define BITSPAN_CONSTANTS_RECORD(F, I, K) \
  F(s_min, setup_s)                       \
  F(s_max, setup_s)                       \
  F(b, setup_b)                           \
  F(c1, depth_c1)                         \
  F(c0, depth_c0)                         \
  F(fog_scale, fog_scale)

// state: one per change of draw state; the registers hold their values from this triangle on.
#define BITSPAN_STATE_FIELD(I, type, member, ...) I(member)
#define BITSPAN_STATE_RECORD(F, I, K) I(triangle) BITSPAN_DRAW_STATE(BITSPAN_STATE_FIELD, I)

// setup: one per triangle that has an area after snapping; vertices in the order of the edge walk.
#define BITSPAN_VERTEX(n, F, I, K)                                                                         \
  K(x##n, coordinate) K(y##n, coordinate) F(h##n, setup_h) F(u##n, setup_uv) F(v##n, setup_uv)             \
  F(r##n, setup_shade) F(g##n, setup_shade) F(b##n, setup_shade) F(a##n, setup_shade)
#define BITSPAN_SETUP_RECORD(F, I, K)                                       \
  I(triangle)                                                               \
  I(mid_right) /* 1: vertex 1 lies right of the edge from vertex 0 to 2 */  \
  BITSPAN_VERTEX(0, F, I, K) BITSPAN_VERTEX(1, F, I, K) BITSPAN_VERTEX(2, F, I, K)

// setup, second half: one per edge that has height; edge 0 is vertex 0 to 2, edge 1 is 0 to 1, edge 2 is 1 to 2.
#define BITSPAN_EDGE_RECORD(F, I, K)                                                                        \
  I(triangle) I(edge)                                                                                       \
  K(recip_m, edge_mantissa) I(recip_e)                                                                      \
  F(x_step, edge_x_step) F(h_step, edge_h_step) F(fu_diff, edge_f_diff) F(fv_diff, edge_f_diff)             \
  F(fu_step, edge_f_step) F(fv_step, edge_f_step) F(r_step, edge_shade_step) F(g_step, edge_shade_step)     \
  F(b_step, edge_shade_step) F(a_step, edge_shade_step)

// setup, where the level of detail goes by gradients: one per triangle.
#define BITSPAN_GRADIENT_RECORD(F, I, K)                                                                    \
  I(triangle) F(gu0, plane_g) F(gv0, plane_g) F(gu1, plane_g) F(gv1, plane_g) F(gu2, plane_g)               \
  F(gv2, plane_g) F(h_x, plane_h_grad) F(h_y, plane_h_grad) F(gu_x, plane_g_grad) F(gu_y, plane_g_grad)     \
  F(gv_x, plane_g_grad) F(gv_y, plane_g_grad)

// setup, where rows start from the triangle's plane: one per triangle.
#define BITSPAN_SETUP_PLANE_RECORD(F, I, K)                                                                 \
  I(triangle) K(recip_m, edge_mantissa) I(recip_e) F(u1, edge_uv) F(v1, edge_uv)                            \
  F(fu0, plane_g) F(fv0, plane_g) F(fu1, plane_g) F(fv1, plane_g) F(fu2, plane_g) F(fv2, plane_g)           \
  F(h_x, plane_h_grad) F(h_y, plane_h_grad) F(fu_x, plane_g_grad) F(fu_y, plane_g_grad)                     \
  F(fv_x, plane_g_grad) F(fv_y, plane_g_grad) F(r_x, plane_shade_grad) F(r_y, plane_shade_grad)             \
  F(g_x, plane_shade_grad) F(g_y, plane_shade_grad) F(b_x, plane_shade_grad) F(b_y, plane_shade_grad)       \
  F(a_x, plane_shade_grad) F(a_y, plane_shade_grad)

// setup, of a channel: one per triangle that has an area.
#define BITSPAN_SETUP_CHANNEL_RECORD(F, I, K)                                                               \
  I(triangle) I(channel) K(w0, channel_vertex) K(w1, channel_vertex) K(w2, channel_vertex)                  \
  K(f0, channel_product) K(f1, channel_product) K(f2, channel_product) /* homogeneous only */               \
  K(step0, channel_edge_step) K(step1, channel_edge_step) K(step2, channel_edge_step) /* of edges 0..2 */   \
  K(w_x, channel_gradient) K(w_y, channel_gradient)

// edge_walk: one per row that has pixels inside the viewport; l and r are its left and right end.
#define BITSPAN_ROW_END(p, F, I, K)                                                                         \
  I(p##_edge) F(p##_x_acc, edge_x_acc) F(p##_x, edge_x) F(p##_h_acc, edge_h_acc) F(p##_h, edge_h)           \
  F(p##_fu, edge_f) F(p##_fv, edge_f) K(p##_recip_m, pixel_mantissa) I(p##_recip_e)                         \
  F(p##_u, edge_uv) F(p##_v, edge_uv) F(p##_r_acc, edge_shade_acc) F(p##_g_acc, edge_shade_acc)             \
  F(p##_b_acc, edge_shade_acc) F(p##_a_acc, edge_shade_acc) F(p##_r, edge_shade) F(p##_g, edge_shade)       \
  F(p##_b, edge_shade) F(p##_a, edge_shade)
#define BITSPAN_ROW_RECORD(F, I, K)               \
  I(triangle) I(y) I(x_first) I(x_last)           \
  BITSPAN_ROW_END(l, F, I, K) BITSPAN_ROW_END(r, F, I, K)

// edge_walk, of a channel: one per row.
#define BITSPAN_ROW_CHANNEL_RECORD(F, I, K)                                                                 \
  I(triangle) I(y) I(channel) K(l_acc, channel_edge_acc) K(l, channel_edge) K(r_acc, channel_edge_acc)      \
  K(r, channel_edge)

// plane_walk (const_depth_rows only): gradients, one per triangle.
#define BITSPAN_PLANE_RECORD(F, I, K)                                                                          \
  I(triangle) I(major) /* 0: rows run along x; 1: along y */                                                   \
  I(major_first) /* m0, the pixel index where every row's step pattern is anchored */                          \
  F(gu0, plane_g) F(gv0, plane_g) F(gu1, plane_g) F(gv1, plane_g) F(gu2, plane_g) F(gv2, plane_g)              \
  F(h_x, plane_h_grad) F(h_y, plane_h_grad) F(gu_x, plane_g_grad) F(gu_y, plane_g_grad)                        \
  F(gv_x, plane_g_grad) F(gv_y, plane_g_grad) F(r_x, plane_shade_grad) F(r_y, plane_shade_grad)                \
  F(g_x, plane_shade_grad) F(g_y, plane_shade_grad) F(b_x, plane_shade_grad) F(b_y, plane_shade_grad)          \
  F(a_x, plane_shade_grad) F(a_y, plane_shade_grad) F(k, plane_k)

// plane_walk: one per row of constant depth that has covered pixels inside the viewport.
#define BITSPAN_PLANE_ROW_RECORD(F, I, K)                                                                       \
  I(triangle) I(row) /* r of Y = r + round(k x), in minor pixels */                                             \
  I(major_first) I(minor_first) /* first covered pixel */                                                       \
  I(count) /* pixels from the first to the last covered one */                                                  \
  K(phase, phase) F(h, span_h) F(gu, span_f) F(gv, span_f)                                                      \
  F(gu_step0, span_f_step) F(gu_step1, span_f_step) F(gv_step0, span_f_step) F(gv_step1, span_f_step)           \
  F(r, span_shade_acc) F(g, span_shade_acc) F(b, span_shade_acc) F(a, span_shade_acc)                           \
  F(r_step0, span_shade_step) F(r_step1, span_shade_step) F(g_step0, span_shade_step)                           \
  F(g_step1, span_shade_step) F(b_step0, span_shade_step) F(b_step1, span_shade_step)                           \
  F(a_step0, span_shade_step) F(a_step1, span_shade_step)

// line_walk: one per line that has pixels inside the viewport; l and r are its ends, r the one with the larger
// major coordinate.
#define BITSPAN_LINE_END(p, F, I, K)                                                                        \
  F(p##_x, edge_x) /* the major coordinate of its pixel's centre */                                         \
  F(p##_h, edge_h) F(p##_u, edge_uv) F(p##_v, edge_uv) F(p##_r, edge_shade) F(p##_g, edge_shade)            \
  F(p##_b, edge_shade) F(p##_a, edge_shade)
#define BITSPAN_LINE_WALK_RECORD(F, I, K)                                                                   \
  I(triangle) I(major) /* 0: pixels follow each other in x; 1: in y */                                      \
  I(major_first) I(minor_first) I(count) /* first pixel inside the viewport, and how many are */            \
  I(phase) I(k) I(one) /* of the digital line there: phase and slope are phase / one and k / one */         \
  BITSPAN_LINE_END(l, F, I, K) BITSPAN_LINE_END(r, F, I, K)

// span_setup: one per span. In the modes with horizontal rows step1 repeats step0 and phase is 0.
#define BITSPAN_SPAN_RECORD(F, I, K)                                                                        \
  I(triangle) I(x) I(y) /* first pixel */ I(count)                                                          \
  K(recip_m, row_mantissa) I(recip_e) K(phase, phase)                                                       \
  F(fu_diff, span_f_diff) F(fv_diff, span_f_diff)                                                           \
  F(h, span_h) F(h_step, span_h_step) F(u1, edge_uv) F(v1, edge_uv)                                         \
  K(fu, texture_acc) K(fv, texture_acc) K(fu_step0, texture_step) K(fu_step1, texture_step)                 \
  K(fv_step0, texture_step) K(fv_step1, texture_step)                                                       \
  F(r, span_shade_acc) F(g, span_shade_acc) F(b, span_shade_acc) F(a, span_shade_acc)                       \
  F(r_step0, span_shade_step) F(r_step1, span_shade_step) F(g_step0, span_shade_step)                       \
  F(g_step1, span_shade_step) F(b_step0, span_shade_step) F(b_step1, span_shade_step)                       \
  F(a_step0, span_shade_step) F(a_step1, span_shade_step)

// span_setup, of a channel: one per span.
#define BITSPAN_SPAN_CHANNEL_RECORD(F, I, K)                                                                \
  I(triangle) I(x) I(y) I(channel) K(w, channel_acc) K(w_step0, channel_step) K(w_step1, channel_step)

// span: one per pixel of a span.
#define BITSPAN_FRAGMENT_RECORD(F, I, K)                                                                    \
  I(triangle) I(x) I(y) I(covered) I(last)                                                                  \
  F(h, span_h) K(fu, texture_acc) K(fv, texture_acc) K(recip_m, pixel_mantissa) I(recip_e)                  \
  F(u, span_uv) F(v, span_uv) F(r, span_shade) F(g, span_shade) F(b, span_shade) F(a, span_shade)

// span, of a channel: one per pixel of a span.
#define BITSPAN_FRAGMENT_CHANNEL_RECORD(F, I, K) I(triangle) I(x) I(y) I(channel) K(w, channel_value)

// depth: one per covered fragment.
#define BITSPAN_DEPTH_RECORD(F, I, K)                                                  \
  I(triangle) I(x) I(y) K(recip_m, pixel_mantissa) I(recip_e) /* linear code only */   \
  K(z, depth_code) K(stored, depth_code) /* the buffer's code before the test */ I(pass)

// stencil: one per fragment that comes to the test; only while stencil.test is on.
#define BITSPAN_STENCIL_RECORD(F, I, K)                                                                    \
  I(triangle) I(x) I(y) I(back) /* 1: a back face */ I(stored) /* the plane's value before */              \
  I(pass) I(op) /* of StencilOp */ I(value) /* the plane's value behind */

// distance, where lod or fog takes it: one per fragment that comes to the texture.
#define BITSPAN_DISTANCE_RECORD(F, I, K)                                                                   \
  I(triangle) I(x) I(y) K(recip_m, pixel_mantissa) I(recip_e) F(s, distance_s)                             \
  I(zone) F(d, distance_d) /* where the true distance is taken */

// lod, where textures have mip chains: one per fragment that passed the depth test.
#define BITSPAN_LOD_RECORD(F, I, K)                                                                        \
  I(triangle) I(x) I(y) K(recip_m, pixel_mantissa) I(recip_e) /* zone_s, gradient; finite: right */        \
  F(s, distance_s) /* zone_s */                                                                            \
  F(u_x, lod_slope) F(u_y, lod_slope) F(v_x, lod_slope) F(v_y, lod_slope) /* gradient, finite */           \
  F(lambda, lod_lambda) I(level) F(f, lod_frac)

// texture: one per fragment that passed the depth test.
#define BITSPAN_TEXTURE_RECORD(F, I, K)                                                                    \
  I(triangle) I(x) I(y) I(i) I(j) /* nearest texel, or the upper left of four, wrapped */                  \
  F(ex, texture_frac) F(ey, texture_frac)                                                                  \
  F(texel_r, texture_mix) F(texel_g, texture_mix) F(texel_b, texture_mix) F(texel_a, texture_alpha)        \
  F(r, texture_color) F(g, texture_color) F(b, texture_color) F(a, texture_alpha)                          \
  I(killed) /* transparent code or alpha 0 */

// project: one per fragment that the second texture unit takes; only while its coordinates are projected.
#define BITSPAN_PROJECT_RECORD(F, I, K)                                                                    \
  I(triangle) I(x) I(y) K(recip_m, pixel_mantissa) I(recip_e) /* of W */                                   \
  F(s, span_uv) F(t, span_uv) F(ratio, project_ratio) F(h, project_h) K(z, depth_code)                     \
  I(inside) /* 1: in front of the projector, and within its texture */

// texture.second: one per fragment that the first unit does not kill; only while texture1 is on.
#define BITSPAN_TEXTURE_SECOND_RECORD(F, I, K)                                                             \
  I(triangle) I(x) I(y) I(level) F(f, lod_frac) /* of the unit's own chain */                              \
  I(i) I(j) F(ex, texture_frac) F(ey, texture_frac)                                                        \
  F(texel_r, texture_mix) F(texel_g, texture_mix) F(texel_b, texture_mix) F(texel_a, texture_alpha)        \
  F(r, texture_color) F(g, texture_color) F(b, texture_color) F(a, texture_alpha)                          \
  I(killed) /* alpha 0 or the alpha test, of the combined alpha */

// light: one per fragment that is drawn, in a view with a light. The vectors are 0 where the channel light is
// the brightness.
#define BITSPAN_LIGHT_RECORD(F, I, K)                                                                      \
  I(triangle) I(x) I(y) F(nx, light_normal) F(ny, light_normal) F(nz, light_normal)                        \
  F(lx, light_direction) F(ly, light_direction) F(lz, light_direction)                                     \
  F(cosine, light_cosine) F(mirrored, light_cosine) F(specular, light_specular)                            \
  F(value, light_value) F(r, texture_color) F(g, texture_color) F(b, texture_color)

// fog: one per fragment that the texture did not kill.
#define BITSPAN_FOG_RECORD(F, I, K)                                                                        \
  I(triangle) I(x) I(y) I(index) /* of a table, -1 in modes without */                                     \
  K(recip_m, pixel_mantissa) I(recip_e) /* linear fog only */                                              \
  F(factor, fog_factor) F(r, fog_color) F(g, fog_color) F(b, fog_color)

// candidate: one per fragment that comes to merge while translucency.pass = candidate.
#define BITSPAN_CANDIDATE_RECORD(F, I, K)                                                                  \
  I(triangle) I(x) I(y) K(z, depth_code) K(held, depth_code) /* of the pixel's candidate before, 0: none */ \
  I(taken) /* 1: this one is held from here on */

// merge: one per fragment written.
#define BITSPAN_MERGE_RECORD(F, I, K)                                                        \
  I(triangle) I(x) I(y) K(z, depth_code) F(r, merge_color) F(g, merge_color) F(b, merge_color)

// merge.alpha: one per fragment written; only where the stored alpha may change.
#define BITSPAN_MERGE_ALPHA_RECORD(F, I, K) I(triangle) I(x) I(y) I(a)

// clang-format on

#define BITSPAN_MEMBER_F(name, id) std::int64_t name = 0;
#define BITSPAN_MEMBER_I(name) std::int64_t name = 0;
#define BITSPAN_MEMBER_K(name, kind) std::int64_t name = 0;
#define BITSPAN_DECLARE(Record, LIST, name, member)            \
  struct Record {                                              \
    LIST(BITSPAN_MEMBER_F, BITSPAN_MEMBER_I, BITSPAN_MEMBER_K) \
    bool operator==(const Record&) const = default;            \
  };
BITSPAN_RECORDS(BITSPAN_DECLARE)
#undef BITSPAN_DECLARE
#undef BITSPAN_MEMBER_F
#undef BITSPAN_MEMBER_I
#undef BITSPAN_MEMBER_K

// fields<R>: one Field per member, in the order of declaration. stage_name<R> and record_type<R>: its row in
// the table of stages.
template <class R>
inline constexpr int fields = 0;
template <class R>
inline constexpr std::string_view stage_name = "";
template <class R>
inline constexpr RecordType record_type = RecordType::count;

#define BITSPAN_FIELD_F(name, id) Field{#name, FieldKind::format, FormatId::id},
#define BITSPAN_FIELD_I(name) Field{#name, FieldKind::integer, FormatId::count},
#define BITSPAN_FIELD_K(name, kind) Field{#name, FieldKind::kind, FormatId::count},
#define BITSPAN_DESCRIBE(Record, LIST, name, member)                                   \
  template <>                                                                          \
  inline constexpr auto fields<Record> =                                               \
      std::to_array<Field>({LIST(BITSPAN_FIELD_F, BITSPAN_FIELD_I, BITSPAN_FIELD_K)}); \
  template <>                                                                          \
  inline constexpr std::string_view stage_name<Record> = name;                         \
  template <>                                                                          \
  inline constexpr RecordType record_type<Record> = RecordType::member;                \
  static_assert(sizeof(Record) == sizeof(std::int64_t) * fields<Record>.size());
BITSPAN_RECORDS(BITSPAN_DESCRIBE)
#undef BITSPAN_DESCRIBE
#undef BITSPAN_FIELD_F
#undef BITSPAN_FIELD_I
#undef BITSPAN_FIELD_K

// The raw values of a record, in the order of fields<R>.
template <class R>
std::span<const std::int64_t> raw_values(const R& record) {
  return {reinterpret_cast<const std::int64_t*>(&record), fields<R>.size()};
}

// Everything an engine delivered for a batch of triangles, each stage in its order of delivery.
struct Trace {
#define BITSPAN_TRACE_MEMBER(Record, LIST, name, member) std::vector<Record> member;
  BITSPAN_RECORDS(BITSPAN_TRACE_MEMBER)
#undef BITSPAN_TRACE_MEMBER
  void clear() {
#define BITSPAN_TRACE_CLEAR(Record, LIST, name, member) member.clear();
    BITSPAN_RECORDS(BITSPAN_TRACE_CLEAR)
#undef BITSPAN_TRACE_CLEAR
  }
  // The records of which there is one per pixel.
  void reserve_pixels(std::size_t pixels) {
#define BITSPAN_TRACE_RESERVE(Record, LIST, name, member) \
  if constexpr (row_of(RecordType::member).per == Per::pixel) member.reserve(pixels);
    BITSPAN_RECORDS(BITSPAN_TRACE_RESERVE)
#undef BITSPAN_TRACE_RESERVE
  }
  void clear_pixels() {
#define BITSPAN_TRACE_CLEAR(Record, LIST, name, member) \
  if constexpr (row_of(RecordType::member).per == Per::pixel) member.clear();
    BITSPAN_RECORDS(BITSPAN_TRACE_CLEAR)
#undef BITSPAN_TRACE_CLEAR
  }
};

// The records of one type in a trace.
template <class R>
std::vector<R>& records_of(Trace& trace);
#define BITSPAN_RECORDS_OF(Record, LIST, name, member)   \
  template <>                                            \
  inline std::vector<Record>& records_of(Trace& trace) { \
    return trace.member;                                 \
  }
BITSPAN_RECORDS(BITSPAN_RECORDS_OF)
#undef BITSPAN_RECORDS_OF

// Appends a record to the trace, where there is one.
template <class R>
void deliver(Trace* trace, const R& record) {
  if (trace != nullptr) records_of<R>(*trace).push_back(record);
}
template <class R>
void deliver_all(Trace* trace, const R& records) {
  if (trace == nullptr) return;
  auto& to = records_of<std::ranges::range_value_t<R>>(*trace);
  to.insert(to.end(), records.begin(), records.end());
}

// The registers from triangle next_index on.
StateRecord state_record(const DrawState& state, std::int64_t next_index);

// All records of one type in a trace, as rows of raw values.
struct RecordView {
  RecordType type = RecordType::count;
  std::string_view stage;  // "setup", "setup.edge", "edge_walk" ...
  std::span<const Field> fields;
  const std::int64_t* values = nullptr;
  std::size_t records = 0;

  std::span<const std::int64_t> record(std::size_t i) const {
    return {values + i * fields.size(), fields.size()};
  }
};
RecordView view_of(const Trace& trace, RecordType type);
// The name in the table of stages; empty for RecordType::count.
std::string_view stage_of(RecordType type);
std::span<const Field> fields_of(RecordType type);
// Position of a field in its record; -1 where the record has none of that name.
int field_index(RecordType type, std::string_view field);
// The channel that a record is of; 0 where it is of none.
std::int64_t channel_of(RecordType type, std::span<const std::int64_t> record);

}  // namespace bitspan
