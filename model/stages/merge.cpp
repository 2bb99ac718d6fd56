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
int narrowed(Dither dither, TargetRound round, int bits, int code, int x, int y) {
  const auto by_matrix = [&](int d) { return std::min(((code << bits) + (d << 4)) >> 8, (1 << bits) - 1); };
  // 255 parts in place of 256, by which the code of white is all ones without saturation.
  const auto by_table = [&](int d) {
    return ((code << bits) + ((d - (code >> 4) + (code >> (12 - bits))) << 4)) >> 8;
  };
  switch (dither) {
    case Dither::none:
      if (round == TargetRound::nearest) return (2 * code * ((1 << bits) - 1) + 255) / 510;
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
  return repeated(narrowed(dither, blend.round, bits, static_cast<int>(code), static_cast<int>(x & 3),
                           static_cast<int>(y & 3)),
                  bits);
}

}  // namespace

Blend blend_of(const DrawState& s) {
  return {{s.blend_src, s.blend_dst, s.blend_op},
          {s.blend_alpha_src, s.blend_alpha_dst, s.blend_alpha_op},
          {s.blend_red, s.blend_green, s.blend_blue, s.blend_alpha},
          s.logic_op,
          s.target_format,
          s.target_dither,
          s.target_round};
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
  MergeAlphaRecord out{texture.triangle, texture.x, texture.y, 0};
  out.a = HWY_NAMESPACE::mixed_alpha<int128>(stage, stored, texture.a, NoObserve{});
  if (stage.is_narrow) out.a = held(stage.blend, alpha_channel, out.a, out.x, out.y);
  return out;
}

std::array<std::uint8_t, 4> held(const MergeStage& stage, std::array<std::uint8_t, 4> codes, std::int64_t x,
                                 std::int64_t y) {
  if (!stage.is_narrow) return codes;
  for (std::size_t c = 0; c < codes.size(); ++c) {
    codes[c] = static_cast<std::uint8_t>(held(stage.blend, c, codes[c], x, y));
  }
  return codes;
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
      own[c] = text::mixed<int128>(stage, own[c], {stored[c], stored[alpha_channel]}, c, texture.a, watch);
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
