// SPDX-License-Identifier: Apache-2.0
// Draw state: what silicon holds in registers and a driver changes between triangles, in one table. The
// configuration is the hardware and says what the registers hold at first; docs/formats.md describes the
// commands of a stream, docs/numeric-spec.md what each register does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "scene/view.hpp"

namespace bitspan {

// By number, of alpha and of stencil values: whether a value passes against another.
BITSPAN_ENUM(CompareFunc, never, less, equal, less_equal, greater, not_equal, greater_equal, always);
// The depth test stands before the texture, or behind the stage that may kill a fragment.
BITSPAN_ENUM(DepthWhen, early, late);
BITSPAN_ENUM(StencilOp, keep, zero, replace, increment, decrement, invert, increment_wrap, decrement_wrap);
BITSPAN_ENUM(BlendFactor, zero, one, src_color, one_minus_src_color, dst_color, one_minus_dst_color,
             src_alpha, one_minus_src_alpha, dst_alpha, one_minus_dst_alpha, constant_color,
             one_minus_constant_color, constant_alpha, one_minus_constant_alpha, src_alpha_saturate, half);
BITSPAN_ENUM(BlendOp, add, subtract, reverse_subtract, min, max);
// `none` leaves the colour to the blend. The others are in the order of their truth tables: bit 0 of the
// number less one is the result where both bits are 1, bit 1 where only the fragment's is, bit 2 where only
// the stored one is, bit 3 where neither is.
enum class LogicOp : std::uint8_t {
  none,
  clear,
  conjunction,
  and_reverse,
  copy,
  and_inverted,
  noop,
  exclusive_or,
  disjunction,
  nor,
  equiv,
  invert,
  or_reverse,
  copy_inverted,
  or_inverted,
  nand,
  set
};
// Three names are words of C++.
template <>
inline constexpr auto enum_names<LogicOp> = std::to_array<std::string_view>(
    {"none", "clear", "and", "and_reverse", "copy", "and_inverted", "noop", "xor", "or", "nor", "equiv",
     "invert", "or_reverse", "copy_inverted", "or_inverted", "nand", "set"});

// Which fragments a pass over translucent faces draws: all, those of alpha 1, or the others, of which each
// pixel holds the farthest one until a command resolves it.
BITSPAN_ENUM(TranslucencyPass, all, opaque, candidate);

// What alpha 0 does to a fragment.
BITSPAN_ENUM(AlphaZero, kill, keep);

// What the picture can hold: its channels from the high bit down, and their bits.
BITSPAN_ENUM(TargetFormat, rgba8888, rgb565, argb1555, argb4444, rgb332);
// How a channel with fewer than 8 bits takes a code. `sst1_4` and `sst1_2` are the tables of the 3dfx SST-1.
BITSPAN_ENUM(Dither, none, matrix4, matrix2, sst1_4, sst1_2);
// How a code becomes one of fewer bits where no dither does it.
BITSPAN_ENUM(TargetRound, down, nearest);
// Texels whose three colours lie in a range, or outside of it, are transparent.
BITSPAN_ENUM(ChromaTest, none, inside, outside);
// What the second texture unit takes as u and v: those of the triangle; s and t of the record `project`.
BITSPAN_ENUM(TextureCoordinates, uv, project);
// What a fragment outside of a projected texture takes: white, or the constant colour.
BITSPAN_ENUM(ProjectOutside, lit, dark);
// What weighs texels where a level of detail is at most 0: what else does, or a filter of its own.
BITSPAN_ENUM(MagnifyFilter, same, nearest, bilinear);
// How the second texture unit combines its texel with the colour and alpha of the first one.
BITSPAN_ENUM(TextureOp, replace, modulate, decal, blend, add, modulate_scaled, relief, shadow);

// Bits of red, green, blue and alpha; a format without alpha has 0 of them.
constexpr std::array<int, 4> target_bits(TargetFormat format) {
  switch (format) {
    case TargetFormat::rgba8888:
      return {8, 8, 8, 8};
    case TargetFormat::rgb565:
      return {5, 6, 5, 0};
    case TargetFormat::argb1555:
      return {5, 5, 5, 1};
    case TargetFormat::argb4444:
      return {4, 4, 4, 4};
    case TargetFormat::rgb332:
      return {3, 3, 2, 0};
  }
  return {};
}
// Whether the format has fewer than 8 bits in any channel.
constexpr bool is_narrow(TargetFormat format) { return target_bits(format) != std::array{8, 8, 8, 8}; }

// A register's end of the picture: no picture is larger.
inline constexpr int scissor_limit = 32768;
// The largest index that texture1 takes.
inline constexpr int texture1_limit = 65535;

// The lists read as tables.
// clang-format off

// X(A, type, member, key, low, high, first, meaning): A is the list's own argument; low..high are what an integer may be; `first` is what the register
// holds at the start of a scene, of a Config c.
#define BITSPAN_DRAW_STATE(X, A)                                                                                        \
  X(A, DepthFunc,    depth_func,      "depth.func",      0, 0, c.depth_func, "the depth comparison")                       \
  X(A, bool,         depth_write,     "depth.write",     0, 0, true,  "whether a fragment's code is stored")               \
  X(A, std::int32_t, depth_bias,      "depth.bias",      -(1 << 30), 1 << 30, 0, "codes added to a fragment's code, which then saturates") \
  X(A, DepthWhen,    depth_when,      "depth.when",      0, 0, DepthWhen::early, "depth and stencil test before the texture, or behind it") \
  X(A, std::int32_t, scissor_left,    "scissor.left",    0, scissor_limit, 0, "first column that is drawn")                \
  X(A, std::int32_t, scissor_top,     "scissor.top",     0, scissor_limit, 0, "first row that is drawn")                   \
  X(A, std::int32_t, scissor_right,   "scissor.right",   0, scissor_limit, scissor_limit, "first column right of what is drawn") \
  X(A, std::int32_t, scissor_bottom,  "scissor.bottom",  0, scissor_limit, scissor_limit, "first row below what is drawn") \
  X(A, std::int64_t, stipple,         "stipple",         0, 0xffffffff, 0xffffffff, "bit 8 (y mod 4) + (x mod 8) is 1 where a pixel is drawn") \
  X(A, CompareFunc,  alpha_func,      "alpha.func",      0, 0, CompareFunc::always, "the alpha test: a fragment's alpha against alpha.ref") \
  X(A, std::int32_t, alpha_ref,       "alpha.ref",       0, 255, 0, "alpha code that the alpha test compares with")        \
  X(A, AlphaZero,    alpha_zero,      "alpha.zero",      0, 0, AlphaZero::kill, "whether alpha 0 kills a fragment")     \
  X(A, TranslucencyPass, translucency_pass, "translucency.pass", 0, 0, TranslucencyPass::all, "all fragments are drawn; those of alpha 1; or the farthest one of the others is held") \
  X(A, bool,         stencil_test,    "stencil.test",    0, 0, false, "whether fragments are tested against the stencil plane") \
  X(A, std::int32_t, stencil_ref,     "stencil.ref",     0, 255, 0, "stencil value that the test compares with the plane's") \
  X(A, std::int32_t, stencil_mask,    "stencil.mask",    0, 255, 255, "bits of both values that are compared")             \
  X(A, std::int32_t, stencil_write,   "stencil.write",   0, 255, 255, "bits of the plane that are written")                \
  X(A, CompareFunc,  stencil_func,    "stencil.func",    0, 0, CompareFunc::always, "the stencil comparison")              \
  X(A, StencilOp,    stencil_fail,    "stencil.fail",    0, 0, StencilOp::keep, "where the stencil test fails")            \
  X(A, StencilOp,    stencil_zfail,   "stencil.zfail",   0, 0, StencilOp::keep, "where it passes and the depth test fails") \
  X(A, StencilOp,    stencil_pass,    "stencil.pass",    0, 0, StencilOp::keep, "where both pass")                         \
  X(A, bool,         stencil_two_sided, "stencil.two_sided", 0, 0, false, "whether back faces have the next seven of their own") \
  X(A, CompareFunc,  stencil_back_func, "stencil.back.func", 0, 0, CompareFunc::always, "the comparison of back faces")    \
  X(A, StencilOp,    stencil_back_fail, "stencil.back.fail", 0, 0, StencilOp::keep, "as stencil.fail, of back faces")      \
  X(A, StencilOp,    stencil_back_zfail, "stencil.back.zfail", 0, 0, StencilOp::keep, "as stencil.zfail, of back faces")   \
  X(A, StencilOp,    stencil_back_pass, "stencil.back.pass", 0, 0, StencilOp::keep, "as stencil.pass, of back faces")      \
  X(A, std::int32_t, stencil_back_ref, "stencil.back.ref", -1, 255, -1, "as stencil.ref, of back faces; -1: they take stencil.ref") \
  X(A, std::int32_t, stencil_back_mask, "stencil.back.mask", -1, 255, -1, "as stencil.mask, of back faces; -1: they take stencil.mask") \
  X(A, std::int32_t, stencil_back_write, "stencil.back.write", -1, 255, -1, "as stencil.write, of back faces; -1: they take stencil.write") \
  X(A, bool,         color_write,     "color.write",     0, 0, true,  "whether a fragment's colour is stored")             \
  X(A, std::int32_t, color_mask,      "color.mask",      0, 15, 15, "which channels are stored: 1 red, 2 green, 4 blue, 8 alpha") \
  X(A, BlendFactor,  blend_src,       "blend.src",       0, 0, BlendFactor::src_alpha, "factor of the fragment's colour")  \
  X(A, BlendFactor,  blend_dst,       "blend.dst",       0, 0, BlendFactor::one_minus_src_alpha, "factor of the stored colour") \
  X(A, BlendOp,      blend_op,        "blend.op",        0, 0, BlendOp::add, "what is made of the two products")           \
  X(A, BlendFactor,  blend_alpha_src, "blend.alpha.src", 0, 0, BlendFactor::zero, "factor of the fragment's alpha code")   \
  X(A, BlendFactor,  blend_alpha_dst, "blend.alpha.dst", 0, 0, BlendFactor::one, "factor of the stored alpha code")        \
  X(A, BlendOp,      blend_alpha_op,  "blend.alpha.op",  0, 0, BlendOp::add, "as blend.op, of the alpha codes")            \
  X(A, std::int32_t, blend_red,       "blend.red",       0, 255, 0, "red of the constant colour")                          \
  X(A, std::int32_t, blend_green,     "blend.green",     0, 255, 0, "green of the constant colour")                        \
  X(A, std::int32_t, blend_blue,      "blend.blue",      0, 255, 0, "blue of the constant colour")                         \
  X(A, std::int32_t, blend_alpha,     "blend.alpha",     0, 255, 0, "alpha of the constant colour")                        \
  X(A, LogicOp,      logic_op,        "logic.op",        0, 0, LogicOp::none, "in place of the blend: bit by bit, on the codes") \
  X(A, TargetFormat, target_format,   "target.format",   0, 0, TargetFormat::rgba8888, "what the picture holds of a colour and its alpha") \
  X(A, Dither,       target_dither,   "target.dither",   0, 0, Dither::none, "how colours are narrowed to a format with fewer bits") \
  X(A, TargetRound,  target_round,    "target.round",    0, 0, TargetRound::down, "how codes are narrowed without dither")        \
  X(A, ChromaTest,   chroma_test,     "chroma.test",     0, 0, ChromaTest::none, "whether texels inside or outside of the range are transparent") \
  X(A, std::int32_t, chroma_low_red,  "chroma.low.red",  0, 255, 0, "smallest red of the range")                           \
  X(A, std::int32_t, chroma_low_green, "chroma.low.green", 0, 255, 0, "smallest green of the range")                       \
  X(A, std::int32_t, chroma_low_blue, "chroma.low.blue", 0, 255, 0, "smallest blue of the range")                          \
  X(A, std::int32_t, chroma_high_red, "chroma.high.red", 0, 255, 255, "largest red of the range")                          \
  X(A, std::int32_t, chroma_high_green, "chroma.high.green", 0, 255, 255, "largest green of the range")                    \
  X(A, std::int32_t, chroma_high_blue, "chroma.high.blue", 0, 255, 255, "largest blue of the range")                       \
  X(A, TextureFilter, texture_filter, "texture.filter",  0, 0, c.filter, "how a triangle's texels are weighed")              \
  X(A, TextureWrap,  texture_wrap_u,  "texture.wrap.u",  0, 0, c.wrap, "how the columns of its texture go on outside of it") \
  X(A, TextureWrap,  texture_wrap_v,  "texture.wrap.v",  0, 0, c.wrap, "how its rows do")                                  \
  X(A, std::int32_t, texture_lod_bias, "texture.lod.bias", -31, 32, c.lod_bias, "added to the level, in sixteenths") \
  X(A, std::int32_t, texture_level_least, "texture.level.least", 0, max_mip_level, 0, "least level of detail") \
  X(A, std::int32_t, texture_level_greatest, "texture.level.greatest", 0, max_mip_level, max_mip_level, "greatest level of detail, where the least one is not above it") \
  X(A, MagnifyFilter, texture_magnify, "texture.magnify", 0, 0, MagnifyFilter::same, "how texels are weighed where the level of detail is at most 0") \
  X(A, std::int32_t, texture1,        "texture1",        -1, texture1_limit, -1, "index of the scene's texture that the second texture unit fetches; -1: the unit is off") \
  X(A, TextureOp,    texture1_op,     "texture1.op",     0, 0, TextureOp::modulate, "how that unit combines its texel with the first one's colour") \
  X(A, std::int32_t, texture1_scale,  "texture1.scale",  0, 2, 0, "modulate_scaled multiplies by 2 to this power")         \
  X(A, std::int32_t, texture1_red,    "texture1.red",    0, 255, 0, "red of the constant colour of blend")                 \
  X(A, std::int32_t, texture1_green,  "texture1.green",  0, 255, 0, "green of the constant colour of blend")               \
  X(A, std::int32_t, texture1_blue,   "texture1.blue",   0, 255, 0, "blue of the constant colour of blend")               \
  X(A, TextureFilter, texture1_filter, "texture1.filter", 0, 0, c.filter, "as texture.filter, of the second texture unit")  \
  X(A, TextureWrap,  texture1_wrap_u, "texture1.wrap.u", 0, 0, c.wrap, "as texture.wrap.u, of the second texture unit")    \
  X(A, TextureWrap,  texture1_wrap_v, "texture1.wrap.v", 0, 0, c.wrap, "as texture.wrap.v, of the second texture unit")    \
  X(A, TextureCoordinates, texture1_coordinates, "texture1.coordinates", 0, 0, TextureCoordinates::uv, "what the unit takes as u and v: the triangle's, or the projector's") \
  X(A, ProjectOutside, texture1_outside, "texture1.outside", 0, 0, ProjectOutside::lit, "project: white outside of the texture, or the constant colour") \
  X(A, bool,         texture1_compare, "texture1.compare", 0, 0, false, "project, format depth: a texel is white where texture1.func holds, else the constant colour") \
  X(A, DepthFunc,    texture1_func,   "texture1.func",   0, 0, DepthFunc::lequal, "comparison of the fragment's code with the texel's, by distance from the projector") \
  X(A, std::int32_t, texture1_bias,   "texture1.bias",   -(1 << 30), 1 << 30, 0, "codes added to the fragment's code in front of texture1.func, which then saturates") \
  X(A, std::int32_t, texture1_lod_bias, "texture1.lod.bias", -31, 32, c.lod_bias, "as texture.lod.bias, of the second texture unit") \
  X(A, std::int32_t, texture1_level_least, "texture1.level.least", 0, max_mip_level, 0, "as texture.level.least, of the second texture unit") \
  X(A, std::int32_t, texture1_level_greatest, "texture1.level.greatest", 0, max_mip_level, max_mip_level, "as texture.level.greatest, of the second texture unit") \
  X(A, MagnifyFilter, texture1_magnify, "texture1.magnify", 0, 0, MagnifyFilter::same, "as texture.magnify, of the second texture unit")

// clang-format on

struct DrawState {
#define BITSPAN_STATE_MEMBER(A, type, member, key, low, high, first, meaning) type member{};
  BITSPAN_DRAW_STATE(BITSPAN_STATE_MEMBER, )
#undef BITSPAN_STATE_MEMBER
  bool operator==(const DrawState&) const = default;
};

// Whether scissor or stipple may keep a pixel from being drawn.
bool masks_pixels(const DrawState& state);
constexpr bool holds_candidates(TranslucencyPass pass) { return pass == TranslucencyPass::candidate; }
constexpr bool is_late(DepthWhen when) { return when == DepthWhen::late; }

// Whether the second texture unit is on.
constexpr bool has_second_texture(const DrawState& state) { return state.texture1 >= 0; }
// The second unit's texel is a normal for light.
constexpr bool has_relief(const DrawState& state) {
  return has_second_texture(state) && state.texture1_op == TextureOp::relief;
}

// Whether that unit takes the projector's coordinates.
constexpr bool takes_projection(TextureCoordinates by) { return by == TextureCoordinates::project; }
// The second unit's texel is what a shadow leaves of the light.
constexpr bool shades_light(const DrawState& state) {
  return has_second_texture(state) && state.texture1_op == TextureOp::shadow;
}
constexpr bool is_projected(const DrawState& state) {
  return has_second_texture(state) && takes_projection(state.texture1_coordinates);
}

// How a texture unit finds texels.
struct TexelLookup {
  TextureFilter filter = TextureFilter::nearest;
  TextureWrap wrap_u = TextureWrap::cyclic, wrap_v = TextureWrap::cyclic;
  bool operator==(const TexelLookup&) const = default;
};
constexpr TexelLookup lookup_of(const Config& config) { return {config.filter, config.wrap, config.wrap}; }
constexpr TexelLookup first_lookup(const DrawState& s) {
  return {s.texture_filter, s.texture_wrap_u, s.texture_wrap_v};
}
constexpr TexelLookup second_lookup(const DrawState& s) {
  return {s.texture1_filter, s.texture1_wrap_u, s.texture1_wrap_v};
}

// The same where the level of detail is at most 0.
constexpr TexelLookup magnified(TexelLookup lookup, MagnifyFilter magnify) {
  switch (magnify) {
    case MagnifyFilter::same:
      break;
    case MagnifyFilter::nearest:
      lookup.filter = TextureFilter::nearest;
      break;
    case MagnifyFilter::bilinear:
      lookup.filter = TextureFilter::bilinear;
      break;
  }
  return lookup;
}
constexpr TexelLookup first_magnified(const DrawState& s) {
  return magnified(first_lookup(s), s.texture_magnify);
}
constexpr TexelLookup second_magnified(const DrawState& s) {
  return magnified(second_lookup(s), s.texture1_magnify);
}

// Which levels a texture unit may take of a chain; `least` counts where it is above `greatest`.
struct LevelRange {
  int least = 0, greatest = max_mip_level;
  bool operator==(const LevelRange&) const = default;
};
constexpr LevelRange first_levels(const DrawState& s) {
  return {s.texture_level_least, s.texture_level_greatest};
}
constexpr LevelRange second_levels(const DrawState& s) {
  return {s.texture1_level_least, s.texture1_level_greatest};
}

// What the registers hold at the start of a scene.
DrawState first_state(const Config& config);

// One register of the table. names: of an enumeration; two of them, "false" and "true", of a truth; none of
// an integer.
struct StateRegister {
  std::string_view key;
  std::span<const std::string_view> names;
  bool is_truth = false;
  std::int64_t low = 0, high = 0;  // what it may hold, as an integer
  std::string_view meaning;
};
// In the order of the table.
std::span<const StateRegister> state_registers();
// Index of the register; none where there is no such key.
std::optional<std::size_t> find_state_register(std::string_view key);
// The registers' values as integers, in the order of the table.
std::vector<std::int64_t> state_values(const DrawState& state);

struct StateSetting {
  std::size_t index = 0;   // of state_registers()
  std::int64_t value = 0;  // within the register's limits
  bool operator==(const StateSetting&) const = default;
};
// Registers that take new values, in order; all others stay. reset: all of them hold their first values
// before.
struct StateChange {
  bool reset = false;
  std::vector<StateSetting> settings;
  bool operator==(const StateChange&) const = default;
};
// Whether the formats of a legal configuration are narrow enough for a filter that is not its own.
bool takes_filter(const Config& config, TextureFilter filter);
// Throws InputError, whose text begins with the key, where the new state is not legal.
DrawState changed_state(DrawState state, const StateChange& change, const Config& config);
// The same; throws, too, where the new state names a texture that a scene with so many textures does not
// have.
DrawState changed_state(const DrawState& state, const StateChange& change, const Config& config,
                        std::size_t textures);

// Planes that are cleared; the others stay.
struct Clear {
  std::optional<std::array<std::uint8_t, 3>> color;
  std::optional<std::uint8_t> alpha;
  bool depth = false;  // to the farthest code
  std::optional<std::uint8_t> stencil;
  bool masked = false;  // only what the scissor and the write masks let through
  bool operator==(const Clear&) const = default;
};

// A stream draws on one of this many targets at a time: pictures, each with its depth buffer, its stencil
// plane and its view. It is cleared as at the beginning of the scene when it is first drawn on.
inline constexpr int target_limit = 8;
// Throws InputError where there is no target k.
void check_target(int k);

// What is drawn on from here on; target 0 at first.
struct Target {
  int k = 0;  // below target_limit
  bool operator==(const Target&) const = default;
};

// Makes a plane of a target the texels of a texture of its size: colour and alpha of the format rgba8888, or
// depth codes of the format depth. What is drawn on the target later leaves the texture as it is.
BITSPAN_ENUM(CopyPlane, color, depth);
struct Copy {
  int target = 0;  // one that has been drawn on
  CopyPlane plane = CopyPlane::color;
  int texture = 0;  // index into Scene::textures
  bool operator==(const Copy&) const = default;
};

// Merges the candidates that the target's pixels hold, row by row, and holds none behind it.
struct Resolve {
  bool operator==(const Resolve&) const = default;
};

// What stands between triangles of a stream.
struct DrawCommand {
  std::size_t before = 0;  // index of the triangle that follows; their number where none does
  std::variant<StateChange, Clear, Target, ViewChange, Copy, Resolve> what{};
  bool operator==(const DrawCommand&) const = default;
};
// The states that the changes among the commands make, one after another; the first state is not among them.
std::vector<DrawState> states_of(const Config& config, std::span<const DrawCommand> commands);
// The first state, and after it states_of(). The last one is in force behind the commands.
std::vector<DrawState> all_states_of(const Config& config, std::span<const DrawCommand> commands);
// The targets that a scene with these commands draws on or shows, ascending, 0 among them.
std::vector<int> targets_of(std::span<const DrawCommand> commands);
// The views of a scene's targets while its commands are gone through: a target that is drawn on for the first
// time takes the view in force.
class Views {
 public:
  explicit Views(const View& first = {}) { of_[0] = first; }
  // Of the target that is drawn on.
  const View& now() const { return *of_[static_cast<std::size_t>(target_)]; }
  int target() const { return target_; }
  // None of a target that has not been drawn on.
  const std::optional<View>& of(int k) const { return of_[static_cast<std::size_t>(k)]; }
  // Throw InputError where there is no target k, and where the new view is not legal.
  void select(int k);
  void change(const ViewChange& change);
  // One of both, where the command is one of them.
  void execute(const DrawCommand& command);

 private:
  int target_ = 0;
  std::array<std::optional<View>, target_limit> of_;
};
// Whether a command may make the view in force another one.
bool may_change_view(const DrawCommand& command);
// Whether a command makes something of the scene another one that no draw state holds.
bool changes_scene(std::span<const DrawCommand> commands);

// The target of triangle `index`; that of the number of triangles is what the scene shows.
int target_at(std::span<const DrawCommand> commands, std::size_t index);

}  // namespace bitspan
