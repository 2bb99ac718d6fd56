// SPDX-License-Identifier: Apache-2.0
// merge: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "merge".
#include "model/numeric/quantize-inl.hpp"
#include "model/numeric/scaled-inl.hpp"
#include "model/stages/merge.hpp"
#include "model/stages/texture-inl.hpp"

#if defined(BITSPAN_MODEL_STAGES_MERGE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_MERGE_INL
#undef BITSPAN_MODEL_STAGES_MERGE_INL
#else
#define BITSPAN_MODEL_STAGES_MERGE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// 1 on texture.alpha, which can hold it.
HWY_INLINE std::int64_t opaque_alpha(const MergeStage& stage) {
  return std::int64_t{1} << stage.alpha.fraction;
}

// A fragment whose alpha is 1 or more.
template <class V, class Watch>
HWY_INLINE V replaced(const MergeStage& stage, V own, Watch watch) {
  return quantize(own, stage.color_in.fraction, stage.color, watch);
}

// Any fragment; stored: the pixel's code. Alpha above 1 counts as 1, and gives the same as replaced().
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> blended(const MergeStage& stage, ValueOf<Int> own, ValueOf<Int> stored,
                                ValueOf<Int> alpha, Watch watch) {
  using V = ValueOf<Int>;
  const int grid = stage.color_in.fraction > 0 ? stage.color_in.fraction : 0;
  const int a_grid = stage.alpha.fraction;
  const Int dst = Int(stored) << grid;
  const Int difference = (Int(own) << (grid - stage.color_in.fraction)) - dst;
  const Int share(min(alpha, V(1) << a_grid));
  return quantize((dst << a_grid) + difference * share, grid + a_grid, stage.color, watch);
}

// ---------------------------------------------------------------- any blend

// c(n): a code 0..255 as 0..1.
template <class Int>
HWY_INLINE Scaled<Int> share_of_code(ValueOf<Int> code) {
  return {Int(code + (code >> 7)), 8};
}

// The operands of one channel.
template <class Int>
struct Operands {
  using V = ValueOf<Int>;
  Scaled<Int> src, dst, a;
  V src_code, dst_code, dst_alpha;
  std::int64_t constant = 0, constant_alpha = 0;
  bool is_alpha = false;
};

template <class Int>
HWY_INLINE Scaled<Int> factor_of(BlendFactor factor, const Operands<Int>& o) {
  using V = ValueOf<Int>;
  const auto constant = [](std::int64_t code)
                            HWY_ATTR { return share_of_code<Int>(V(static_cast<ElementOf<Int>>(code))); };
  switch (factor) {
    case BlendFactor::zero:
      return {Int(0), 0};
    case BlendFactor::one:
      return {Int(1), 0};
    case BlendFactor::src_color:
      return o.is_alpha ? o.a : share_of_code<Int>(o.src_code);
    case BlendFactor::one_minus_src_color:
      return one_minus(o.is_alpha ? o.a : share_of_code<Int>(o.src_code));
    case BlendFactor::dst_color:
      return share_of_code<Int>(o.dst_code);
    case BlendFactor::one_minus_dst_color:
      return one_minus(share_of_code<Int>(o.dst_code));
    case BlendFactor::src_alpha:
      return o.a;
    case BlendFactor::one_minus_src_alpha:
      return one_minus(o.a);
    case BlendFactor::dst_alpha:
      return share_of_code<Int>(o.dst_alpha);
    case BlendFactor::one_minus_dst_alpha:
      return one_minus(share_of_code<Int>(o.dst_alpha));
    case BlendFactor::constant_color:
      return constant(o.constant);
    case BlendFactor::one_minus_constant_color:
      return one_minus(constant(o.constant));
    case BlendFactor::constant_alpha:
      return constant(o.constant_alpha);
    case BlendFactor::one_minus_constant_alpha:
      return one_minus(constant(o.constant_alpha));
    case BlendFactor::src_alpha_saturate: {
      if (o.is_alpha) return {Int(1), 0};
      return smaller(o.a, one_minus(share_of_code<Int>(o.dst_alpha)));
    }
    case BlendFactor::half:
      return {Int(1), 1};
  }
  unreachable();
}

template <class Int>
HWY_INLINE Scaled<Int> combined(const BlendEquation& equation, const Operands<Int>& o) {
  const auto scaled = [&](const Scaled<Int>& x, BlendFactor factor) HWY_ATTR -> Scaled<Int> {
    if (equation.op == BlendOp::min || equation.op == BlendOp::max) return x;
    return x * factor_of(factor, o);
  };
  const Scaled<Int> p = scaled(o.src, equation.src);
  const Scaled<Int> r = scaled(o.dst, equation.dst);
  const int grid = std::max(p.fraction, r.fraction);
  const Int own = on_grid(p, grid);
  const Int stored = on_grid(r, grid);
  switch (equation.op) {
    case BlendOp::add:
      return {own + stored, grid};
    case BlendOp::subtract:
      return {own - stored, grid};
    case BlendOp::reverse_subtract:
      return {stored - own, grid};
    case BlendOp::min:
      return {at_most(own, stored), grid};
    case BlendOp::max:
      return {at_least(own, stored), grid};
  }
  unreachable();
}

// By the truth table that the operation's number is.
template <class V>
HWY_INLINE V logic(LogicOp op, V src, V dst) {
  const auto table = static_cast<unsigned>(op) - 1U;
  V out(0);
  if ((table & 1U) != 0) out = out | (src & dst);
  if ((table & 2U) != 0) out = out | (src & ~dst);
  if ((table & 4U) != 0) out = out | (~src & dst);
  if ((table & 8U) != 0) out = out | (~src & ~dst);
  return out & V(255);
}

// A fragment's alpha, at most 1; raw: on texture.alpha.
template <class Int>
HWY_INLINE Scaled<Int> alpha_of(const MergeStage& stage, ValueOf<Int> raw) {
  // A grid that has 1.
  const int grid = stage.alpha.fraction > 0 ? stage.alpha.fraction : 0;
  return {at_most(Int(raw) << (grid - stage.alpha.fraction), Int(1) << grid), grid};
}

// The pixel's codes that a channel's blend may look at.
template <class V>
struct StoredCodes {
  V code, alpha;
};

// A channel of a fragment by any blend; own: on fog.color; a: on texture.alpha.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> mixed(const MergeStage& stage, ValueOf<Int> own, StoredCodes<ValueOf<Int>> stored,
                              std::size_t channel, ValueOf<Int> a, Watch watch) {
  const Blend& blend = stage.blend;
  if (blend.logic != LogicOp::none) return logic(blend.logic, replaced(stage, own, watch), stored.code);
  Operands<Int> o;
  const int grid = stage.color_in.fraction > 0 ? stage.color_in.fraction : 0;
  o.src = {Int(own) << (grid - stage.color_in.fraction), grid};
  o.dst = {Int(stored.code), 0};
  o.a = alpha_of<Int>(stage, a);
  // To the nearest code, halves up.
  o.src_code =
      as_value<Int>(at_most(at_least(((o.src.raw << 1) + (Int(1) << grid)) >> (grid + 1), Int(0)), Int(255)));
  o.dst_code = stored.code;
  o.dst_alpha = stored.alpha;
  o.constant = blend.constant[channel];
  o.constant_alpha = blend.constant[3];
  const Scaled<Int> value = combined(blend.color, o);
  return quantize(value.raw, value.fraction, stage.color, watch);
}

// The pixel's new alpha by any blend; stored: its code before; a: on texture.alpha.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> mixed_alpha(const MergeStage& stage, ValueOf<Int> stored, ValueOf<Int> a,
                                    Watch watch) {
  const Blend& blend = stage.blend;
  Operands<Int> o;
  o.a = alpha_of<Int>(stage, a);
  o.is_alpha = true;
  o.src_code = code_of_alpha(o.a.raw, o.a.fraction);
  if (blend.logic != LogicOp::none) return logic(blend.logic, o.src_code, stored);
  o.dst_code = o.dst_alpha = stored;
  o.constant = o.constant_alpha = blend.constant[3];
  o.src = {Int(o.src_code), 0};
  o.dst = {Int(stored), 0};
  const Scaled<Int> value = combined(blend.alpha, o);
  return quantize(value.raw, value.fraction, stage.color, watch);
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
