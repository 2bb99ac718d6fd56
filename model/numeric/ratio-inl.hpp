// SPDX-License-Identifier: Apache-2.0
// Q[name](n / d) for lanes: the same value, lane by lane, as quantize_ratio() of ratio.hpp gives.
#include <algorithm>
#include <bit>

#include "model/numeric/quantize-inl.hpp"
#include "model/numeric/ratio.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_RATIO_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_RATIO_INL
#undef BITSPAN_MODEL_NUMERIC_RATIO_INL
#else
#define BITSPAN_MODEL_NUMERIC_RATIO_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

using model::quantize_ratio;

// A numerator for quotient(): its low 64 bits, and itself in floating point, off by 2^-52 of itself at most.
struct Numerator {
  Lanes low;
  Doubles near;
};
HWY_INLINE Numerator numerator(Lanes n) { return {n, to_double(n)}; }
HWY_INLINE Numerator numerator(WideLanes n) {
  // hi 2^64 + lo, with lo taken as signed and the carry given to hi: each part rounds by 2^-53 of itself.
  const hn::ScalableTag<double> d;
  const Lanes hi = n.hi + one_where(n.lo < Lanes(0));
  return {n.lo, hn::Add(hn::Mul(to_double(hi), hn::Set(d, 0x1p64)), to_double(n.lo))};
}

// floor(n 2^scale / d) and the rest n 2^scale - floor d; d > 0. ok false on a lane: it has to be done by
// other means. Why this is exact, with e = 2^-53: one conversion, sum or division is off by at most e of its
// result.
//   near    n is off by at most 2 e of itself. For Lanes it is e. For WideLanes the halves and their sum
//           round. hi' 2^64 rounds only where |hi'| > 2^53, and then lo's part is nothing beside it. lo, at
//           most 2^63 in size, rounds by 2^9, and |n| >= 2^63 wherever hi' is not 0. So the halves together
//           give e, and the sum gives e.
//   near_q  before Floor is off by that, by e of d and by e of the division: 4 e (1 + 4 e) of the quotient.
//           Below 2^49 this is little more than 1/4, so the floor is off by one at most. Powers of two scale
//           exactly.
//   rest    of such a floor is in -d .. 2 d, and d < 2^61. So its low 64 bits, all that is computed of it,
//           are the rest itself.
// A divisor or quotient beyond double's range is an infinity or a NaN here and fails `small`.
struct FloorQuotientLanes {
  Lanes floor, rest;
  Lanes d;  // times 2^-scale where scale < 0
  Lanes::Mask ok;
};
// 2^e; infinite from 1024.
constexpr double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>((e < 1024 ? e : 1024) + 1023) << 52);
}
HWY_INLINE FloorQuotientLanes quotient(Numerator n, Lanes d, int scale) {
  const hn::ScalableTag<double> tag;
  const int up = scale > 0 ? scale : 0;
  const int down = scale < 0 ? -scale : 0;
  const Lanes divisor = d << (down < 63 ? down : 63);
  const auto near_d = hn::Mul(to_double(d), hn::Set(tag, power_of_two(down)));
  const auto near_q = hn::Floor(hn::Div(hn::Mul(n.near, hn::Set(tag, power_of_two(up))), near_d));
  const auto small =
      hn::And(hn::Lt(hn::Abs(near_q), hn::Set(tag, 0x1p49)), hn::Lt(near_d, hn::Set(tag, 0x1p61)));
  const Lanes::Mask ok{hn::RebindMask(Lanes::Tag(), small)};
  Lanes floor = to_int(hn::IfThenElseZero(small, near_q));
  const Lanes shifted = up < 64 ? n.low << up : Lanes(0);
  Lanes rest = shifted - floor * divisor;
  const auto low = rest < Lanes(0);
  floor = floor - one_where(low);
  rest = rest + select(low, divisor, Lanes(0));
  const auto high = rest >= divisor;
  floor = floor + one_where(high);
  rest = rest - select(high, divisor, Lanes(0));
  return {floor, rest, divisor, ok};
}

HWY_INLINE int128 wide_lane(Lanes n, std::size_t i) { return lane(n, i); }
HWY_INLINE int128 wide_lane(WideLanes n, std::size_t i) {
  return static_cast<int128>(static_cast<uint128>(static_cast<std::uint64_t>(lane(n.hi, i))) << 64 |
                             static_cast<std::uint64_t>(lane(n.lo, i)));
}

// Rare sizes, one by one. Observers see them there as well.
template <class Int, class Watch>
HWY_NOINLINE Lanes quantize_ratio_rare(Int n, Lanes d, int scale, const Register& r, Watch watch) {
  return by_lane([&](std::size_t i) HWY_ATTR {
    const std::int64_t divisor = std::max<std::int64_t>(lane(d, i), 1);
    if constexpr (Watch::enabled) {
      Statistics one;
      const std::int64_t out = model::quantize_ratio(wide_lane(n, i), divisor, scale, r, Observe{&one});
      watch.add(r, i, one.of(r.id));
      return out;
    } else {
      return model::quantize_ratio(wide_lane(n, i), divisor, scale, r, NoObserve{});
    }
  });
}

// (n / d) 2^scale into r; d > 0, or the lane gives anything. Int: Lanes or WideLanes.
template <class Int, class Watch>
inline Lanes quantize_ratio(Int n, Lanes d, int scale, const Register& r,
                            Watch watch) requires(std::is_same_v<Int, Lanes> ||
                                                  std::is_same_v<Int, WideLanes>) {
  const FloorQuotientLanes q = quotient(numerator(n), d, r.fraction + scale);
  if (any(!q.ok)) [[unlikely]] {
    return quantize_ratio_rare(n, d, scale, r, watch);
  }
  const Lanes up = q.d - q.rest;
  const auto guard = q.rest >= up;
  const auto sticky = select(guard, q.rest ^ up, q.rest) != Lanes(0);
  const Lanes floor = q.floor;
  const Lanes add =
      one_where(rounds_up(r.mode, floor < Lanes(0), (floor & Lanes(1)) != Lanes(0), guard, sticky));
  const Lanes rounded = floor + add;
  if constexpr (Watch::enabled) {
    // rest / d in 2^-32 ulp, rounded down, by the same division.
    const FloorQuotientLanes part = quotient(
        {q.rest << bias_fraction,
         hn::Mul(to_double(q.rest), hn::Set(hn::ScalableTag<double>(), power_of_two(bias_fraction)))},
        q.d, 0);
    watch.note(r, rounded, (rounded < Lanes(r.min)) | (rounded > Lanes(r.max)),
               (add << bias_fraction) - part.floor);
  }
  return into_range(rounded, r);
}

// A divisor of several quotients: 0 < d, near its nearest double, inverse the double nearest to 1 / near.
struct Divisor {
  Lanes d;
  Doubles near, inverse;
};
HWY_INLINE Divisor make_divisor(Lanes d) {
  const auto near = to_double(d);
  return {d, near, hn::Div(hn::Set(hn::ScalableTag<double>(), 1.0), near)};
}

// (n / d) 2^scale to the nearest integer or the one beside it, off by less than 0.8, and the rest
// n 2^scale - whole d, both times 2^-scale where scale < 0. With fused multiply-adds all is exact: a rest of
// less than near in size is an integer below 2^53. Why 0.8: n and d are doubles themselves, so that the
// quotient before rounding to `whole` is off by 2^-52.9 of itself, and it is below 2^50.
struct NearQuotient {
  Doubles whole, rest, near;
  bool ok;  // on every lane; or it has to be done by other means
};
inline constexpr bool has_fused = HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2;
HWY_INLINE NearQuotient near_quotient(Lanes n, const Divisor& d, int scale) {
  const hn::ScalableTag<double> tag;
  constexpr int most_scale = 500;
  const int up = scale > 0 ? std::min(scale, most_scale) : 0;
  const int down = scale < 0 ? std::min(-scale, most_scale) : 0;
  const auto exact = hn::Set(tag, 0x1p53);
  const auto n_near = to_double(n);
  const auto n_up = hn::Mul(n_near, hn::Set(tag, power_of_two(up)));
  const auto d_up = hn::Mul(d.near, hn::Set(tag, power_of_two(down)));
  const auto ratio = hn::Mul(hn::Mul(n_up, d.inverse), hn::Set(tag, power_of_two(-down)));
  const auto whole = hn::Round(ratio);
  const auto ok = hn::And(hn::And(hn::Lt(hn::Abs(n_near), exact), hn::Lt(d_up, exact)),
                          hn::Lt(hn::Abs(ratio), hn::Set(tag, 0x1p50)));
  return {whole, hn::NegMulAdd(whole, d_up, n_up), d_up,
          has_fused && scale <= most_scale && scale >= -most_scale && hn::AllTrue(tag, ok)};
}

// quantize_ratio() of a prepared divisor.
template <class Watch>
HWY_INLINE Lanes quantize_ratio(Lanes n, const Divisor& d, int scale, const Register& r, Watch watch) {
  return quantize_ratio(n, d.d, scale, r, watch);
}
HWY_INLINE Lanes quantize_ratio(Lanes n, const Divisor& d, int scale, const Register& r,
                                BranchFree /*watch*/) {
  const NearQuotient q = near_quotient(n, d, r.fraction + scale);
  if (!q.ok) [[unlikely]] {
    return quantize_ratio_rare(n, d.d, scale, r, NoObserve{});
  }
  const hn::ScalableTag<double> tag;
  const auto zero = hn::Zero(tag);
  const auto one = hn::Set(tag, 1.0);
  const auto twice = hn::Add(q.rest, q.rest);
  auto rounded = q.whole;
  if (r.mode == Rounding::trn) {
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Lt(q.rest, zero), one));
  } else if (r.mode == Rounding::rnd) {
    rounded = hn::Add(rounded, hn::IfThenElseZero(hn::Ge(twice, q.near), one));
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Lt(twice, hn::Neg(q.near)), one));
  } else {
    rounded = hn::Add(rounded, hn::IfThenElseZero(hn::Gt(twice, q.near), one));
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Le(twice, hn::Neg(q.near)), one));
  }
  return min(max(to_int(rounded), Lanes(r.min)), Lanes(r.max));
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
