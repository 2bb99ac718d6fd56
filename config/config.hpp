// SPDX-License-Identifier: Apache-2.0
// The configuration: one TOML file, read strictly, that every view takes its widths and modes from.
// config/key_table.cpp is the table of its keys, from which reader, writer, hash, checks and documentation
// follow; config/*.toml are the shipped ones, with one comment per key.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "config/format.hpp"
#include "config/names.hpp"
#include "config/stages.hpp"

namespace bitspan {

// Bad input of any kind: the text is one line that says where (file, line, key) and what was expected.
// The command line prints it and exits with 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

BITSPAN_ENUM(FillRule, top_left, inclusive);
BITSPAN_ENUM(EdgeWalk, exact, dda);
BITSPAN_ENUM(DdaUpdate, accumulate, multiply);
// How lines between whole pixels go: they are not drawn; by Bresenham's integers; by a slope of plane.k.
BITSPAN_ENUM(LineForm, none, exact, dda);
BITSPAN_ENUM(Perspective, delta_f, const_depth_rows, hyperbolic, affine);
BITSPAN_ENUM(Numerator, pixel_centre, ideal_line);
// Colour and alpha are linear on the screen, or linear in space: then each pixel divides them, as u and v.
BITSPAN_ENUM(ShadeLines, linear, perspective);
BITSPAN_ENUM(SlopeForm, divide, reciprocal);
// What a row starts from: its ends, by slopes of one of these forms; or the plane of its triangle.
BITSPAN_ENUM(RowSlope, divide, reciprocal, plane);
BITSPAN_ENUM(ReciprocalKind, restoring, lut_linear, lut_newton, lut_quadratic);
BITSPAN_ENUM(DepthCode, inverse, linear, opengl, w_float, float_dz);
// What the depth code is of: h, which follows from the distance; or the channel z, a line of its own.
BITSPAN_ENUM(DepthLine, h, z);
// By distance: `less` passes what is nearer, whatever the direction of the code.
BITSPAN_ENUM(DepthFunc, never, less, equal, lequal, greater, notequal, gequal, always);
BITSPAN_ENUM(TextureFilter, nearest, bilinear);
BITSPAN_ENUM(TextureWrap, cyclic, clamp, mirror, border);
// The coordinates of the second texture unit: those of the first one, or the channels u2 and v2.
BITSPAN_ENUM(SecondCoordinates, first, own);
// Levels of a texture's mip chain: the texture alone; the nearest level; the two nearest, mixed.
BITSPAN_ENUM(MipMode, none, nearest, linear);
// What a level is chosen by: the bias alone; zones of the distance s; the gradients of u and v on the screen;
// zones of the true distance d; the differences of u and v to the pixels right and below.
BITSPAN_ENUM(LodMode, none, zone_s, gradient, zone_d, finite);
// What the fog's factor is formed of: s, linearly; a table by depth and zone; one by d; one by log2 of s,
// between whose entries it is linear; the factors at the vertices, by the channel fog.
BITSPAN_ENUM(FogMode, none, linear, table, distance, log, vertex);
// The zones of a pixel's distance r from the picture's middle have equal widths in r^2, or in r.
BITSPAN_ENUM(FogZone, r2, r);
// The unit that divides the channels project_*: none; one that takes R_pixel of W.
BITSPAN_ENUM(ProjectUnit, none, reciprocal);
// Where the stage light forms a brightness: nowhere; once per triangle, of its first vertex [L4]; at the
// vertices, between which the channel light runs [L5]; per pixel, of the channels nx, ny and nz [L6].
BITSPAN_ENUM(LightAt, none, face, vertex, pixel);
// How a surface scatters: by the cosine alone [L1], or divided by 1 + k cos(viewer) [L3].
BITSPAN_ENUM(LightLaw, lambert, lunar);
// Whose normals light takes: the channels nx, ny and nz; or those of a map, too [T15].
BITSPAN_ENUM(LightNormal, channel, map);
// What of its light a shadow map takes from a pixel: nothing; or all that is not ambient [SH2].
BITSPAN_ENUM(LightShadow, none, map);
// By which power of a distance brightness falls [B9], and what the distance is to.
BITSPAN_ENUM(LightFall, none, first, second);
BITSPAN_ENUM(LightFallTo, light, viewer);
// What lights it takes: those that are far away, or those that stand somewhere, too.
BITSPAN_ENUM(LightSource, parallel, point);
// A cache between the pixel stages and a buffer: none; one whose writes go on to the memory at once; one that
// keeps them until the line is replaced.
BITSPAN_ENUM(BufferCacheMode, none, write_through, write_back);
// Which set of a cache a line goes into: by its low bits; by these XOR the bits above them.
BITSPAN_ENUM(SetHash, none, xor_upper);
// What merge in RTL makes of a fragment and the stored colour: one mix by alpha; any blend and logic
// operation.
BITSPAN_ENUM(RtlBlend, alpha, equation);

// One reciprocal unit R; docs/numeric-spec.md, "Reciprocal", defines each kind in the value domain.
struct Reciprocal {
  ReciprocalKind kind = ReciprocalKind::restoring;
  bool normalize = true;   // mantissa and exponent, or one fixed-point number
  int operand_bits = 0;    // lut kinds: fraction bits kept of the normalised operand
  int index_bits = 0;      // lut kinds: the table has 2^index_bits entries
  int table_bits = 0;      // lut kinds: fraction bits of a table entry
  int internal_bits = 0;   // lut kinds: fraction bits after each step
  int steps = 0;           // lut_newton: Newton steps
  int bits_per_cycle = 1;  // restoring: quotient bits per clock
  bool pipelined = true;   // accepts an operand each clock; else one at a time
  Format output;           // of the mantissa when normalised, of the reciprocal when not
  bool operator==(const Reciprocal&) const = default;
};

// The reciprocal square root of the stage light; docs/numeric-spec.md, "Reciprocal square root". The register
// light.root is its output.
struct RootUnit {
  int operand_bits = 20;   // fraction bits kept of the normalised operand
  int index_bits = 6;      // the table has 2^index_bits entries per octave, of two
  int table_bits = 10;     // fraction bits of a table entry
  int internal_bits = 24;  // fraction bits after each step
  int steps = 2;           // Newton steps
  bool operator==(const RootUnit&) const = default;
};

// A constant added to an accumulator's start value: half an ULP of the format the accumulator is
// narrowed to, or a number in the accumulator's unit (a multiple of half its ULP).
struct StartOffset {
  bool half_ulp = false;
  double value = 0.0;
  bool operator==(const StartOffset&) const = default;
};

struct StartOffsets {
  StartOffset edge_x, edge_h, edge_f, edge_shade, span_h, span_f, span_shade;
  bool operator==(const StartOffsets&) const = default;
};

// Timed model only. From span_setup on, latency and interval are the RTL's, and only `fifo` is read; for span
// nothing is, since the FIFO in front of it is the RTL's, too.
struct StageTiming {
  int latency = 1;   // clocks from acceptance to delivery
  int interval = 1;  // initiation interval, clocks
  int fifo = 2;      // capacity of the FIFO in front of the stage, records
  bool operator==(const StageTiming&) const = default;
};

// The cache of the depth or the colour buffer.
struct BufferCache {
  BufferCacheMode mode = BufferCacheMode::none;
  int line_bytes = 64;
  int sets = 64;
  int ways = 2;
  SetHash hash = SetHash::none;
  bool operator==(const BufferCache&) const = default;
};

struct MemoryTiming {
  int latency = 20;           // clocks from a read request to its first beat
  int width_bytes = 8;        // bytes per clock
  int cache_line_bytes = 64;  // of the texture cache, as the next three
  int cache_sets = 64;
  int cache_ways = 2;
  SetHash cache_hash = SetHash::none;
  BufferCache depth_cache{}, color_cache{};
  bool operator==(const MemoryTiming&) const = default;
};

// How the RTL is cut into clocks and multipliers, and what it has. No value changes with it.
struct RtlShape {
  int product_clocks = 3;            // of each multiplication
  int normalise_clocks = 3;          // of a reciprocal unit's operand
  int setup_multipliers = 1;         // products that span_setup may form per clock
  int product_digits = 1;            // clocks for which a product that takes turns has its multiplier
  int fifo = 1;                      // span records that fit between span_setup and span
  int pixel_clocks = 1;              // delta_f: clocks per pixel of span; from 2 on u and v take turns
  bool shades = true;                // the RTL has colour and alpha; else the engine `rtl` takes the model's
  RtlBlend blend = RtlBlend::alpha;  // of merge; in other draw states the engine `rtl` takes the model's
  bool operator==(const RtlShape&) const = default;
};

// Red, green, blue; or none.
using Color = std::optional<std::array<std::uint8_t, 3>>;
using Rgba = std::array<std::uint8_t, 4>;

inline constexpr int max_fog_index_bits = 12;

inline constexpr int max_subspan_bits = 6;

// A texture with a mip chain has sides of at most 2^this texels.
inline constexpr int max_mip_level = 15;

// What a register's row in BITSPAN_FORMATS says where a file leaves the register out, beside the `formats` of
// the others; none where the file must give it.
constexpr std::optional<Format> default_format(const std::array<Format, format_count>& formats, FormatId id) {
  const FormatDefault& by_default = format_defaults[static_cast<std::size_t>(id)];
  // Not std::get_if: an address is no constant for GCC's sanitizers.
  if (std::holds_alternative<FormatId>(by_default))
    return formats[static_cast<std::size_t>(std::get<FormatId>(by_default))];
  if (std::holds_alternative<Format>(by_default)) return std::get<Format>(by_default);
  return std::nullopt;
}
constexpr std::array<Format, format_count> initial_formats() {
  std::array<Format, format_count> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = default_format(out, static_cast<FormatId>(i)).value_or(Format{});
  }
  return out;
}

// A member is no key yet: config/key_table.cpp has one row per key.
struct Config {
  std::string name;  // the file's stem; not part of the hash

  // [raster]
  int subpixel_bits = 4;     // k: vertices snap to 2^-k pixel
  int coordinate_bits = 16;  // integer bits of a snapped coordinate, sign included
  FillRule fill_rule = FillRule::top_left;
  EdgeWalk edge_walk = EdgeWalk::exact;
  DdaUpdate dda_update = DdaUpdate::accumulate;

  // [line]
  LineForm line_walk = LineForm::none;

  // [perspective]
  Perspective perspective = Perspective::delta_f;
  Numerator numerator = Numerator::pixel_centre;
  int subspan_bits = 0;  // delta_f: u and v are exact at each 2^this-th pixel, and linear between them
  ShadeLines shade_lines = ShadeLines::linear;

  // [slope]
  SlopeForm edge_slope = SlopeForm::divide;
  RowSlope row_slope = RowSlope::reciprocal;

  // [reciprocal.edge], [reciprocal.row], [reciprocal.pixel]
  Reciprocal edge_reciprocal, row_reciprocal, pixel_reciprocal;

  // [start_offset]
  StartOffsets start_offset;

  // [depth]
  int depth_bits = 16;
  DepthCode depth_code = DepthCode::inverse;
  DepthLine depth_line = DepthLine::h;
  DepthFunc depth_func = DepthFunc::less;
  Rounding depth_rounding = Rounding::trn;
  Overflow depth_overflow = Overflow::sat;

  // [texture]
  TextureFilter filter = TextureFilter::nearest;
  TextureWrap wrap = TextureWrap::cyclic;
  Rgba border{};      // of texels outside of the texture, where wrap = border
  Color transparent;  // T4: the reserved texel value
  SecondCoordinates second_coordinates = SecondCoordinates::first;

  MipMode mip = MipMode::none;

  // [lod]
  LodMode lod = LodMode::none;
  int lod_bias = 0;      // added to the level, in sixteenths of one
  int lod_first = 4096;  // distance of level 0, in 2^-16 of a normalised s; each further level doubles it

  // [project]
  ProjectUnit project = ProjectUnit::none;

  // [light]
  LightAt light = LightAt::none;
  LightSource light_source = LightSource::parallel;
  LightNormal light_normal = LightNormal::channel;
  LightShadow light_shadow = LightShadow::none;
  LightLaw light_law = LightLaw::lambert;
  LightFall light_fall = LightFall::none;
  LightFallTo light_fall_to = LightFallTo::light;
  int light_index_bits = 9;  // the table of the highlight has 2^this intervals
  RootUnit light_root;

  // [fog]
  FogMode fog = FogMode::table;
  int fog_depth_bits = 6;          // of the table's index: top bits of h, of d, or of log2 of s
  int fog_zone_bits = 4;           // of the zone of r; `table` has it in its index, too
  FogZone fog_zone = FogZone::r2;  // what the zones divide evenly

  // [formats]
  std::array<Format, format_count> formats = initial_formats();

  // [timing.STAGE], [memory]
  std::array<StageTiming, stage_count> timing{};
  MemoryTiming memory;

  // [rtl]
  RtlShape rtl;

  constexpr const Format& format(FormatId id) const { return formats[static_cast<std::size_t>(id)]; }
  constexpr Format& format(FormatId id) { return formats[static_cast<std::size_t>(id)]; }

  constexpr int fog_index_bits() const { return fog_depth_bits + fog_zone_bits; }

  // Snapped coordinates: signed, rounded half up, by contract.
  constexpr Format coordinate_format() const {
    return {coordinate_bits + subpixel_bits, coordinate_bits, true, Rounding::rnd, Overflow::sat, false};
  }
  // The stored depth code: unsigned integers.
  constexpr Format depth_format() const {
    return {depth_bits, depth_bits, false, depth_rounding, depth_overflow, false};
  }

  bool operator==(const Config&) const = default;
};

// Reads and checks a file. Throws InputError naming file, line, key and what is legal.
Config load_config(const std::string& path);
// The same from a text; `origin` stands for the file's name in messages.
Config parse_config(std::string_view toml, const std::string& origin);
// The canonical TOML text: parse_config(to_toml(c)) == c.
std::string to_toml(const Config& config);
// Rules that hold between keys (a product wider than the engines hold, a mode that needs another key).
// Called by load and parse; throws InputError with the key's name and what is legal.
void check_config(const Config& config, const std::string& origin);
// 16 hexadecimal digits over everything that determines results; the name is left out.
std::string config_hash(const Config& config);

}  // namespace bitspan
