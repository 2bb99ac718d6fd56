// SPDX-License-Identifier: Apache-2.0
// The expressions of forms.hpp, one text for an integer and for lanes of them. Value: what registers hold,
// std::int64_t or Lanes. Each looks at the operand that decides whether 64 bits do, and takes 128 where not.
#include "model/numeric/adder.hpp"
#include "model/numeric/forms.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio-inl.hpp"
#include "model/numeric/reciprocal-inl.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_FORMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_FORMS_INL
#undef BITSPAN_MODEL_NUMERIC_FORMS_INL
#else
#define BITSPAN_MODEL_NUMERIC_FORMS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// Int64 and Int128: what intermediates are held in. Sum: what holds the sum of two registers, of any format
// for one integer; lanes are used where they hold it.
template <class Value>
struct WidthsOf;
template <>
struct WidthsOf<std::int64_t> {
  using Int64 = std::int64_t;
  using Int128 = int128;
  using Sum = int128;
};
template <>
struct WidthsOf<Lanes> {
  using Int64 = Lanes;
  using Int128 = WideLanes;
  using Sum = Lanes;
};
template <class Value>
using SumOf = typename WidthsOf<Value>::Sum;

// Whether -2^bits <= x < 2^bits (on every lane); never for bits < 0. bits <= 62
HWY_INLINE bool below(int128 x, int bits) { return bits >= 0 && ((x ^ (x >> 127)) >> bits) == 0; }
HWY_INLINE bool below(std::int64_t x, int bits) { return bits >= 0 && ((x ^ (x >> 63)) >> bits) == 0; }
HWY_INLINE bool below(Lanes x, int bits) {
  return bits >= 0 && all((x ^ (x >> 63)) < Lanes(std::int64_t{1} << bits));
}

// a b in Int, which holds it.
template <class Int>
HWY_INLINE Int product_in(SumOf<ValueOf<Int>> a, SumOf<ValueOf<Int>> b) {
  if constexpr (std::is_same_v<Int, WideLanes>) {
    return product_of(a, b);
  } else {
    return static_cast<Int>(a) * static_cast<Int>(b);
  }
}

template <class Value>
HWY_INLINE SumOf<Value> depth_sum(const DepthSum& s, Value h) {
  return (SumOf<Value>(h) << s.up) + constant<SumOf<Value>>(s.b);
}
// a - b
template <class Value>
HWY_INLINE SumOf<Value> difference(Value a, Value b) {
  return SumOf<Value>(a) - SumOf<Value>(b);
}

template <class Int, class Value, class Watch>
HWY_INLINE Value line_in(const Line& line, Value base, Value step, SumOf<Value> t, Watch watch) {
  const Int sum = (Int(base) << line.base_up) + (product_in<Int>(SumOf<Value>(step), t) << line.product_up) +
                  constant<Int>(line.offset);
  return quantize(sum, line.fraction, line.r, watch);
}
template <class Value, class Watch>
HWY_INLINE Value line_at(const Line& line, Value base, Value step, SumOf<Value> t, Watch watch) {
  if (below(t, line.t_bits)) [[likely]] {
    return line_in<typename WidthsOf<Value>::Int64>(line, base, step, t, watch);
  }
  return line_in<typename WidthsOf<Value>::Int128>(line, base, step, t, watch);
}

// Q[acc](acc + step)
template <class Value, class Watch>
HWY_INLINE Value stepped(const Adder& adder, Value acc, Value step, Watch watch) {
  using Int128 = typename WidthsOf<Value>::Int128;
  if (adder.fits_int64) [[likely]] {
    return quantize((acc << adder.acc_up) + (step << adder.step_up), adder.fraction, adder.acc, watch);
  }
  return quantize((Int128(acc) << adder.acc_up) + (Int128(step) << adder.step_up), adder.fraction, adder.acc,
                  watch);
}

template <class Value, class Watch>
HWY_INLINE Value product(const Product& p, SumOf<Value> a, SumOf<Value> b, Watch watch) {
  using Widths = WidthsOf<Value>;
  if (below(a, p.a_bits)) [[likely]] {
    return quantize(product_in<typename Widths::Int64>(a, b), p.fraction, p.r, watch);
  }
  return quantize(product_in<typename Widths::Int128>(a, b), p.fraction, p.r, watch);
}

// X: Value or SumOf<Value>.
template <class Value, class X, class Watch>
HWY_INLINE Value narrowed(const Narrowing& n, X x, Watch watch) {
  using Widths = WidthsOf<Value>;
  if (n.fits) [[likely]] {
    return quantize(static_cast<typename Widths::Int64>(x), n.fraction, n.r, watch);
  }
  return quantize(typename Widths::Int128(x), n.fraction, n.r, watch);
}

template <class Int, class Value, class Watch>
HWY_INLINE Value perspective_point_in(const PerspectivePoint& p, Value base, Value f,
                                      InverseOf<Value> inverse, Watch watch) {
  const Value grid = inverse.e + Value(p.product_fraction);
  const Value common = max(grid, Value(p.base_fraction));
  const Int sum =
      (Int(base) << (common - Value(p.base_fraction))) + shifted_up(times<Int>(f, inverse.m), common - grid);
  return quantize(sum, common, p.r, watch);
}
template <class Value, class Watch>
HWY_INLINE Value perspective_point(const PerspectivePoint& p, Value base, Value f, InverseOf<Value> inverse,
                                   Watch watch) {
  if (below(f, p.f_bits)) [[likely]] {
    if (p.aligned) {
      using Int = typename WidthsOf<Value>::Int64;
      const Value fraction = inverse.e + Value(p.product_fraction);
      const Int sum = (Int(base) << (fraction - Value(p.base_fraction))) + times<Int>(f, inverse.m);
      return quantize_down(sum, fraction, p.r, watch);
    }
    return perspective_point_in<typename WidthsOf<Value>::Int64>(p, base, f, inverse, watch);
  }
  return perspective_point_in<typename WidthsOf<Value>::Int128>(p, base, f, inverse, watch);
}

// Q[r](x 2^-exponent) of a double, exactly; x finite.
template <class Watch>
HWY_INLINE std::int64_t quantize_real(double x, int exponent, const Register& r, Watch watch) {
  return model::quantize(scaled(exact_of(x), exponent), r, watch);
}
// Below 2^51 floor and floor + 1/2 are exact, so comparisons tell guard and sticky. Scaling by a power of two
// is exact away from the ends of the exponent range.
template <class Watch>
HWY_INLINE Lanes quantize_real(Doubles x, int exponent, const Register& r, Watch watch) {
  const hn::ScalableTag<double> d;
  const int up = r.fraction - exponent;
  const bool moderate = up > -500 && up < 500;
  const auto y =
      hn::Mul(x, hn::Set(d, std::bit_cast<double>(std::int64_t{1023 + (moderate ? up : 0)} << 52)));
  const auto size = hn::Abs(x);
  const auto ok = hn::And(hn::Lt(hn::Abs(y), hn::Set(d, 0x1p51)),
                          hn::Or(hn::Gt(size, hn::Set(d, 0x1p-500)), hn::Eq(size, hn::Zero(d))));
  if (!moderate || !hn::AllTrue(d, ok)) [[unlikely]] {
    HWY_ALIGN double raw[Lanes::count];
    hn::Store(x, d, raw);
    return by_lane([&](std::size_t i) HWY_ATTR {
      if constexpr (Watch::enabled) {
        Statistics one;
        const std::int64_t out = quantize_real(raw[i], exponent, r, Observe{&one});
        watch.add(r, i, one.of(r.id));
        return out;
      } else {
        return quantize_real(raw[i], exponent, r, NoObserve{});
      }
    });
  }
  const auto as_mask = [](auto m) HWY_ATTR { return Lanes::Mask{hn::RebindMask(Lanes::Tag(), m)}; };
  const auto whole = hn::Floor(y);
  const auto half = hn::Add(whole, hn::Set(d, 0.5));
  const Lanes floor = to_int(whole);
  const Lanes::Mask guard = as_mask(hn::Ge(y, half));
  const Lanes::Mask sticky = !((guard & as_mask(hn::Eq(y, half))) | (as_mask(hn::Eq(y, whole))));
  const Lanes add =
      one_where(rounds_up(r.mode, floor < Lanes(0), (floor & Lanes(1)) != Lanes(0), guard, sticky));
  const Lanes rounded = floor + add;
  if constexpr (Watch::enabled) {
    // In 2^-32 ulp, rounded down; both terms are exact, and so is their difference, an integer below 2^32.
    const auto unit = hn::Set(d, 0x1p32);
    const Lanes part = to_int(hn::Sub(hn::Floor(hn::Mul(y, unit)), hn::Mul(whole, unit)));
    watch.note(r, rounded, (rounded < Lanes(r.min)) | (rounded > Lanes(r.max)),
               (add << bias_fraction) - part);
  }
  return into_range(rounded, r);
}

// Branch-free but for sizes that take another way.
HWY_INLINE Lanes quantize_real(Doubles x, int exponent, const Register& r, BranchFree /*watch*/) {
  const hn::ScalableTag<double> d;
  const int up = r.fraction - exponent;
  if (up < 0 || up > 500) [[unlikely]] {
    return quantize_real(x, exponent, r, NoObserve{});
  }
  const auto y = hn::Mul(x, hn::Set(d, power_of_two(up)));
  if (!hn::AllTrue(d, hn::Lt(hn::Abs(y), hn::Set(d, 0x1p51)))) [[unlikely]] {
    return quantize_real(x, exponent, r, NoObserve{});
  }
  const auto whole = hn::Floor(y);
  const auto rest = hn::Sub(y, whole);  // exact, but where y is just below 0: then it is above half still
  const auto half = hn::Set(d, 0.5);
  const auto one = hn::Set(d, 1.0);
  const auto rounded = r.mode == Rounding::trn ? whole
                       : r.mode == Rounding::rnd
                           ? hn::Add(whole, hn::IfThenElseZero(hn::Ge(rest, half), one))
                           : hn::Add(whole, hn::IfThenElseZero(hn::Gt(rest, half), one));
  return min(max(to_int(rounded), Lanes(r.min)), Lanes(r.max));
}

// The observer of the lanes in m alone.
HWY_INLINE BranchFree only(BranchFree watch, Lanes::Mask /*m*/) { return watch; }
HWY_INLINE NoObserve only(NoObserve watch, Lanes::Mask /*m*/) { return watch; }
HWY_INLINE ObserveLanes only(ObserveLanes watch, Lanes::Mask m) {
  return {watch.statistics, watch.active & m};
}

// f(watch) where m, else 0.
template <class Watch, class F>
HWY_INLINE std::int64_t where(bool m, Watch watch, F f) {
  return m ? f(watch) : 0;
}
template <class Watch, class F>
HWY_INLINE Lanes where(Lanes::Mask m, Watch watch, F f) {
  return select(m, f(only(watch, m)), Lanes(0));
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
