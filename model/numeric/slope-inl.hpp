// SPDX-License-Identifier: Apache-2.0
// Slopes, one text for an integer and for lanes of them.
#include "config/modes.hpp"
#include "model/numeric/forms-inl.hpp"
#include "model/numeric/ratio-inl.hpp"
#include "model/numeric/slope.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_SLOPE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_SLOPE_INL
#undef BITSPAN_MODEL_NUMERIC_SLOPE_INL
#else
#define BITSPAN_MODEL_NUMERIC_SLOPE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// d > 0, with its reciprocal where the form takes one (m = e = 0 with divide).
template <class Value>
struct LengthOf {
  SumOf<Value> d;
  InverseOf<Value> inverse;
  HWY_INLINE SumOf<Value> divisor() const { return d; }
};
template <>
struct LengthOf<Lanes> {
  Lanes d;
  InverseOf<Lanes> inverse;
  Divisor prepared;  // with divide
  HWY_INLINE const Divisor& divisor() const { return prepared; }
};
template <class Value>
HWY_INLINE LengthOf<Value> length_of(SumOf<Value> d, InverseOf<Value> inverse) {
  if constexpr (std::is_same_v<Value, Lanes>) {
    return {d, inverse, make_divisor(d)};
  } else {
    return {d, inverse};
  }
}

template <class Value, class Watch>
HWY_INLINE LengthOf<Value> make_length(const LengthForm& f, SumOf<Value> d, Watch watch) {
  switch (f.form) {
    case SlopeForm::divide:
      return length_of<Value>(d, {Value(0), Value(0)});
    case SlopeForm::reciprocal:
      return length_of<Value>(d, HWY_NAMESPACE::reciprocal(f.unit.formats(), f.unit.table().data(), d,
                                                           f.magnitude.fraction, watch));
  }
  unreachable();
}

// The same where m; elsewhere d = 1, m = e = 0.
template <class Value, class Watch>
HWY_INLINE LengthOf<Value> length_where(bool m, const LengthForm& f, SumOf<Value> d, Watch watch) {
  return m ? make_length<Value>(f, d, watch) : LengthOf<Value>{1, {0, 0}};
}
template <class Value, class Watch>
HWY_INLINE LengthOf<Value> length_where(Lanes::Mask m, const LengthForm& f, Lanes d, Watch watch) {
  const LengthOf<Value> all = make_length<Value>(f, max(d, Lanes(1)), only(watch, m));
  const Lanes none(0);
  return {all.d, {select(m, all.inverse.m, none), select(m, all.inverse.e, none)}, all.prepared};
}

template <class Value, class Watch>
HWY_INLINE Value slope(const Slope& s, const LengthForm& f, SumOf<Value> n, const LengthOf<Value>& length,
                       Watch watch) {
  using Widths = WidthsOf<Value>;
  switch (f.form) {
    case SlopeForm::divide:
      return quantize_ratio(n, length.divisor(), s.ratio_scale, s.r, watch);
    case SlopeForm::reciprocal: {
      const Value fraction = length.inverse.e + Value(s.product_fraction);
      if (below(n, s.n_bits)) [[likely]] {
        const auto whole = product_in<typename Widths::Int64>(n, length.inverse.m);
        return s.down ? quantize_down(whole, fraction, s.r, watch) : quantize(whole, fraction, s.r, watch);
      }
      return quantize(product_in<typename Widths::Int128>(n, length.inverse.m), fraction, s.r, watch);
    }
  }
  unreachable();
}

// The same where n is often 0, as of a colour that does not change: Q(0) is 0 in every mode.
template <class Value, class Watch>
HWY_INLINE Value slope_or_none(const Slope& s, const LengthForm& f, SumOf<Value> n,
                               const LengthOf<Value>& length, Watch watch) {
  if constexpr (!Watch::enabled) {
    if (!any(n != SumOf<Value>(0))) {
      return Value(0);
    }
  }
  return slope<Value>(s, f, n, length, watch);
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
