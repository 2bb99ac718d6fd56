// SPDX-License-Identifier: Apache-2.0
// The reciprocal square root's arithmetic: one text for an integer and for lanes of them.
#include "model/numeric/reciprocal-inl.hpp"
#include "model/numeric/root.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_ROOT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_ROOT_INL
#undef BITSPAN_MODEL_NUMERIC_ROOT_INL
#else
#define BITSPAN_MODEL_NUMERIC_ROOT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// The place that a positive integer's highest bit has at most.
template <class Int>
inline constexpr int highest_place = std::is_same_v<Int, Lanes> ? 62 : 126;

// Stands for m 2^-e.
template <class V>
struct RootOf {
  V m, e;
};

// 1 / sqrt(d 2^-fraction), d > 0. Int: what the unit's intermediates fit, int128 or Lanes; Wide: what d does.
template <class Int, class Wide, class Watch>
HWY_INLINE RootOf<ValueOf<Int>> reciprocal_root(const ReciprocalRoot& root, Wide d, int fraction,
                                                Watch watch) {
  using V = ValueOf<Int>;
  const RootUnit& unit = root.unit;
  const V place = top_bit(d);
  const V top = place - V(fraction);  // 2^top <= d
  const V e = top >> 1;
  const V octave = top & V(1);
  const Wide aligned = d << (V(highest_place<Wide>) - place);
  const V n = low_word(aligned >> (V(highest_place<Wide> - unit.operand_bits) - octave));
  // n's leading bits are 1 and the index.
  const V entries(std::int64_t{1} << unit.index_bits);
  const V leading = n >> (V(unit.operand_bits - unit.index_bits) + octave);
  Int y(entry_of(root.table.data(), (octave << unit.index_bits) + leading - entries));
  int y_fraction = unit.table_bits;
  for (int step = 0; step < unit.steps; ++step) {
    const Int a = shifted_down(Int(n) * y, unit.operand_bits + y_fraction - unit.internal_bits);
    const Int c = shifted_down(a * y, y_fraction);
    y = shifted_down(y * ((Int(3) << unit.internal_bits) - c), y_fraction + 1);
    y_fraction = unit.internal_bits;
  }
  return {quantize(y, y_fraction, root.output, watch), e};
}

// X / |X| of X = x 2^-fraction; 0 where X is.
template <class Int, class Wide, class Watch>
HWY_INLINE std::array<ValueOf<Int>, 3> of_length_1(const ReciprocalRoot& root,
                                                   const std::array<ValueOf<Int>, 3>& x, int fraction,
                                                   const Register& r, Watch watch) {
  using V = ValueOf<Int>;
  if constexpr (std::is_same_v<Wide, WideLanes>) {
    // Parts that are short enough for squares of 60 bits, nearly always.
    const auto magnitude = [&](std::size_t i) HWY_ATTR { return x[i] ^ (x[i] >> 63); };
    if (!any((magnitude(0) | magnitude(1) | magnitude(2)) >= V(std::int64_t{1} << 30))) [[likely]] {
      return of_length_1<Int, Lanes>(root, x, fraction, r, watch);
    }
  }
  const Wide d = times<Wide>(x[0], x[0]) + times<Wide>(x[1], x[1]) + times<Wide>(x[2], x[2]);
  const auto is_none = (x[0] | x[1] | x[2]) == V(0);
  if (!any(!is_none)) return {V(0), V(0), V(0)};
  // An operand for lanes without one.
  const auto by = reciprocal_root<Int>(root, d + Wide(one_where(is_none)), 2 * fraction, watch);
  const V grid = by.e + V(fraction + root.output.fraction);
  const auto part = [&](std::size_t i) HWY_ATTR { return quantize(times<Int>(x[i], by.m), grid, r, watch); };
  return {part(0), part(1), part(2)};
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
