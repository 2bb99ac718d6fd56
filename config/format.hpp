// SPDX-License-Identifier: Apache-2.0
// Fixed-point formats: the one description of a register's width that every view reads.
//
// A format follows SystemC's convention: `word` bits in all, `integer` of them left of the binary point
// (the sign bit included when signed), so the least significant bit weighs 2^-(word - integer).
// `integer` may be negative or larger than `word`. Raw values are held in int64_t: signed formats take
// 1..64 bits, unsigned ones 1..63.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

#include "config/names.hpp"

namespace bitspan {

// SystemC's seven quantisation modes (IEEE 1666, 7.10.9.1), by the same names without the prefix.
enum class Rounding : std::uint8_t {
  rnd,          // SC_RND: nearest, ties toward plus infinity
  rnd_zero,     // SC_RND_ZERO: nearest, ties toward zero
  rnd_min_inf,  // SC_RND_MIN_INF: nearest, ties toward minus infinity
  rnd_inf,      // SC_RND_INF: nearest, ties away from zero
  rnd_conv,     // SC_RND_CONV: nearest, ties to even
  trn,          // SC_TRN: floor
  trn_zero,     // SC_TRN_ZERO: toward zero
};

// SystemC's five overflow modes with n_bits = 0 (IEEE 1666, 7.10.9.2).
enum class Overflow : std::uint8_t {
  wrap,      // SC_WRAP: keep the low bits
  sat,       // SC_SAT: clamp to the range
  sat_zero,  // SC_SAT_ZERO: out of range becomes 0
  sat_sym,   // SC_SAT_SYM: clamp to [-max, max] when signed
  wrap_sm,   // SC_WRAP_SM: sign-magnitude wrap, signed formats only
};

template <>
inline constexpr auto enum_names<Rounding> = std::to_array<std::string_view>(
    {"SC_RND", "SC_RND_ZERO", "SC_RND_MIN_INF", "SC_RND_INF", "SC_RND_CONV", "SC_TRN", "SC_TRN_ZERO"});
template <>
inline constexpr auto enum_names<Overflow> =
    std::to_array<std::string_view>({"SC_WRAP", "SC_SAT", "SC_SAT_ZERO", "SC_SAT_SYM", "SC_WRAP_SM"});

inline constexpr int rounding_modes = static_cast<int>(enum_names<Rounding>.size());
inline constexpr int overflow_modes = static_cast<int>(enum_names<Overflow>.size());
static_assert(rounding_modes == static_cast<int>(Rounding::trn_zero) + 1);
static_assert(overflow_modes == static_cast<int>(Overflow::wrap_sm) + 1);

struct Format {
  int word = 1;
  int integer = 1;
  bool is_signed = false;
  Rounding rounding = Rounding::trn;
  Overflow overflow = Overflow::sat;
  // The scene's range may exceed this format on purpose; the range check then keeps silent about it.
  bool overflow_expected = false;

  constexpr int fraction() const { return word - integer; }
  constexpr bool operator==(const Format&) const = default;
};

// Every register of the pipeline that has a configurable format: id, key in the TOML file, unit, meaning, and
// for a new register a FormatDefault, so that files may leave it out: FormatId::span_h, or a Format{...}.
// docs/numeric-spec.md says where each one stands. The order here is the order of `bitspan config show`.
#define BITSPAN_FORMATS(X)                                                                                   \
  X(setup_s, "setup.s", "s / 2^E", "vertex distance along the view axis, normalised by a power of two")      \
  X(setup_b, "setup.b", "depth code", "the constant B of the inverse depth code D1")                         \
  X(setup_h, "setup.h", "depth code", "vertex depth code h")                                                 \
  X(setup_uv, "setup.uv", "texel", "vertex texture coordinates")                                             \
  X(setup_shade, "setup.shade", "1", "vertex colour and alpha, 0 to 1")                                      \
  X(edge_x_step, "edge.x_step", "pixel/row", "slope register of a dda edge")                                 \
  X(edge_x_acc, "edge.x_acc", "pixel", "x accumulator of a dda edge")                                        \
  X(edge_x, "edge.x", "pixel", "x of an edge at a row's centre, as span setup sees it")                      \
  X(edge_h_step, "edge.h_step", "depth code/row", "slope of h along an edge")                                \
  X(edge_h_acc, "edge.h_acc", "depth code", "accumulator of h along an edge")                                \
  X(edge_h, "edge.h", "depth code", "h of an edge at a row's centre")                                        \
  X(edge_f_diff, "edge.f_diff", "texel*depth code", "(u2 - u1)(h2 + B) of an edge")                          \
  X(edge_f_step, "edge.f_step", "texel*depth code/row", "delta-f slope along an edge")                       \
  X(edge_f, "edge.f", "texel*depth code", "delta-f accumulator along an edge")                               \
  X(edge_uv, "edge.uv", "texel", "u, v of an edge at a row's centre")                                        \
  X(edge_shade_step, "edge.shade_step", "1/row", "slope of colour and alpha along an edge")                  \
  X(edge_shade_acc, "edge.shade_acc", "1", "accumulator of colour and alpha along an edge")                  \
  X(edge_shade, "edge.shade", "1", "colour and alpha of an edge at a row's centre")                          \
  X(plane_g, "plane.g", "texel*depth code", "u (h + B) at a vertex, const_depth_rows")                       \
  X(plane_h_grad, "plane.h_grad", "depth code/pixel", "screen gradient of h, const_depth_rows")              \
  X(plane_g_grad, "plane.g_grad", "texel*depth code/pixel", "screen gradient of u (h + B)")                  \
  X(plane_shade_grad, "plane.shade_grad", "1/pixel", "screen gradient of colour and alpha")                  \
  X(plane_k, "plane.k", "pixel/pixel", "slope k of the rows of constant depth, -1 to 1")                     \
  X(span_h_step, "span.h_step", "depth code/pixel", "slope of h along a span")                               \
  X(span_h, "span.h", "depth code", "accumulator of h along a span, the fragment's h")                       \
  X(span_f_diff, "span.f_diff", "texel*depth code", "(u_r - u_l)(h_r + B) of a span")                        \
  X(span_f_step, "span.f_step", "texel*depth code/pixel", "slope of the texture numerator")                  \
  X(span_f, "span.f", "texel*depth code", "accumulator of the texture numerator")                            \
  X(span_uv_step, "span.uv_step", "texel/pixel", "slope of u, v where they are linear")                      \
  X(span_uv_acc, "span.uv_acc", "texel", "accumulator of u, v where they are linear")                        \
  X(span_uv, "span.uv", "texel", "the fragment's texture coordinates xt, yt")                                \
  X(span_shade_step, "span.shade_step", "1/pixel", "slope of colour and alpha along a span")                 \
  X(span_shade_acc, "span.shade_acc", "1", "accumulator of colour and alpha along a span")                   \
  X(span_shade, "span.shade", "1", "the fragment's colour and alpha factors")                                \
  X(shade_grad, "shade.grad", "depth code/pixel", "channels shade_*: their gradients",                       \
    Format{54, 34, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(shade_step, "shade.step", "depth code/pixel",                                                            \
    "channels shade_*: their slopes along an edge, and along a row",                                         \
    Format{54, 34, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(shade_acc, "shade.acc", "depth code",                                                                    \
    "channels shade_*: their products with h + B, and the accumulators of these",                            \
    Format{48, 28, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(shade_value, "shade.value", "1", "channels shade_*: the fragment's colour and alpha factors",            \
    Format{13, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(depth_c1, "depth.c1", "1", "scale constant of the linear depth code H6")                                 \
  X(depth_c0, "depth.c0", "1", "offset constant of the linear depth code H6")                                \
  X(distance_a, "distance.a", "depth code", "constant A' of the distance",                                   \
    Format{44, 24, false, Rounding::rnd, Overflow::sat, false})                                              \
  X(distance_s, "distance.s", "s / 2^E", "distance along the view axis of a fragment",                       \
    Format{24, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(distance_g, "distance.g", "1", "true distance over that along the view axis, per zone",                  \
    Format{16, 2, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(distance_d, "distance.d", "s / 2^E", "true distance of a fragment from the viewer",                      \
    Format{25, 3, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(lod_k, "lod.k", "2^E / s", "reciprocal of a zone's width",                                               \
    Format{34, 17, false, Rounding::rnd, Overflow::sat, false})                                              \
  X(lod_slope, "lod.slope", "texel/pixel", "screen derivatives of u and v",                                  \
    Format{28, 14, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(lod_lambda, "lod.lambda", "level", "level of detail",                                                    \
    Format{13, 6, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(lod_frac, "lod.frac", "level", "share of the coarser level",                                             \
    Format{7, 0, false, Rounding::trn, Overflow::sat, false})                                                \
  X(project_vertex, "project.vertex", "texel", "channels project_*: X, Y, W at a vertex",                    \
    Format{36, 14, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(project_grad, "project.grad", "texel*depth code/pixel", "channels project_*: their gradients",           \
    Format{52, 36, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(project_step, "project.step", "texel*depth code/pixel",                                                  \
    "channels project_*: their slopes along an edge, and along a row",                                       \
    Format{52, 36, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(project_acc, "project.acc", "texel*depth code",                                                          \
    "channels project_*: their products with h + B, and the accumulators of these",                          \
    Format{48, 34, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(project_value, "project.value", "texel*depth code", "channels project_*: X, Y, W of a fragment",         \
    FormatId::project_acc)                                                                                   \
  X(project_ratio, "project.ratio", "2^E / s", "reciprocal of a fragment's distance from the projector",     \
    Format{38, 18, false, Rounding::rnd, Overflow::sat, false})                                              \
  X(project_h, "project.h", "depth code", "h of a fragment, seen from the projector",                        \
    Format{40, 24, false, Rounding::trn, Overflow::sat, false})                                              \
  X(texture_frac, "texture.frac", "texel", "Ex, Ey of the bilinear filter")                                  \
  X(texture_mix, "texture.mix", "colour code", "V5, V6, V of the bilinear filter")                           \
  X(texture_color, "texture.color", "colour code", "texel times colour")                                     \
  X(texture_alpha, "texture.alpha", "1", "alpha of texel and fragment, 0 to 1")                              \
  X(normal_vertex, "normal.vertex", "1", "channels nx, ny, nz: the normal at a vertex",                      \
    Format{20, 2, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(normal_grad, "normal.grad", "1/pixel", "channels nx, ny, nz: their gradients",                           \
    Format{40, 12, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(normal_step, "normal.step", "1/pixel",                                                                   \
    "channels nx, ny, nz: their slopes along an edge, and along a row",                                      \
    Format{40, 12, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(normal_acc, "normal.acc", "1", "channels nx, ny, nz: their accumulators along an edge, and along a row", \
    Format{32, 4, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(normal_value, "normal.value", "1", "the normal that light takes", FormatId::normal_vertex)               \
  X(relief_vertex, "relief.vertex", "texel",                                                                 \
    "channels lx, ly, lz: the light in a normal map's field, at a vertex",                                   \
    Format{28, 16, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(relief_grad, "relief.grad", "texel/pixel", "channels lx, ly, lz: their gradients",                       \
    Format{36, 16, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(relief_step, "relief.step", "texel/pixel",                                                               \
    "channels lx, ly, lz: their slopes along an edge, and along a row",                                      \
    Format{36, 16, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(relief_acc, "relief.acc", "texel",                                                                       \
    "channels lx, ly, lz: their accumulators along an edge, and along a row",                                \
    Format{36, 18, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(relief_value, "relief.value", "texel", "the light's place that light takes", FormatId::relief_vertex)    \
  X(light_vertex, "light.vertex", "1", "channel light: the brightness at a vertex", FormatId::setup_shade)   \
  X(light_grad, "light.grad", "1/pixel", "channel light: its screen gradient", FormatId::plane_shade_grad)   \
  X(light_step, "light.step", "1/pixel", "channel light: its slope along an edge, and along a row",          \
    FormatId::span_shade_step)                                                                               \
  X(light_acc, "light.acc", "1", "channel light: its accumulator along an edge, and along a row",            \
    FormatId::span_shade_acc)                                                                                \
  X(light_scale, "light.scale", "1", "reciprocal of the focal length, times a power of two",                 \
    Format{24, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_position, "light.position", "s / 2^E",                                                             \
    "a point in the view; a direction, whose largest part is 1/2 to 1",                                      \
    Format{32, 8, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(light_root, "light.root", "1", "mantissa of the reciprocal square root",                                 \
    Format{22, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_normal, "light.normal", "1", "the normal, of length 1",                                            \
    Format{20, 2, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(light_direction, "light.direction", "1", "the direction to the light, of length 1",                      \
    Format{20, 2, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(light_cosine, "light.cosine", "1", "cosines of the angles at the surface and at the mirrored ray",       \
    Format{20, 2, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(light_specular, "light.specular", "1", "the highlight, a power of a cosine; an entry of its table",      \
    Format{18, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_inverse, "light.inverse", "1", "square of the reciprocal square root's mantissa",                  \
    Format{24, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_lunar, "light.lunar", "1", "lunar law: k, and 1 + k times the viewer's cosine",                    \
    Format{20, 6, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_distance, "light.distance", "reach",                                                               \
    "distance that brightness falls by, its square, and the offset beside them",                             \
    Format{28, 8, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_fall, "light.fall", "1", "what the distance leaves of the brightness",                             \
    Format{18, 2, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(light_value, "light.value", "1", "brightness, 0 to 1; the shares that it is made of",                    \
    Format{16, 1, false, Rounding::rnd, Overflow::sat, false})                                               \
  X(fog_scale, "fog.scale", "depth code", "constant of linear fog")                                          \
  X(fog_factor, "fog.factor", "1", "share of the object's own colour, 0 to 1; the fog table's entry")        \
  X(fog_vertex, "fog.vertex", "1", "channel fog: the fog's factor at a vertex", FormatId::setup_shade)       \
  X(fog_grad, "fog.grad", "1/pixel", "channel fog: its screen gradient", FormatId::plane_shade_grad)         \
  X(fog_step, "fog.step", "1/pixel", "channel fog: its slope along an edge, and along a row",                \
    FormatId::span_shade_step)                                                                               \
  X(fog_acc, "fog.acc", "1", "channel fog: its accumulator along an edge, and along a row",                  \
    FormatId::span_shade_acc)                                                                                \
  X(fog_color, "fog.color", "colour code", "colour after fog")                                               \
  X(merge_color, "merge.color", "colour code", "colour as stored in the frame buffer")                       \
  X(curve_d0, "curve.d0", "coordinate", "forward differences: the point",                                    \
    Format{44, 13, true, Rounding::rnd, Overflow::sat, false})                                               \
  X(curve_d1, "curve.d1", "coordinate", "forward differences: the first one", FormatId::curve_d0)            \
  X(curve_d2, "curve.d2", "coordinate", "forward differences: the second one", FormatId::curve_d0)           \
  X(curve_d3, "curve.d3", "coordinate", "forward differences: the third one", FormatId::curve_d0)            \
  X(rotate_t, "rotate.t", "1", "rotation: tangent of half the angle",                                        \
    Format{18, 1, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(rotate_s, "rotate.s", "1", "rotation: sine of the angle",                                                \
    Format{18, 1, true, Rounding::rnd, Overflow::sat, false})                                                \
  X(rotate_xy, "rotate.xy", "coordinate", "rotation: x, y and what is added to them",                        \
    Format{32, 16, true, Rounding::rnd_conv, Overflow::sat, false})

enum class FormatId : std::uint8_t {
#define BITSPAN_FORMAT_ENUM(id, key, unit, text, ...) id,
  BITSPAN_FORMATS(BITSPAN_FORMAT_ENUM)
#undef BITSPAN_FORMAT_ENUM
      count
};

inline constexpr int format_count = static_cast<int>(FormatId::count);

// What a register has where a file leaves it out: the format of another one, which stands before it in the
// table, or a format of its own. A register without either is mandatory.
using FormatDefault = std::variant<std::monostate, FormatId, Format>;
inline constexpr std::array<FormatDefault, format_count> format_defaults{
#define BITSPAN_FORMAT_DEFAULT(id, key, unit, text, ...) FormatDefault{__VA_ARGS__},
    BITSPAN_FORMATS(BITSPAN_FORMAT_DEFAULT)
#undef BITSPAN_FORMAT_DEFAULT
};

std::string_view key_of(FormatId id);   // "setup.s" ...
std::string_view unit_of(FormatId id);  // "depth code" ...
std::string_view text_of(FormatId id);  // the meaning, one line

}  // namespace bitspan
