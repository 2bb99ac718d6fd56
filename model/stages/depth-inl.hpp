// SPDX-License-Identifier: Apache-2.0
// The depth code's arithmetic, one text for a fragment and for lanes of them.
#include "config/modes.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/span-inl.hpp"

#if defined(BITSPAN_MODEL_STAGES_DEPTH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_DEPTH_INL
#undef BITSPAN_MODEL_STAGES_DEPTH_INL
#else
#define BITSPAN_MODEL_STAGES_DEPTH_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

template <class Value>
struct DepthPoint {
  Value z, recip_m, recip_e;
};

// Int: int128 or WideLanes for the linear code's product, any for the others. scene: B, c1 and c0.
template <class Int, class Watch>
HWY_INLINE DepthPoint<ValueOf<Int>> depth_point(const DepthFormats& f, const DepthScene& scene,
                                                ValueOf<Int> h, Watch watch) {
  using Value = ValueOf<Int>;
  const Value none(0);
  switch (f.code) {
    case DepthCode::inverse:
      return {quantize(h, f.h.fraction, f.z, watch), none, none};
    case DepthCode::opengl:
    case DepthCode::float_dz: {
      // zmax - h on a grid that holds both. float_dz is packed when it has its bias.
      const int up = f.h.fraction < 0 ? -f.h.fraction : 0;
      const Int difference = (Int(Value(f.zmax)) << (f.h.fraction + up)) - (Int(h) << up);
      return {quantize(difference, f.h.fraction + up, f.z, watch), none, none};
    }
    case DepthCode::linear: {
      const DepthSumOf<Int> q = (DepthSumOf<Int>(h) << f.h_up) + depth_constant<Int>(scene.b);
      const auto inverse = reciprocal(f.reciprocal, scene.table, q, f.q_fraction, watch);
      const Value product = inverse.e + Value(f.c1_fraction + f.reciprocal.output.fraction);
      const Value common = max(product, Value(f.c0_fraction));
      const Int scaled = shifted_up(times<Int>(Value(scene.c1), inverse.m), common - product);
      const Value z =
          quantize(scaled - (Int(Value(scene.c0)) << (common - Value(f.c0_fraction))), common, f.z, watch);
      return {z, inverse.m, inverse.e};
    }
    case DepthCode::w_float: {
      using Sum = DepthSumOf<Int>;
      const Sum q = (Sum(h) << f.h_up) + depth_constant<Int>(scene.b);
      const Sum farthest = depth_constant<Int>(scene.w_far);
      const Sum held = at_most(at_least(q, farthest), (Sum(1) << scene.w_top) - Sum(1));
      const int top = scene.w_top - 1;  // of the octave that is the nearest
      const Value octave = Value(top) - top_bit(held);
      const Int code = (Int(octave + Value(2)) << top) - (Int(held) << octave);
      const Value z = quantize(code, top - f.mantissa_bits, f.z, watch);
      return {select(q < farthest, Value(f.zmax), z), none, none};
    }
  }
  unreachable();
}

// Whether a point of code `a` is nearer than one of code `b`, both in the order of Value.
template <class Value>
HWY_INLINE auto is_nearer(const DepthFormats& f, Value a, Value b) {
  return f.nearer_is_larger ? a > b : a < b;
}

// The depth comparison: whether z passes against what is stored, both in the order of Value.
template <class Value>
HWY_INLINE auto depth_passes(const DepthFormats& f, DepthFunc func, Value z, Value stored) {
  switch (func) {
    case DepthFunc::never:
      return is_nearer(f, z, z);
    case DepthFunc::less:
      return is_nearer(f, z, stored);
    case DepthFunc::equal:
      return z == stored;
    case DepthFunc::lequal:
      return !is_nearer(f, stored, z);
    case DepthFunc::greater:
      return is_nearer(f, stored, z);
    case DepthFunc::notequal:
      return !(z == stored);
    case DepthFunc::gequal:
      return !is_nearer(f, z, stored);
    case DepthFunc::always:
      return !is_nearer(f, z, z);
  }
  unreachable();
}

// The same for a word as the buffer holds it, in any code.
inline bool depth_word_passes(const DepthFormats& f, DepthFunc func, std::int64_t word, std::int64_t stored) {
  if (!has_dz(f.code)) return depth_passes(f, func, word, stored);
  const PackedDepth a = unpacked_depth(word, f.z.word);
  const PackedDepth b = unpacked_depth(stored, f.z.word);
  const std::int64_t apart = a.z < b.z ? b.z - a.z : a.z - b.z;
  const bool as_far = takes_tolerance(func) && apart <= std::int64_t{1} << std::max(a.dz, b.dz);
  return depth_passes(f, func, as_far ? b.z : a.z, b.z);
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
