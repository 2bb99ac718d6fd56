// SPDX-License-Identifier: Apache-2.0
// The table of keys itself; keys.cpp is what follows from it.
#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "config/check.hpp"
#include "config/keys.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"

namespace bitspan {
namespace {

Place place_of(int& v) { return &v; }
Place place_of(bool& v) { return &v; }
Place place_of(StartOffset& v) { return &v; }
Place place_of(Color& v) { return &v; }
Place place_of(Rgba& v) { return &v; }
Place place_of(Format& v) { return &v; }
template <class E>
requires std::is_enum_v<E> Place place_of(E& v) {
  static_assert(std::is_same_v<std::underlying_type_t<E>, std::uint8_t> && !enum_names<E>.empty());
  return Choice{reinterpret_cast<std::uint8_t*>(&v), enum_names<E>};  // a byte may name any object
}

Reciprocal& unit_of(Config& c, std::size_t i) {
  return i == 0 ? c.edge_reciprocal : i == 1 ? c.row_reciprocal : c.pixel_reciprocal;
}
const Reciprocal& unit_of(const Config& c, std::size_t i) {
  return i == 0 ? c.edge_reciprocal : i == 1 ? c.row_reciprocal : c.pixel_reciprocal;
}

bool is_lut(const Config& c, std::size_t i) { return has_table(unit_of(c, i).kind); }
bool is_restoring(const Config& c, std::size_t i) { return !is_lut(c, i); }
bool is_newton(const Config& c, std::size_t i) { return has_newton_steps(unit_of(c, i).kind); }
std::string for_kind(const Config& c, std::size_t i) {
  return " for " + std::string(to_string(unit_of(c, i).kind));
}
bool in_rtl_unit(std::size_t i) { return i != 0; }

bool reads_border(const Config& c, std::size_t /*i*/) { return has_border_color(c.wrap); }
bool reads_fog_table(const Config& c, std::size_t /*i*/) { return fog_entries(c) > 0; }
bool reads_pixel_zones(const Config& c, std::size_t /*i*/) { return has_pixel_zones(c); }
std::string beside_depth_bits(const Config& c, std::size_t /*i*/) {
  return " beside " + std::to_string(c.fog_depth_bits) + " depth_bits, so that the index has at most " +
         std::to_string(max_fog_index_bits);
}
std::string of_depth_bits(const Config& /*c*/, std::size_t /*i*/) { return ", and at most depth.bits"; }

bool reads_subspans(const Config& c, std::size_t /*i*/) { return has_pixel_reciprocal(c.perspective); }
bool reads_lod(const Config& c, std::size_t /*i*/) { return has_lod(c); }
bool reads_zones(const Config& c, std::size_t /*i*/) { return has_lod_zones(c); }

bool reads_light(const Config& c, std::size_t /*i*/) { return has_light(c.light); }
bool reads_light_fall(const Config& c, std::size_t /*i*/) { return has_light_fall(c); }

// Of a Config, const or not.
auto& cache_of(auto& c, std::size_t i) { return i == 0 ? c.memory.depth_cache : c.memory.color_cache; }
bool has_buffer_cache(const Config& c, std::size_t i) { return has_cache(cache_of(c, i).mode); }

// The clocks of the others follow from the RTL.
bool has_own_clocks(const Config& /*c*/, std::size_t i) { return static_cast<Stage>(i) < Stage::span_setup; }

// In front of span stands the result register of span_setup.
bool has_fifo(const Config& /*c*/, std::size_t i) { return static_cast<Stage>(i) != Stage::span; }

// The registers of the RTL, and those that its pixel index or the units' operands hang on.
bool in_rtl_format(std::size_t i) {
  using F = FormatId;
  constexpr std::array registers{
      F::setup_b,      F::edge_x,      F::edge_x_acc, F::edge_h,          F::edge_uv,        F::edge_shade,
      F::plane_k,      F::span_h_step, F::span_h,     F::span_f_diff,     F::span_f_step,    F::span_f,
      F::span_uv_step, F::span_uv_acc, F::span_uv,    F::span_shade_step, F::span_shade_acc, F::span_shade};
  if (std::ranges::find(registers, static_cast<F>(i)) != registers.end()) return true;
  for (int channel = 0; channel < channel_limit; ++channel) {
    const Line line = line_of(channel_line(channel), Perspective::delta_f);
    const std::array of_channel{line.edge.kept, line.row.step, line.row.acc, line.row.kept};
    if (std::ranges::find(of_channel, static_cast<F>(i)) != of_channel.end()) return true;
  }
  return false;
}

std::optional<Format> format_by_default(const Config& c, std::size_t i) {
  return default_format(c.formats, static_cast<FormatId>(i));
}

constexpr unsigned ideal = affects::ideal, values = affects::values, clocks = affects::clocks,
                   rtl = affects::rtl;

constexpr KeyUse of_lut{Presence::where_used, "restoring", is_lut, Unused::zero, for_kind, in_rtl_unit};
constexpr KeyUse of_newton{Presence::where_used, "the kinds without steps", is_newton, Unused::zero, for_kind,
                           in_rtl_unit};
constexpr KeyUse of_restoring{Presence::where_used, "the table kinds", is_restoring,
                              Unused::zero,         for_kind,          in_rtl_unit};
constexpr KeyUse of_buffer_cache{
    .presence = Presence::later, .used = has_buffer_cache, .unused = Unused::initial};
constexpr KeyUse of_own_clocks{
    .presence = Presence::where_used, .unused_for = "the stages from span_setup on", .used = has_own_clocks};

#define MEMBER(m) #m, [](Config & c, [[maybe_unused]] std::size_t i) { return place_of(c.m); }
#define IN_UNIT(m) "UNIT_reciprocal." #m, [](Config& c, std::size_t i) { return place_of(unit_of(c, i).m); }
#define IN_CACHE(m) \
  "memory.BUFFER_cache." #m, [](Config& c, std::size_t i) { return place_of(cache_of(c, i).m); }

constexpr KeyRow rows[] = {
    {"raster.subpixel_bits",
     MEMBER(subpixel_bits),
     {0, 12},
     "",
     ideal | values,
     "vertices snap to 2^-this pixel"},
    {"raster.coordinate_bits",
     MEMBER(coordinate_bits),
     {2, 24},
     "",
     ideal | values | rtl,
     "integer bits of a snapped coordinate, sign included: 16 holds -32768..32767 pixels"},
    {"raster.fill_rule",
     MEMBER(fill_rule),
     {},
     "",
     ideal | values,
     "a shared edge is drawn once; or both ends of every line are drawn"},
    {"raster.edge_walk",
     MEMBER(edge_walk),
     {},
     "",
     values | rtl,
     "an integer error term; or a slope register of the format `edge.x_step`"},
    {"raster.dda_update",
     MEMBER(dda_update),
     {},
     "",
     values,
     "dda: the slope is added once per row; or multiplied by the rows from the start"},

    {"perspective.mode",
     MEMBER(perspective),
     {},
     "",
     values | clocks | rtl,
     "T1: one reciprocal per pixel; N1, N2: one per row of constant depth; N3: two divides per pixel; none"},
    {"perspective.numerator",
     MEMBER(numerator),
     {},
     "",
     values,
     "const_depth_rows: where u q and v q are taken"},
    {"perspective.subspan_bits",
     MEMBER(subspan_bits),
     {0, max_subspan_bits},
     "",
     values | rtl,
     "delta_f: u and v are exact at each 2^this-th pixel of a row, and linear between them; 0: at every "
     "pixel",
     {.presence = Presence::later, .used = reads_subspans, .unused = Unused::initial}},
    {"perspective.shades",
     MEMBER(shade_lines),
     {},
     ", perspective with a quotient per pixel",
     ideal | values | rtl,
     "colour and alpha are linear on the screen; or in space, by the channels shade_*",
     {.presence = Presence::later}},

    {"slope.edge",
     MEMBER(edge_slope),
     {},
     "",
     values,
     "an edge's slopes: exact quotients, or products with one rounded reciprocal"},
    {"slope.row",
     MEMBER(row_slope),
     {},
     ", plane not in const_depth_rows",
     values | clocks | rtl,
     "the same for a row, whose ends then carry values; or none: gradients of the triangle, divided as "
     "slope.edge says by its area; const_depth_rows has no row slopes"},

    {"reciprocal.UNIT.kind",
     IN_UNIT(kind),
     {},
     "",
     values | clocks | rtl,
     "UNIT is edge (of an edge's height), row (of a span's length; of h + B in const_depth_rows) or pixel "
     "(of "
     "h + B); reciprocals.md describes the kinds",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.normalize",
     IN_UNIT(normalize),
     {},
     "",
     values | clocks | rtl,
     "mantissa and exponent; or one fixed-point number",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.operand_bits",
     IN_UNIT(operand_bits),
     {2, 60},
     "",
     values | rtl,
     "fraction bits kept of the normalised operand",
     of_lut},
    {"reciprocal.UNIT.index_bits",
     IN_UNIT(index_bits),
     {1, 12},
     ", under operand_bits",
     values | rtl,
     "the table has 2^this intervals",
     of_lut},
    {"reciprocal.UNIT.table_bits",
     IN_UNIT(table_bits),
     {2, 40},
     "",
     values | rtl,
     "fraction bits of a table entry",
     of_lut},
    {"reciprocal.UNIT.internal_bits",
     IN_UNIT(internal_bits),
     {2, 60},
     "",
     values | rtl,
     "fraction bits after each step",
     of_lut},
    {"reciprocal.UNIT.steps", IN_UNIT(steps), {0, 4}, "", values | clocks | rtl, "Newton steps", of_newton},
    {"reciprocal.UNIT.bits_per_cycle",
     IN_UNIT(bits_per_cycle),
     {1, 8},
     "",
     clocks | rtl,
     "quotient bits made per clock",
     of_restoring},
    {"reciprocal.UNIT.pipelined",
     IN_UNIT(pipelined),
     {},
     "; pixel: true",
     clocks | rtl,
     "one operand per clock; or one at a time",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.output",
     IN_UNIT(output),
     {},
     ", unsigned, with a fraction; normalised: able to hold 1, or int = 0 and saturating",
     values | clocks | rtl,
     "of the mantissa; not normalised: of the reciprocal",
     {.in_rtl = in_rtl_unit}},

    {"start_offset.edge_x",
     MEMBER(start_offset.edge_x),
     {},
     "",
     values,
     "added to the start of edge.x_acc (dda); half an ulp of edge.x"},
    {"start_offset.edge_h",
     MEMBER(start_offset.edge_h),
     {},
     "",
     values,
     "added to the start of edge.h_acc; half an ulp of edge.h"},
    {"start_offset.edge_f",
     MEMBER(start_offset.edge_f),
     {},
     "",
     values,
     "added to the start of edge.f; half an ulp of it"},
    {"start_offset.edge_shade",
     MEMBER(start_offset.edge_shade),
     {},
     "",
     values,
     "added to the start of edge.shade_acc; half an ulp of edge.shade"},
    {"start_offset.span_h",
     MEMBER(start_offset.span_h),
     {},
     "",
     values | rtl,
     "added to the start of span.h; half a depth code"},
    {"start_offset.span_f",
     MEMBER(start_offset.span_f),
     {},
     "",
     values | rtl,
     "added to the start of span.f (delta_f, hyperbolic; half an ulp of it) or of span.uv_acc (affine, "
     "const_depth_rows; half an ulp of span.uv)"},
    {"start_offset.span_shade",
     MEMBER(start_offset.span_shade),
     {},
     "",
     values | rtl,
     "added to the start of span.shade_acc; half an ulp of span.shade"},

    {"depth.bits",
     MEMBER(depth_bits),
     {8, 32},
     "",
     ideal | values | clocks,
     "the depth buffer's bits; hmax = 2^bits - 1"},
    {"depth.code",
     MEMBER(depth_code),
     {},
     "",
     ideal | values | clocks,
     "D1; the two codes of H6; floating point of W; floating point with the logarithm of dz"},
    {"depth.line",
     MEMBER(depth_line),
     {},
     ", z with depth.code = inverse or opengl",
     ideal | values | rtl,
     "the code is of h, which follows from the distance; or of the channel z, which the vertices give",
     {.presence = Presence::later}},
    {"depth.func",
     MEMBER(depth_func),
     {},
     "",
     ideal | values,
     "which fragments pass, by distance: `less` those nearer than what is stored",
     {.presence = Presence::later}},
    {"depth.round", MEMBER(depth_rounding), {}, "", values, "of the stored code"},
    {"depth.overflow", MEMBER(depth_overflow), {}, " but SC_WRAP_SM", values, "of the stored code"},

    {"texture.filter", MEMBER(filter), {}, "", ideal | values | clocks, "one texel; T3, four"},
    {"texture.wrap",
     MEMBER(wrap),
     {},
     "",
     ideal | values | clocks,
     "T7; the edge texel goes on; every second copy is turned round; `texture.border`"},
    {"texture.transparent",
     MEMBER(transparent),
     {},
     "",
     ideal | values,
     "T4: texels of exactly this colour are holes"},
    {"texture.border",
     MEMBER(border),
     {},
     "",
     ideal | values,
     "border: the colour and alpha of every texel outside of the texture",
     {.presence = Presence::later, .used = reads_border}},
    {"texture.second",
     MEMBER(second_coordinates),
     {},
     ", own with a quotient per pixel",
     ideal | values | rtl,
     "the second unit has the coordinates of the first one; or its own, the channels u2 and v2",
     {.presence = Presence::later}},

    {"texture.mip",
     MEMBER(mip),
     {},
     "; with a chain, textures have sides that are powers of two",
     ideal | values | clocks,
     "T10: no mip chain; the nearest level of it; T11: the two nearest levels, mixed",
     {.presence = Presence::later}},

    {"lod.mode",
     MEMBER(lod),
     {},
     ", gradient and finite not in affine",
     ideal | values,
     "what a level is chosen by: lod.bias alone; zones of the distance s; the gradients of u and v; zones of "
     "the true distance; differences of u and v to the next pixels",
     {.presence = Presence::later, .used = reads_lod, .unused = Unused::initial}},
    {"lod.bias",
     MEMBER(lod_bias),
     {-31, 32, false, " sixteenths of a level"},
     "",
     ideal | values,
     "added to the level",
     {.presence = Presence::later, .used = reads_lod, .unused = Unused::initial}},
    {"lod.first",
     MEMBER(lod_first),
     {1, 65536},
     "",
     ideal | values,
     "zone_s, zone_d: the distance of level 0 in 2^-16 of 2^E, where s_max is at most 2^E; each further "
     "level "
     "doubles "
     "it",
     {.presence = Presence::later, .used = reads_zones, .unused = Unused::initial}},

    {"project.unit",
     MEMBER(project),
     {},
     ", reciprocal with depth.code = inverse or opengl",
     values | rtl,
     "T14, SH2: no projection; X and Y of the projector, divided by W with R_pixel(W)",
     {.presence = Presence::later}},

    {"light.at",
     MEMBER(light),
     {},
     "",
     ideal | values | rtl,
     "no light; L4: a brightness per triangle; L5: per vertex, linear between them; L6: per pixel",
     {.presence = Presence::later}},
    {"light.source",
     MEMBER(light_source),
     {},
     "",
     ideal | values,
     "lights that are far away; or lights that stand at a point, too",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.normal",
     MEMBER(light_normal),
     {},
     ", map with light.at = pixel",
     ideal | values | rtl,
     "L6: the channels nx, ny and nz; T15: or the texel of the second unit, while texture1.op = relief",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.shadow",
     MEMBER(light_shadow),
     {},
     ", map with light.at = pixel",
     ideal | values,
     "no shadow; SH2: all but the ambient light is multiplied by the red share of the second unit's texel, "
     "while texture1.op = shadow",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.law",
     MEMBER(light_law),
     {},
     "",
     ideal | values,
     "L1: scattered light by the cosine; L3: divided by 1 + k times the viewer's cosine",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.fall",
     MEMBER(light_fall),
     {},
     ", none with light.source = parallel",
     ideal | values,
     "B9: the power of the distance that brightness falls by",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.fall_to",
     MEMBER(light_fall_to),
     {},
     "",
     ideal | values,
     "what that distance is to",
     {.presence = Presence::later, .used = reads_light_fall, .unused = Unused::initial}},
    {"light.index_bits",
     MEMBER(light_index_bits),
     {1, 12},
     "",
     values,
     "L2: the table of the highlight has 2^this intervals",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.root.operand_bits",
     MEMBER(light_root.operand_bits),
     {2, 32},
     ", above index_bits",
     values,
     "fraction bits kept of the reciprocal square root's operand, 1 to 4",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.root.index_bits",
     MEMBER(light_root.index_bits),
     {1, 12},
     "",
     values,
     "its table has 2^this entries for 1 to 2, and as many for 2 to 4",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.root.table_bits",
     MEMBER(light_root.table_bits),
     {1, 24},
     "",
     values,
     "fraction bits of an entry",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.root.internal_bits",
     MEMBER(light_root.internal_bits),
     {1, 32},
     "",
     values,
     "fraction bits after each Newton step",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},
    {"light.root.steps",
     MEMBER(light_root.steps),
     {0, 4},
     "",
     values,
     "Newton steps",
     {.presence = Presence::later, .used = reads_light, .unused = Unused::initial}},

    {"fog.mode",
     MEMBER(fog),
     {},
     "",
     ideal | values | clocks | rtl,
     "F3: 1 - S/DT; F2: a table by depth and distance from the picture's middle; F1: a table by the true "
     "distance; by log2 of the distance, linear between entries; F4: between the factors at the vertices"},
    {"fog.depth_bits",
     MEMBER(fog_depth_bits),
     {1, max_fog_index_bits, false, "", most_fog_depth_bits},
     ", at most depth.bits",
     values,
     "of the table's index: top bits of h, of the true distance, or of log2 of the distance",
     {.presence = Presence::optional,
      .used = reads_fog_table,
      .unused = Unused::initial,
      .reason = of_depth_bits}},
    {"fog.zone_bits",
     MEMBER(fog_zone_bits),
     {0, 8, false, "", most_fog_zone_bits},
     ", at most 12 with depth_bits",
     values | clocks,
     "bits of the zone of a pixel's distance r from the picture's middle",
     {.presence = Presence::optional,
      .used = reads_pixel_zones,
      .unused = Unused::initial,
      .reason = beside_depth_bits}},
    {"fog.zone",
     MEMBER(fog_zone),
     {},
     "",
     values,
     "what the zones divide into equal parts: r^2; r",
     {.presence = Presence::later, .used = reads_pixel_zones, .unused = Unused::initial}},

    {"formats.FORMAT",
     MEMBER(formats[i]),
     {},
     "",
     values | clocks | rtl,
     "",
     {.in_rtl = in_rtl_format, .default_format = format_by_default}},

    {"timing.STAGE.latency",
     MEMBER(timing[i].latency),
     {1, 1000, false, " clocks"},
     "",
     clocks,
     "timed model: clocks from acceptance to delivery; those from span_setup on have the RTL's, and a value "
     "given is not used",
     of_own_clocks},
    {"timing.STAGE.interval",
     MEMBER(timing[i].interval),
     {1, 1000, false, " clocks"},
     "",
     clocks,
     "clocks from one acceptance to the next",
     of_own_clocks},
    {"timing.STAGE.fifo",
     MEMBER(timing[i].fifo),
     {1, 65536, false, " records"},
     "",
     clocks,
     "records that fit in front of the stage; not used for span, for which rtl.fifo counts",
     {.used = has_fifo}},

    {"memory.latency",
     MEMBER(memory.latency),
     {1, 10000, false, " clocks"},
     "",
     clocks,
     "clocks from a read request to its first beat"},
    {"memory.width_bytes", MEMBER(memory.width_bytes), {1, 1024, true}, "", clocks, "bytes per clock"},
    {"memory.cache_line_bytes",
     MEMBER(memory.cache_line_bytes),
     {4, 4096, true},
     ", at least width_bytes",
     clocks,
     "the texture cache's line"},
    {"memory.cache_sets", MEMBER(memory.cache_sets), {1, 65536, true}, "", clocks, "its sets"},
    {"memory.cache_ways", MEMBER(memory.cache_ways), {1, 64}, "", clocks, "its lines per set"},
    {"memory.cache_hash",
     MEMBER(memory.cache_hash),
     {},
     "",
     clocks,
     "a line's set: its number mod cache_sets; or this XOR (number / cache_sets) mod cache_sets",
     {.presence = Presence::later}},
    {"memory.BUFFER_cache",
     IN_CACHE(mode),
     {},
     "",
     clocks,
     "BUFFER is depth or color. Its cache: none; writes go on to the memory; a line written is kept until "
     "it is replaced",
     {.presence = Presence::later}},
    {"memory.BUFFER_cache_line_bytes",
     IN_CACHE(line_bytes),
     {4, 4096, true},
     ", at least width_bytes",
     clocks,
     "its line",
     of_buffer_cache},
    {"memory.BUFFER_cache_sets", IN_CACHE(sets), {1, 65536, true}, "", clocks, "its sets", of_buffer_cache},
    {"memory.BUFFER_cache_ways", IN_CACHE(ways), {1, 64}, "", clocks, "its lines per set", of_buffer_cache},
    {"memory.BUFFER_cache_hash", IN_CACHE(hash), {}, "", clocks, "as cache_hash", of_buffer_cache},

    {"rtl.product_clocks",
     MEMBER(rtl.product_clocks),
     {1, 8, false, " clocks"},
     "",
     clocks | rtl,
     "clocks of each multiplication: 2 registers the partial products, 3 their rows, 4 the factors, 5 the "
     "partial products twice",
     {.presence = Presence::later}},
    {"rtl.normalise_clocks",
     MEMBER(rtl.normalise_clocks),
     {1, 3, false, " clocks"},
     "",
     clocks | rtl,
     "clocks in which a reciprocal unit counts an operand's leading zeros and shifts them out",
     {.presence = Presence::later}},
    {"rtl.setup_multipliers",
     MEMBER(rtl.setup_multipliers),
     {1, 16},
     "",
     clocks | rtl,
     "products that span_setup forms per clock: a row has eight, eight more with shades, two per channel, "
     "and two per Newton step",
     {.presence = Presence::later}},
    {"rtl.product_digits",
     MEMBER(rtl.product_digits),
     {1, 8},
     "",
     clocks | rtl,
     "clocks for which a product of span_setup has its multiplier, which takes one factor in so many digits",
     {.presence = Presence::later}},
    {"rtl.fifo",
     MEMBER(rtl.fifo),
     {1, 16, false, " records"},
     "",
     clocks | rtl,
     "span records that fit between span_setup and span",
     {.presence = Presence::later}},
    {"rtl.pixel_clocks",
     MEMBER(rtl.pixel_clocks),
     {1, 16, false, " clocks"},
     ", 1 or at least 2 rtl.product_digits",
     clocks | rtl,
     "delta_f: clocks per pixel; from 2 on u and v take turns in one multiplier of rtl.product_digits",
     {.presence = Presence::later}},
    {"rtl.shades",
     MEMBER(rtl.shades),
     {},
     "",
     clocks | rtl,
     "the span interpolator has colour and alpha; or the engine `rtl` takes the model's",
     {.presence = Presence::later}},
    {"rtl.blend",
     MEMBER(rtl.blend),
     {},
     "",
     clocks,
     "what merge in RTL has: the mix by alpha alone; or every blend, logic operation and destination alpha "
     "of the draw state",
     {.presence = Presence::later}},

    {"line.walk",
     MEMBER(line_walk),
     {},
     ", none in const_depth_rows, with slope.row = plane, with gradients or with channels",
     values | rtl,
     "B1: no lines are drawn; by the integers of Bresenham; by a slope of the format `plane.k`",
     {.presence = Presence::later}},
};

#undef MEMBER
#undef IN_UNIT
#undef IN_CACHE
#define FIELD(m) #m, [](Format & f) { return place_of(f.m); }

constexpr FieldRow fields[] = {
    {"signed", FIELD(is_signed), "true, false", "two's complement, or no sign", values | clocks | rtl},
    {"word", FIELD(word), "1..64 signed, 1..63 unsigned", "all bits", values | clocks | rtl},
    {"int", FIELD(integer), "-32..64, and word - int in -32..64",
     "bits left of the binary point, the sign included; an ulp is 2^(int - word)", values | clocks | rtl},
    {"round", FIELD(rounding), "",
     "nearest, a tie going up, to zero, down, away from zero, to even; down; to zero", values | rtl},
    {"overflow", FIELD(overflow), " (the last signed only)",
     "low bits; clamp; 0; clamp to a symmetric range; sign-magnitude wrap", values | rtl},
    {"overflow_expected", FIELD(overflow_expected), "true, false",
     "the scene may exceed the format on purpose: the range check keeps silent", 0, Presence::later},
};
#undef FIELD

}  // namespace

std::span<const KeyRow> key_rows() { return rows; }
std::span<const FieldRow> field_rows() { return fields; }

}  // namespace bitspan
