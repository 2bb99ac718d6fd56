// SPDX-License-Identifier: Apache-2.0
// The span stage's arithmetic, one text for a fragment and for lanes of them. Int: what intermediates are
// held in (std::int64_t, int128, Lanes, WideLanes); registers hold ValueOf<Int>.
#include "config/modes.hpp"
#include "model/numeric/ratio-inl.hpp"
#include "model/numeric/reciprocal-inl.hpp"
#include "model/stages/span.hpp"

#if defined(BITSPAN_MODEL_STAGES_SPAN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_SPAN_INL
#undef BITSPAN_MODEL_STAGES_SPAN_INL
#else
#define BITSPAN_MODEL_STAGES_SPAN_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// What h + B is held in: one integer may need Int's width, lanes never do (see vector_path).
template <class Int>
struct DepthSumOfType {
  using type = Int;
};
template <>
struct DepthSumOfType<WideLanes> {
  using type = Lanes;
};
template <class Int>
using DepthSumOf = typename DepthSumOfType<Int>::type;

// B on the grid of h + B.
template <class Int>
HWY_INLINE DepthSumOf<Int> depth_constant(int128 b) {
  if constexpr (std::is_same_v<DepthSumOf<Int>, int128>) {
    return b;
  } else {
    return DepthSumOf<Int>(static_cast<std::int64_t>(b));
  }
}

// Q[acc](acc + step)
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> accumulated(ValueOf<Int> acc, ValueOf<Int> step, const Adder& adder, Watch watch) {
  return quantize((Int(acc) << adder.acc_up) + (Int(step) << adder.step_up), adder.fraction, adder.acc,
                  watch);
}

template <class Value>
struct TexturePoint {
  Value u, v, recip_m, recip_e;
};

// u and v from the registers; b: B on the grid of h + B; table: of R_pixel. aligned: SpanStage::aligned, or
// false.
template <class Int, class Watch>
HWY_INLINE TexturePoint<ValueOf<Int>> texture_point(const SpanFormats& f, DepthSumOf<Int> b,
                                                    const std::int64_t* table, ValueOf<Int> h,
                                                    ValueOf<Int> fu, ValueOf<Int> fv, ValueOf<Int> u1,
                                                    ValueOf<Int> v1, bool aligned, Watch watch) {
  using Value = ValueOf<Int>;
  const Value none(0);
  switch (f.perspective) {
    case Perspective::delta_f: {
      const DepthSumOf<Int> q = (DepthSumOf<Int>(h) << f.h_up) + b;
      const auto inverse = reciprocal(f.reciprocal, table, q, f.q_fraction, watch);
      // Fractions of f m 2^-e, and of the sum with u1.
      const Value product = inverse.e + Value(f.f.acc.fraction + f.reciprocal.output.fraction);
      const Value common = aligned ? product : max(product, Value(f.u1_fraction));
      const auto coordinate = [&](Value base, Value numerator) HWY_ATTR __attribute__((always_inline)) {
        if (aligned) {
          const Int sum = (Int(base) << (common - Value(f.u1_fraction))) + times<Int>(numerator, inverse.m);
          return quantize_down(sum, common, f.uv, watch);
        }
        const Int sum = (Int(base) << (common - Value(f.u1_fraction))) +
                        shifted_up(times<Int>(numerator, inverse.m), common - product);
        return quantize(sum, common, f.uv, watch);
      };
      const Value u = coordinate(u1, fu);
      return {u, coordinate(v1, fv), inverse.m, inverse.e};
    }
    case Perspective::hyperbolic: {
      const DepthSumOf<Int> q = at_least_one((DepthSumOf<Int>(h) << f.h_up) + b);
      const int scale = f.q_fraction - f.f.acc.fraction;
      const Value u = quantize_ratio(fu, q, scale, f.uv, watch);
      return {u, quantize_ratio(fv, q, scale, f.uv, watch), none, none};
    }
    case Perspective::affine:
    case Perspective::const_depth_rows: {
      // On u's grid they may be wider than a Value.
      const Value u = quantize(Int(fu), f.f.acc.fraction, f.uv, watch);
      return {u, quantize(Int(fv), f.f.acc.fraction, f.uv, watch), none, none};
    }
  }
  unreachable();
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
