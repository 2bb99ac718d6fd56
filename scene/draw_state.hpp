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
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// By number, of alpha and of stencil values: whether a value passes against another.
BITSPAN_ENUM(CompareFunc, never, less, equal, less_equal, greater, not_equal, greater_equal, always);
// The depth test stands before the texture, or behind the stage that may kill a fragment.
BITSPAN_ENUM(DepthWhen, early, late);
BITSPAN_ENUM(StencilOp, keep, zero, replace, increment, decrement, invert, increment_wrap, decrement_wrap);
BITSPAN_ENUM(BlendFactor, zero, one, src_color, one_minus_src_color, dst_color, one_minus_dst_color,
             src_alpha, one_minus_src_alpha, dst_alpha, one_minus_dst_alpha, constant_color,
             one_minus_constant_color, constant_alpha, one_minus_constant_alpha, src_alpha_saturate);
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

// A register's end of the picture: no picture is larger.
inline constexpr int scissor_limit = 32768;

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
  X(A, bool,         stencil_test,    "stencil.test",    0, 0, false, "whether fragments are tested against the stencil plane") \
  X(A, std::int32_t, stencil_ref,     "stencil.ref",     0, 255, 0, "stencil value that the test compares with the plane's") \
  X(A, std::int32_t, stencil_mask,    "stencil.mask",    0, 255, 255, "bits of both values that are compared")             \
  X(A, std::int32_t, stencil_write,   "stencil.write",   0, 255, 255, "bits of the plane that are written")                \
  X(A, CompareFunc,  stencil_func,    "stencil.func",    0, 0, CompareFunc::always, "the stencil comparison")              \
  X(A, StencilOp,    stencil_fail,    "stencil.fail",    0, 0, StencilOp::keep, "where the stencil test fails")            \
  X(A, StencilOp,    stencil_zfail,   "stencil.zfail",   0, 0, StencilOp::keep, "where it passes and the depth test fails") \
  X(A, StencilOp,    stencil_pass,    "stencil.pass",    0, 0, StencilOp::keep, "where both pass")                         \
  X(A, bool,         stencil_two_sided, "stencil.two_sided", 0, 0, false, "whether back faces have the next four of their own") \
  X(A, CompareFunc,  stencil_back_func, "stencil.back.func", 0, 0, CompareFunc::always, "the comparison of back faces")    \
  X(A, StencilOp,    stencil_back_fail, "stencil.back.fail", 0, 0, StencilOp::keep, "as stencil.fail, of back faces")      \
  X(A, StencilOp,    stencil_back_zfail, "stencil.back.zfail", 0, 0, StencilOp::keep, "as stencil.zfail, of back faces")   \
  X(A, StencilOp,    stencil_back_pass, "stencil.back.pass", 0, 0, StencilOp::keep, "as stencil.pass, of back faces")      \
  X(A, bool,         color_write,     "color.write",     0, 0, true,  "whether a fragment's colour is stored")             \
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
  X(A, LogicOp,      logic_op,        "logic.op",        0, 0, LogicOp::none, "in place of the blend: bit by bit, on the codes")

// clang-format on

struct DrawState {
#define BITSPAN_STATE_MEMBER(A, type, member, key, low, high, first, meaning) type member{};
  BITSPAN_DRAW_STATE(BITSPAN_STATE_MEMBER, )
#undef BITSPAN_STATE_MEMBER
  bool operator==(const DrawState&) const = default;
};

// Whether scissor or stipple may keep a pixel from being drawn.
bool masks_pixels(const DrawState& state);
constexpr bool is_late(DepthWhen when) { return when == DepthWhen::late; }

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
// Throws InputError, whose text begins with the key, where the new state is not legal: see refuse_state.
DrawState changed_state(DrawState state, const StateChange& change, const Config& config);

// Planes that are cleared; the others stay.
struct Clear {
  std::optional<std::array<std::uint8_t, 3>> color;
  std::optional<std::uint8_t> alpha;
  bool depth = false;  // to the farthest code
  std::optional<std::uint8_t> stencil;
  bool operator==(const Clear&) const = default;
};

// What stands between triangles of a stream: a change of state, or a clear.
struct DrawCommand {
  std::size_t before = 0;  // index of the triangle that follows; their number where none does
  StateChange state;
  std::optional<Clear> clear;  // in place of `state`
  bool operator==(const DrawCommand&) const = default;
};

}  // namespace bitspan
