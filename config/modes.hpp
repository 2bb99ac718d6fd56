// SPDX-License-Identifier: Apache-2.0
// What the modes of a configuration imply. Every function is an exhaustive switch: a new enumerator does not
// compile (-Wswitch) until each of them has decided. Nothing else compares a mode with an enumerator
// (tests/config/modes_test.cpp): it asks one of these, or is an exhaustive switch of its own.
#pragma once

#include <cstdint>

#include "config/config.hpp"

namespace bitspan {

// Stands after an exhaustive switch whose cases all return. It is a template because no call of it is a
// constant expression, which clang allows in templates alone.
template <class = void>
[[noreturn]] constexpr void unreachable() {
  __builtin_unreachable();
}

// ---------------------------------------------------------------- raster

// A pixel centre on any edge is covered; elsewhere only on a left or a top edge.
constexpr bool owns_every_edge(FillRule rule) {
  switch (rule) {
    case FillRule::top_left:
      return false;
    case FillRule::inclusive:
      return true;
  }
  unreachable();
}

// How x of an edge is formed on a row.
enum class EdgeX : std::uint8_t {
  quotient,   // exactly, as a quotient per row
  summed,     // the step x_step is added to x of the row before
  multiplied  // the step x_step is multiplied by the distance from the edge's start
};
// Whether the rows of an edge add up its steps.
constexpr bool sums_x_steps(DdaUpdate update) {
  switch (update) {
    case DdaUpdate::accumulate:
      return true;
    case DdaUpdate::multiply:
      return false;
  }
  unreachable();
}
constexpr EdgeX edge_x_of(const Config& config) {
  switch (config.edge_walk) {
    case EdgeWalk::exact:
      return EdgeX::quotient;
    case EdgeWalk::dda:
      return sums_x_steps(config.dda_update) ? EdgeX::summed : EdgeX::multiplied;
  }
  unreachable();
}

// An edge has the register edge.x_step, and with it edge.x_acc.
constexpr bool has_x_step(EdgeX x) {
  switch (x) {
    case EdgeX::quotient:
      return false;
    case EdgeX::summed:
    case EdgeX::multiplied:
      return true;
  }
  unreachable();
}
constexpr bool has_x_step(const Config& config) { return has_x_step(edge_x_of(config)); }

// ---------------------------------------------------------------- lines

constexpr bool has_lines(LineForm walk) {
  switch (walk) {
    case LineForm::none:
      return false;
    case LineForm::exact:
    case LineForm::dda:
      return true;
  }
  unreachable();
}
// A line's slope is a register of its own; elsewhere its digital line goes by the ends' differences.
constexpr bool has_line_slope(LineForm walk) {
  switch (walk) {
    case LineForm::dda:
      return true;
    case LineForm::none:
    case LineForm::exact:
      return false;
  }
  unreachable();
}

// The RTL walks a digital line by its slope alone.
constexpr bool is_in_rtl(LineForm walk) {
  switch (walk) {
    case LineForm::none:
    case LineForm::dda:
      return true;
    case LineForm::exact:
      return false;
  }
  unreachable();
}

// ---------------------------------------------------------------- perspective

// Triangles are walked along rows of constant depth; elsewhere along horizontal rows between two edges.
constexpr bool has_plane_rows(Perspective p) {
  switch (p) {
    case Perspective::const_depth_rows:
      return true;
    case Perspective::delta_f:
    case Perspective::hyperbolic:
    case Perspective::affine:
      return false;
  }
  unreachable();
}
// Pixels follow a digital line: rows of constant depth, or those of lines.
constexpr bool has_digital_line(const Config& config) {
  return has_plane_rows(config.perspective) || has_line_slope(config.line_walk);
}

// u and v themselves are interpolated along a row, so that a pixel takes no division.
constexpr bool has_linear_texture(Perspective p) {
  switch (p) {
    case Perspective::affine:
    case Perspective::const_depth_rows:
      return true;
    case Perspective::delta_f:
    case Perspective::hyperbolic:
      return false;
  }
  unreachable();
}

// u and v themselves are interpolated along an edge, so that a row's end takes no division.
constexpr bool has_linear_edges(Perspective p) {
  switch (p) {
    case Perspective::affine:
      return true;
    case Perspective::delta_f:
    case Perspective::const_depth_rows:
    case Perspective::hyperbolic:
      return false;
  }
  unreachable();
}

// u and v of a pixel are u1, v1 of its row plus a numerator f times R_pixel(h + B).
constexpr bool has_pixel_reciprocal(Perspective p) {
  switch (p) {
    case Perspective::delta_f:
      return true;
    case Perspective::const_depth_rows:
    case Perspective::hyperbolic:
    case Perspective::affine:
      return false;
  }
  unreachable();
}

// u and v of a pixel are two quotients: u q / q and v q / q.
constexpr bool has_pixel_quotients(Perspective p) {
  switch (p) {
    case Perspective::hyperbolic:
      return true;
    case Perspective::delta_f:
    case Perspective::const_depth_rows:
    case Perspective::affine:
      return false;
  }
  unreachable();
}

// Values of a plane row belong to the ideal line; elsewhere to the pixel's centre.
constexpr bool is_on_ideal_line(Numerator n) {
  switch (n) {
    case Numerator::pixel_centre:
      return false;
    case Numerator::ideal_line:
      return true;
  }
  unreachable();
}

// Colour and alpha are those of the channels shade_*, which each pixel divides.
constexpr bool has_perspective_shades(ShadeLines lines) {
  switch (lines) {
    case ShadeLines::linear:
      return false;
    case ShadeLines::perspective:
      return true;
  }
  unreachable();
}

// The depth code is of the channel z in the place of h.
constexpr bool has_own_depth(DepthLine line) {
  switch (line) {
    case DepthLine::h:
      return false;
    case DepthLine::z:
      return true;
  }
  unreachable();
}

// The second texture unit looks up where the channels u2 and v2 say.
constexpr bool has_second_coordinates(SecondCoordinates coordinates) {
  switch (coordinates) {
    case SecondCoordinates::first:
      return false;
    case SecondCoordinates::own:
      return true;
  }
  unreachable();
}

// ---------------------------------------------------------------- divisions

// Slopes over one length share its reciprocal; elsewhere each is a quotient.
constexpr bool shares_reciprocal(SlopeForm form) {
  switch (form) {
    case SlopeForm::divide:
      return false;
    case SlopeForm::reciprocal:
      return true;
  }
  unreachable();
}

// A row's start values and steps come from the plane of its triangle, so that its ends have a position alone.
constexpr bool is_by_plane(RowSlope slope) {
  switch (slope) {
    case RowSlope::plane:
      return true;
    case RowSlope::divide:
    case RowSlope::reciprocal:
      return false;
  }
  unreachable();
}
constexpr bool has_setup_plane(const Config& config) { return is_by_plane(config.row_slope); }

// How the slopes between a row's ends are formed; of no meaning where there are none.
constexpr SlopeForm form_of(RowSlope slope) {
  switch (slope) {
    case RowSlope::reciprocal:
      return SlopeForm::reciprocal;
    case RowSlope::divide:
    case RowSlope::plane:
      return SlopeForm::divide;
  }
  unreachable();
}

// The unit has a table, and with it operand_bits, index_bits, table_bits and internal_bits.
constexpr bool has_table(ReciprocalKind kind) {
  switch (kind) {
    case ReciprocalKind::restoring:
      return false;
    case ReciprocalKind::lut_linear:
    case ReciprocalKind::lut_newton:
    case ReciprocalKind::lut_quadratic:
      return true;
  }
  unreachable();
}

// A table's entry is followed by Newton steps.
constexpr bool has_newton_steps(ReciprocalKind kind) {
  switch (kind) {
    case ReciprocalKind::lut_newton:
      return true;
    case ReciprocalKind::restoring:
    case ReciprocalKind::lut_linear:
    case ReciprocalKind::lut_quadratic:
      return false;
  }
  unreachable();
}

// Entries of a unit's table: one per segment, one more where segments have an entry at both ends, or value,
// slope and curvature per segment.
constexpr std::int64_t table_entries(const Reciprocal& unit) {
  const std::int64_t segments = std::int64_t{1} << unit.index_bits;
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      return 0;
    case ReciprocalKind::lut_linear:
      return segments + 1;
    case ReciprocalKind::lut_newton:
      return segments;
    case ReciprocalKind::lut_quadratic:
      return 3 * segments;
  }
  unreachable();
}

// ---------------------------------------------------------------- depth

// A nearer point has the larger code.
constexpr bool nearer_is_larger(DepthCode code) {
  switch (code) {
    case DepthCode::inverse:
      return true;
    case DepthCode::linear:
    case DepthCode::opengl:
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return false;
  }
  unreachable();
}

// Bits of the exponent of the code w_float; the others are its mantissa's.
inline constexpr int w_float_exponent_bits = 4;

// The stored word packs a floating-point z and the logarithm of dz, which goes by the gradients of h.
constexpr bool has_dz(DepthCode code) {
  switch (code) {
    case DepthCode::float_dz:
      return true;
    case DepthCode::inverse:
    case DepthCode::linear:
    case DepthCode::opengl:
    case DepthCode::w_float:
      return false;
  }
  unreachable();
}
// Bits of the word that hold the logarithm of dz, and the exponent of z; the others are its mantissa's.
inline constexpr int dz_bits = 4;
inline constexpr int float_dz_exponent_bits = 3;
inline constexpr int largest_dz = (1 << dz_bits) - 1;

// The distances that pass the depth test, seen from the one that is stored.
struct PassingDistances {
  bool nearer = false, equal = false, farther = false;
  bool operator==(const PassingDistances&) const = default;
};
constexpr PassingDistances passing_distances(DepthFunc func) {
  switch (func) {
    case DepthFunc::never:
      return {};
    case DepthFunc::less:
      return {.nearer = true};
    case DepthFunc::equal:
      return {.equal = true};
    case DepthFunc::lequal:
      return {.nearer = true, .equal = true};
    case DepthFunc::greater:
      return {.farther = true};
    case DepthFunc::notequal:
      return {.nearer = true, .farther = true};
    case DepthFunc::gequal:
      return {.equal = true, .farther = true};
    case DepthFunc::always:
      return {.nearer = true, .equal = true, .farther = true};
  }
  unreachable();
}
// With has_dz: depths within the tolerance are as far for the comparison. Nearer or farther alone has none.
constexpr bool takes_tolerance(DepthFunc func) {
  const PassingDistances passes = passing_distances(func);
  return passes.nearer == passes.farther ? passes.nearer != passes.equal : passes.equal;
}
// Kernels have a loop of their own for this case, which nearly every picture is drawn with.
constexpr bool passes_only_nearer(DepthFunc func) {
  return passing_distances(func) == PassingDistances{.nearer = true};
}

// The code is linear in the distance, which R_pixel forms of h + B.
constexpr bool is_linear_in_distance(DepthCode code) {
  switch (code) {
    case DepthCode::linear:
      return true;
    case DepthCode::inverse:
    case DepthCode::opengl:
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return false;
  }
  unreachable();
}

// The code is linear in h, without B: another line may take the place of h, or the h of a point that is seen
// from elsewhere.
constexpr bool is_linear_in_h(DepthCode code) {
  switch (code) {
    case DepthCode::inverse:
    case DepthCode::opengl:
      return true;
    case DepthCode::linear:
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return false;
  }
  unreachable();
}

// The code is the largest one minus h.
constexpr bool is_complement_of_h(DepthCode code) {
  switch (code) {
    case DepthCode::opengl:
      return true;
    case DepthCode::inverse:
    case DepthCode::linear:
    case DepthCode::w_float:
    case DepthCode::float_dz:  // what it packs is
      return false;
  }
  unreachable();
}

// Between pixels with exact u and v there are some with linear ones.
constexpr bool has_subspans(const Config& config) {
  return config.subspan_bits > 0 && has_pixel_reciprocal(config.perspective);
}

// Each pixel has a quotient of its own, by R_pixel or by division: what a divided channel asks for.
constexpr bool divides_each_pixel(const Config& config) {
  return !has_linear_texture(config.perspective) && !has_subspans(config);
}

// ---------------------------------------------------------------- light

// The stage light has records, in a view with a light.
constexpr bool has_light(LightAt at) {
  switch (at) {
    case LightAt::none:
      return false;
    case LightAt::face:
    case LightAt::vertex:
    case LightAt::pixel:
      return true;
  }
  unreachable();
}
// Its brightness is formed at vertices, and is the channel light between them.
constexpr bool lights_vertices(LightAt at) {
  switch (at) {
    case LightAt::none:
    case LightAt::pixel:
      return false;
    case LightAt::face:
    case LightAt::vertex:
      return true;
  }
  unreachable();
}
// Its brightness is that of the first vertex, all over the triangle.
constexpr bool lights_faces(LightAt at) {
  switch (at) {
    case LightAt::none:
    case LightAt::vertex:
    case LightAt::pixel:
      return false;
    case LightAt::face:
      return true;
  }
  unreachable();
}
// Its brightness is formed per pixel, of the channels nx, ny and nz.
constexpr bool lights_pixels(LightAt at) {
  switch (at) {
    case LightAt::none:
    case LightAt::face:
    case LightAt::vertex:
      return false;
    case LightAt::pixel:
      return true;
  }
  unreachable();
}
// Lights may stand somewhere.
constexpr bool has_points(LightSource source) {
  switch (source) {
    case LightSource::parallel:
      return false;
    case LightSource::point:
      return true;
  }
  unreachable();
}
constexpr bool has_light_points(const Config& config) {
  return has_light(config.light) && has_points(config.light_source);
}
// Normals may come from a map.
constexpr bool takes_map(LightNormal normal) {
  switch (normal) {
    case LightNormal::channel:
      return false;
    case LightNormal::map:
      return true;
  }
  unreachable();
}
constexpr bool has_relief(const Config& config) {
  return lights_pixels(config.light) && takes_map(config.light_normal);
}
// A shadow map may take light away.
constexpr bool takes_shadow(LightShadow shadow) {
  switch (shadow) {
    case LightShadow::none:
      return false;
    case LightShadow::map:
      return true;
  }
  unreachable();
}
constexpr bool has_light_shadow(const Config& config) {
  return lights_pixels(config.light) && takes_shadow(config.light_shadow);
}
// What scatters falls with the viewer's cosine.
constexpr bool is_lunar(LightLaw law) {
  switch (law) {
    case LightLaw::lambert:
      return false;
    case LightLaw::lunar:
      return true;
  }
  unreachable();
}
constexpr bool has_lunar(const Config& config) {
  return has_light(config.light) && is_lunar(config.light_law);
}
// Brightness falls with a distance.
constexpr bool falls(LightFall fall) {
  switch (fall) {
    case LightFall::none:
      return false;
    case LightFall::first:
    case LightFall::second:
      return true;
  }
  unreachable();
}
constexpr bool falls_by_square(LightFall fall) {
  switch (fall) {
    case LightFall::none:
    case LightFall::first:
      return false;
    case LightFall::second:
      return true;
  }
  unreachable();
}
constexpr bool falls_to_viewer(LightFallTo to) {
  switch (to) {
    case LightFallTo::light:
      return false;
    case LightFallTo::viewer:
      return true;
  }
  unreachable();
}
constexpr bool has_light_fall(const Config& config) {
  return has_light_points(config) && falls(config.light_fall);
}

// ---------------------------------------------------------------- RTL

// rtl/span_setup.sv starts rows so.
constexpr bool is_in_rtl(RowSlope slope) {
  switch (slope) {
    case RowSlope::divide:
    case RowSlope::reciprocal:
      return true;
    case RowSlope::plane:
      return false;
  }
  unreachable();
}

// rtl/depth_code.sv has the code.
constexpr bool is_in_rtl(DepthCode code) {
  switch (code) {
    case DepthCode::inverse:
    case DepthCode::linear:
    case DepthCode::opengl:
      return true;
    case DepthCode::w_float:
    case DepthCode::float_dz:
      return false;
  }
  unreachable();
}

// rtl/texture.sv has the filter.
constexpr bool is_in_rtl(TextureFilter filter) {
  switch (filter) {
    case TextureFilter::nearest:
    case TextureFilter::bilinear:
      return true;
  }
  unreachable();
}

// rtl/texture.sv has the wrap mode.
constexpr bool is_in_rtl(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::cyclic:
    case TextureWrap::clamp:
      return true;
    case TextureWrap::mirror:
    case TextureWrap::border:
      return false;
  }
  unreachable();
}
// rtl/lod.sv has the mode.
constexpr bool is_in_rtl(LodMode lod) {
  switch (lod) {
    case LodMode::none:
    case LodMode::zone_s:
    case LodMode::gradient:
      return true;
    case LodMode::zone_d:
    case LodMode::finite:
      return false;
  }
  unreachable();
}
// rtl/fog.sv has the mode.
constexpr bool is_in_rtl(FogMode mode) {
  switch (mode) {
    case FogMode::none:
    case FogMode::linear:
    case FogMode::table:
    case FogMode::vertex:
      return true;
    case FogMode::distance:
    case FogMode::log:
      return false;
  }
  unreachable();
}

// merge in RTL has the equations, the logic operations and the alpha of every draw state.
constexpr bool has_blend_equation(RtlBlend blend) {
  switch (blend) {
    case RtlBlend::alpha:
      return false;
    case RtlBlend::equation:
      return true;
  }
  unreachable();
}

// ---------------------------------------------------------------- texture, level of detail and fog

// Textures have a mip chain.
constexpr bool has_mip_chain(MipMode mip) {
  switch (mip) {
    case MipMode::none:
      return false;
    case MipMode::nearest:
    case MipMode::linear:
      return true;
  }
  unreachable();
}

// Two levels of the chain are mixed.
constexpr bool mixes_levels(MipMode mip) {
  switch (mip) {
    case MipMode::none:
    case MipMode::nearest:
      return false;
    case MipMode::linear:
      return true;
  }
  unreachable();
}

// A level goes by zones of a distance.
constexpr bool has_zones(LodMode lod) {
  switch (lod) {
    case LodMode::zone_s:
    case LodMode::zone_d:
      return true;
    case LodMode::none:
    case LodMode::gradient:
    case LodMode::finite:
      return false;
  }
  unreachable();
}

// The distance is the true one, d.
constexpr bool takes_true_distance(LodMode lod) {
  switch (lod) {
    case LodMode::zone_d:
      return true;
    case LodMode::none:
    case LodMode::zone_s:
    case LodMode::gradient:
    case LodMode::finite:
      return false;
  }
  unreachable();
}

// A level goes by the gradients of u and v, which setup forms per triangle.
constexpr bool has_gradients(LodMode lod) {
  switch (lod) {
    case LodMode::gradient:
    case LodMode::finite:
      return true;
    case LodMode::none:
    case LodMode::zone_s:
    case LodMode::zone_d:
      return false;
  }
  unreachable();
}

// u and v are compared with those of the pixels right and below, each by a reciprocal of its own.
constexpr bool has_neighbours(LodMode lod) {
  switch (lod) {
    case LodMode::finite:
      return true;
    case LodMode::none:
    case LodMode::zone_s:
    case LodMode::gradient:
    case LodMode::zone_d:
      return false;
  }
  unreachable();
}

// A level goes by R_pixel, which lod forms for itself.
constexpr bool takes_pixel_reciprocal(LodMode lod) {
  switch (lod) {
    case LodMode::zone_s:
    case LodMode::gradient:
    case LodMode::finite:
      return true;
    case LodMode::none:
    case LodMode::zone_d:
      return false;
  }
  unreachable();
}

// The stage lod has records; its key `mode` counts only there.
constexpr bool has_lod(const Config& config) { return has_mip_chain(config.mip); }
constexpr bool has_lod_zones(const Config& config) { return has_lod(config) && has_zones(config.lod); }
constexpr bool has_lod_gradients(const Config& config) {
  return has_lod(config) && has_gradients(config.lod);
}
// setup.gradient has records.
constexpr bool has_setup_gradients(const Config& config) {
  return has_lod_gradients(config) || has_dz(config.depth_code);
}

// A texel is weighed with its neighbours by texture.frac.
constexpr bool weighs_texels(TextureFilter filter) {
  switch (filter) {
    case TextureFilter::nearest:
      return false;
    case TextureFilter::bilinear:
      return true;
  }
  unreachable();
}

// Texels outside of the texture are those of its edge, or have a colour of their own; elsewhere the texture
// repeats.
constexpr bool stops_at_edge(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::cyclic:
    case TextureWrap::mirror:
      return false;
    case TextureWrap::clamp:
    case TextureWrap::border:
      return true;
  }
  unreachable();
}

// Texels outside of the texture have the colour texture.border.
constexpr bool has_border_color(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::border:
      return true;
    case TextureWrap::cyclic:
    case TextureWrap::clamp:
    case TextureWrap::mirror:
      return false;
  }
  unreachable();
}

// The copies of a texture that repeats are turned round by turns.
constexpr bool mirrors(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::mirror:
      return true;
    case TextureWrap::cyclic:
    case TextureWrap::clamp:
    case TextureWrap::border:
      return false;
  }
  unreachable();
}

// Colours are mixed with the fog's.
constexpr bool has_fog(FogMode mode) {
  switch (mode) {
    case FogMode::none:
      return false;
    case FogMode::linear:
    case FogMode::table:
    case FogMode::distance:
    case FogMode::log:
    case FogMode::vertex:
      return true;
  }
  unreachable();
}

// The fog's factor is the value of the channel fog, interpolated between the vertices.
constexpr bool has_vertex_fog(FogMode mode) {
  switch (mode) {
    case FogMode::vertex:
      return true;
    case FogMode::none:
    case FogMode::linear:
    case FogMode::table:
    case FogMode::distance:
    case FogMode::log:
      return false;
  }
  unreachable();
}

// The fog's factor is read from a table by depth and zone.
constexpr bool has_fog_table(FogMode mode) {
  switch (mode) {
    case FogMode::table:
      return true;
    case FogMode::none:
    case FogMode::linear:
    case FogMode::distance:
    case FogMode::log:
    case FogMode::vertex:
      return false;
  }
  unreachable();
}

// The fog's factor is formed of the record of stage `distance`: of s, or of the true distance d.
constexpr bool takes_distance(FogMode mode) {
  switch (mode) {
    case FogMode::distance:
    case FogMode::log:
      return true;
    case FogMode::none:
    case FogMode::linear:
    case FogMode::table:
    case FogMode::vertex:
      return false;
  }
  unreachable();
}
constexpr bool takes_true_distance(FogMode mode) {
  switch (mode) {
    case FogMode::distance:
      return true;
    case FogMode::none:
    case FogMode::linear:
    case FogMode::table:
    case FogMode::log:
    case FogMode::vertex:
      return false;
  }
  unreachable();
}

// How many entries the fog's tables have.
constexpr std::int64_t fog_entries(const Config& config) {
  switch (config.fog) {
    case FogMode::none:
    case FogMode::linear:
    case FogMode::vertex:
      return 0;
    case FogMode::table:
      return std::int64_t{1} << config.fog_index_bits();
    case FogMode::distance:
      return std::int64_t{1} << config.fog_depth_bits;
    case FogMode::log:
      return (std::int64_t{1} << config.fog_depth_bits) + 1;  // at both ends of an interval
  }
  unreachable();
}

// The fog's factor is linear in the distance, which R_pixel forms of h + B.
constexpr bool is_linear_in_distance(FogMode mode) {
  switch (mode) {
    case FogMode::linear:
      return true;
    case FogMode::none:
    case FogMode::table:
    case FogMode::distance:
    case FogMode::log:
    case FogMode::vertex:
      return false;
  }
  unreachable();
}

// The RTL has levels of textures, in the mode that the configuration asks for.
constexpr bool has_levels_in_rtl(const Config& config) { return has_lod(config) && is_in_rtl(config.lod); }

// rtl/pixel_pipe.sv has every stage behind span that the configuration asks for, in the mode that it asks
// for.
constexpr bool pixel_stages_are_in_rtl(const Config& config) {
  return is_in_rtl(config.depth_code) && is_in_rtl(config.filter) && is_in_rtl(config.wrap) &&
         (!has_lod(config) || is_in_rtl(config.lod)) && is_in_rtl(config.fog) && !has_light(config.light);
}

// ---------------------------------------------------------------- distance

// The stage distance forms d, of s and the pixel's zone.
constexpr bool has_true_distance(const Config& config) {
  return (has_lod(config) && takes_true_distance(config.lod)) || takes_true_distance(config.fog);
}
// The stage distance has records.
constexpr bool has_distance(const Config& config) {
  return has_true_distance(config) || takes_distance(config.fog) ||
         (lights_pixels(config.light) && has_points(config.light_source));
}
// s is formed, here or by lod for itself.
constexpr bool has_s(const Config& config) { return has_distance(config) || has_lod_zones(config); }
// Pixels have zones.
constexpr bool has_pixel_zones(const Config& config) {
  return has_fog_table(config.fog) || has_true_distance(config);
}

// ---------------------------------------------------------------- projection

// The stage project divides X and Y by W.
constexpr bool has_project(ProjectUnit unit) {
  switch (unit) {
    case ProjectUnit::reciprocal:
      return true;
    case ProjectUnit::none:
      return false;
  }
  unreachable();
}

// ---------------------------------------------------------------- memory

// There is a cache in front of the buffer.
constexpr bool has_cache(BufferCacheMode mode) {
  switch (mode) {
    case BufferCacheMode::none:
      return false;
    case BufferCacheMode::write_through:
    case BufferCacheMode::write_back:
      return true;
  }
  unreachable();
}

// A write stays in the cache until its line is replaced; elsewhere it goes on to the memory.
constexpr bool keeps_writes(BufferCacheMode mode) {
  switch (mode) {
    case BufferCacheMode::write_back:
      return true;
    case BufferCacheMode::none:
    case BufferCacheMode::write_through:
      return false;
  }
  unreachable();
}

// The bits of a line's number above those of its set have a say in the set.
constexpr bool folds_upper_bits(SetHash hash) {
  switch (hash) {
    case SetHash::xor_upper:
      return true;
    case SetHash::none:
      return false;
  }
  unreachable();
}

}  // namespace bitspan
