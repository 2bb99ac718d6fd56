// SPDX-License-Identifier: Apache-2.0
#include "model/stages/merge.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "model/stages/merge-inl.hpp"
#include "model/stages/texel.hpp"
#include "model/stages/texture.hpp"

namespace bitspan::model {
namespace {

constexpr int code_bits = 8;
constexpr std::size_t alpha_channel = 3;

// A factor or a colour on its own grid.
struct Fixed {
  int128 raw = 0;
  int fraction = 0;
};
constexpr Fixed one{1, 0};

int128 on_grid(const Fixed& x, int fraction) { return x.raw << (fraction - x.fraction); }
Fixed one_minus(const Fixed& x) { return {(int128{1} << x.fraction) - x.raw, x.fraction}; }
Fixed times(const Fixed& a, const Fixed& b) { return {a.raw * b.raw, a.fraction + b.fraction}; }
// c(n): a code 0..255 as 0..1.
Fixed share_of_code(std::int64_t code) { return {code + (code >> 7), code_bits}; }

// The operands of one channel.
struct Operands {
  Fixed src, dst, a;
  std::int64_t src_code = 0, dst_code = 0, dst_alpha = 0, constant = 0, constant_alpha = 0;
  bool is_alpha = false;
};

Fixed factor_of(BlendFactor factor, const Operands& o) {
  switch (factor) {
    case BlendFactor::zero:
      return {0, 0};
    case BlendFactor::one:
      return one;
    case BlendFactor::src_color:
      return o.is_alpha ? o.a : share_of_code(o.src_code);
    case BlendFactor::one_minus_src_color:
      return one_minus(factor_of(BlendFactor::src_color, o));
    case BlendFactor::dst_color:
      return share_of_code(o.dst_code);
    case BlendFactor::one_minus_dst_color:
      return one_minus(share_of_code(o.dst_code));
    case BlendFactor::src_alpha:
      return o.a;
    case BlendFactor::one_minus_src_alpha:
      return one_minus(o.a);
    case BlendFactor::dst_alpha:
      return share_of_code(o.dst_alpha);
    case BlendFactor::one_minus_dst_alpha:
      return one_minus(share_of_code(o.dst_alpha));
    case BlendFactor::constant_color:
      return share_of_code(o.constant);
    case BlendFactor::one_minus_constant_color:
      return one_minus(share_of_code(o.constant));
    case BlendFactor::constant_alpha:
      return share_of_code(o.constant_alpha);
    case BlendFactor::one_minus_constant_alpha:
      return one_minus(share_of_code(o.constant_alpha));
    case BlendFactor::src_alpha_saturate: {
      if (o.is_alpha) return one;
      const Fixed free = one_minus(share_of_code(o.dst_alpha));
      const int grid = std::max(o.a.fraction, free.fraction);
      return {std::min(on_grid(o.a, grid), on_grid(free, grid)), grid};
    }
  }
  unreachable();
}

Fixed combined(const BlendEquation& equation, const Operands& o) {
  const bool scales = equation.op != BlendOp::min && equation.op != BlendOp::max;
  const Fixed p = scales ? times(o.src, factor_of(equation.src, o)) : o.src;
  const Fixed r = scales ? times(o.dst, factor_of(equation.dst, o)) : o.dst;
  const int grid = std::max(p.fraction, r.fraction);
  const int128 own = on_grid(p, grid);
  const int128 stored = on_grid(r, grid);
  switch (equation.op) {
    case BlendOp::add:
      return {own + stored, grid};
    case BlendOp::subtract:
      return {own - stored, grid};
    case BlendOp::reverse_subtract:
      return {stored - own, grid};
    case BlendOp::min:
      return {std::min(own, stored), grid};
    case BlendOp::max:
      return {std::max(own, stored), grid};
  }
  unreachable();
}

// By the truth table that the operation's number is.
std::int64_t logic(LogicOp op, std::int64_t src, std::int64_t dst) {
  const auto table = static_cast<unsigned>(op) - 1U;
  std::int64_t out = 0;
  if ((table & 1U) != 0) out |= src & dst;
  if ((table & 2U) != 0) out |= src & ~dst;
  if ((table & 4U) != 0) out |= ~src & dst;
  if ((table & 8U) != 0) out |= ~src & ~dst;
  return out & 255;
}

// What an equation makes with factors that may be the stored colour.
bool reads_stored(const BlendEquation& equation) {
  const auto is_stored = [](BlendFactor f) {
    return f == BlendFactor::dst_color || f == BlendFactor::one_minus_dst_color ||
           f == BlendFactor::dst_alpha || f == BlendFactor::one_minus_dst_alpha ||
           f == BlendFactor::src_alpha_saturate;
  };
  const bool scales = equation.op != BlendOp::min && equation.op != BlendOp::max;
  return !scales || equation.dst != BlendFactor::zero || is_stored(equation.src);
}

// The matrix in sixteenths of a step, from the bits of the place: 8 (x0 xor y0) + 4 y0 + 2 (x1 xor y1) + y1.
int matrix4(int x, int y) {
  const int low = (x ^ y) & 1;
  const int high = (x ^ y) >> 1 & 1;
  return low << 3 | (y & 1) << 2 | high << 1 | (y >> 1 & 1);
}
// The same with the two high bits alone.
int matrix2(int x, int y) { return matrix4(x & 1, y & 1); }

// A code 0..255 as one of `bits` bits.
int narrowed(Dither dither, int bits, int code, int x, int y) {
  const auto by_matrix = [&](int d) { return std::min(((code << bits) + (d << 4)) >> 8, (1 << bits) - 1); };
  // 255 parts in place of 256, by which the code of white is all ones without saturation.
  const auto by_table = [&](int d) {
    return ((code << bits) + ((d - (code >> 4) + (code >> (12 - bits))) << 4)) >> 8;
  };
  switch (dither) {
    case Dither::none:
      return code >> (code_bits - bits);
    case Dither::matrix4:
      return by_matrix(matrix4(x, y));
    case Dither::matrix2:
      return by_matrix(matrix2(x, y));
    case Dither::sst1_4:
      return by_table(matrix4(x, y));
    case Dither::sst1_2:
      return by_table(matrix2(x, y) | 2);
  }
  unreachable();
}

// What the target's channel holds in place of a code.
std::int64_t held(const Blend& blend, std::size_t channel, std::int64_t code, std::int64_t x,
                  std::int64_t y) {
  const int bits = target_bits(blend.target)[channel];
  if (bits == 0) return 255;
  const Dither dither = channel == alpha_channel ? Dither::none : blend.dither;
  return repeated(
      narrowed(dither, bits, static_cast<int>(code), static_cast<int>(x & 3), static_cast<int>(y & 3)), bits);
}

// A fragment's alpha, at most 1.
Fixed alpha_of(const MergeStage& stage, std::int64_t raw) {
  // A grid that has 1.
  const int grid = std::max(stage.alpha.fraction, 0);
  const int128 a = int128{raw} << (grid - stage.alpha.fraction);
  return {std::min(a, int128{1} << grid), grid};
}

}  // namespace

Blend blend_of(const DrawState& s) {
  return {{s.blend_src, s.blend_dst, s.blend_op},
          {s.blend_alpha_src, s.blend_alpha_dst, s.blend_alpha_op},
          {s.blend_red, s.blend_green, s.blend_blue, s.blend_alpha},
          s.logic_op,
          s.target_format,
          s.target_dither};
}

void set_blend(MergeStage& stage, const Blend& blend) {
  const Blend first;
  stage.blend = blend;
  const bool keeps_alpha = blend.logic == LogicOp::none && blend.alpha == first.alpha;
  stage.is_plain = keeps_alpha && blend.color == first.color;
  stage.is_narrow = is_narrow(blend.target);
  stage.changes_alpha = !keeps_alpha || stage.is_narrow;
}

bool reads_stored_color(const MergeStage& stage, std::int64_t a) {
  // The alpha of a narrow target shares the colour's word.
  const bool has_alpha = target_bits(stage.blend.target)[alpha_channel] > 0;
  if (stage.is_plain) return a < HWY_NAMESPACE::opaque_alpha(stage) || (stage.is_narrow && has_alpha);
  switch (stage.blend.logic) {
    case LogicOp::clear:
    case LogicOp::copy:
    case LogicOp::copy_inverted:
    case LogicOp::set:
      return false;
    case LogicOp::none:
      return reads_stored(stage.blend.color) ||
             (stage.changes_alpha && has_alpha && reads_stored(stage.blend.alpha));
    default:
      return true;
  }
}

MergeAlphaRecord merged_alpha(const MergeStage& stage, const TextureRecord& texture, std::uint8_t stored) {
  const Blend& blend = stage.blend;
  Operands o;
  o.a = alpha_of(stage, texture.a);
  o.is_alpha = true;
  o.src_code = alpha_code(stage.alpha, texture.a);
  o.dst_code = o.dst_alpha = stored;
  o.constant = o.constant_alpha = blend.constant[3];
  o.src = {o.src_code, 0};
  o.dst = {stored, 0};
  MergeAlphaRecord out{texture.triangle, texture.x, texture.y, 0};
  if (blend.logic != LogicOp::none) {
    out.a = logic(blend.logic, o.src_code, stored);
  } else {
    const Fixed value = combined(blend.alpha, o);
    out.a = quantize(value.raw, value.fraction, stage.color, NoObserve{});
  }
  if (stage.is_narrow) out.a = held(blend, alpha_channel, out.a, out.x, out.y);
  return out;
}

Clear held(const MergeStage& stage, Clear clear) {
  if (!stage.is_narrow) return clear;
  Blend plain = stage.blend;
  plain.dither = Dither::none;
  const auto hold = [&](std::size_t channel, std::uint8_t& code) {
    code = static_cast<std::uint8_t>(held(plain, channel, code, 0, 0));
  };
  if (clear.color) {
    for (std::size_t c = 0; c < clear.color->size(); ++c) hold(c, (*clear.color)[c]);
  }
  if (clear.alpha) hold(alpha_channel, *clear.alpha);
  return clear;
}

namespace {

// A channel of a fragment by any blend.
template <class Watch>
std::int64_t mixed(const MergeStage& stage, std::int64_t own, const std::array<std::uint8_t, 4>& stored,
                   std::size_t channel, std::int64_t a, Watch watch) {
  const Blend& blend = stage.blend;
  if (blend.logic != LogicOp::none) {
    return logic(blend.logic, HWY_NAMESPACE::replaced(stage, own, watch), stored[channel]);
  }
  Operands o;
  const int grid = std::max(stage.color_in.fraction, 0);
  o.src = {int128{own} << (grid - stage.color_in.fraction), grid};
  o.dst = {stored[channel], 0};
  o.a = alpha_of(stage, a);
  // To the nearest code, halves up.
  o.src_code = static_cast<std::int64_t>(
      std::clamp<int128>(((o.src.raw << 1) + (int128{1} << grid)) >> (grid + 1), 0, 255));
  o.dst_code = stored[channel];
  o.dst_alpha = stored[3];
  o.constant = blend.constant[channel];
  o.constant_alpha = blend.constant[3];
  const Fixed value = combined(blend.color, o);
  return quantize(value.raw, value.fraction, stage.color, watch);
}

}  // namespace

template <class Watch>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 4>& stored, MergeRecord& out, Watch watch) {
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.z = depth.z;
  namespace text = HWY_NAMESPACE;
  std::array own{fog.r, fog.g, fog.b};
  const bool opaque = texture.a >= text::opaque_alpha(stage);
  for (std::size_t c = 0; c < own.size(); ++c) {
    if (!stage.is_plain) {
      own[c] = mixed(stage, own[c], stored, c, texture.a, watch);
    } else if (opaque) {
      own[c] = text::replaced(stage, own[c], watch);
    } else if (stage.fits_int64) {
      own[c] = text::blended<std::int64_t>(stage, own[c], stored[c], texture.a, watch);
    } else {
      own[c] = text::blended<int128>(stage, own[c], stored[c], texture.a, watch);
    }
    if (stage.is_narrow) own[c] = held(stage.blend, c, own[c], out.x, out.y);
  }
  out.r = own[0];
  out.g = own[1];
  out.b = own[2];
}

template void merge(const MergeStage&, const DepthRecord&, const TextureRecord&, const FogRecord&,
                    const std::array<std::uint8_t, 4>&, MergeRecord&, NoObserve);
template void merge(const MergeStage&, const DepthRecord&, const TextureRecord&, const FogRecord&,
                    const std::array<std::uint8_t, 4>&, MergeRecord&, Observe);

}  // namespace bitspan::model
