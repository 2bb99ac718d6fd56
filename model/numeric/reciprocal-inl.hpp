// The reciprocal units' arithmetic: one text for an integer and for lanes of them.
#include "config/modes.hpp"
#include "model/numeric/quantize-inl.hpp"
#include "model/numeric/reciprocal.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_RECIPROCAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_RECIPROCAL_INL
#undef BITSPAN_MODEL_NUMERIC_RECIPROCAL_INL
#else
#define BITSPAN_MODEL_NUMERIC_RECIPROCAL_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

template <class Int>
HWY_INLINE std::int64_t entry_of(const std::int64_t* table, Int index) {
  return table[static_cast<std::size_t>(index)];
}
HWY_INLINE Lanes entry_of(const std::int64_t* table, Lanes index) { return lookup(table, index); }

// v 2^-by, rounded down; by of either sign.
template <class Int>
HWY_INLINE Int shifted_down(Int v, int by) {
  return by >= 0 ? v >> by : v << -by;
}

// y, an approximation of 1/n, of the kinds with a table; nq: n's leading operand_bits + 1 bits. The result
// has `fraction` fraction bits.
template <class Int>
HWY_INLINE Int approximate(const ReciprocalFormats& f, const std::int64_t* table, Int nq, int& fraction) {
  const int operand = f.config.operand_bits;
  const Int rest = nq - (Int(1) << operand);
  const Int j = shifted_down(rest, operand - f.config.index_bits);
  switch (f.config.kind) {
    case ReciprocalKind::restoring:  // has no table
      unreachable();
    case ReciprocalKind::lut_linear: {
      const int t_bits = f.config.operand_bits > f.config.index_bits ? operand - f.config.index_bits : 0;
      const Int t = rest & ((Int(1) << t_bits) - Int(1));
      const Int c = entry_of(table, j);
      const Int y = (c << t_bits) - (c - Int(entry_of(table, j + Int(1)))) * t;
      fraction = f.config.internal_bits;
      return shifted_down(y, f.config.table_bits + t_bits - f.config.internal_bits);
    }
    case ReciprocalKind::lut_quadratic: {
      const int t_bits = f.config.operand_bits > f.config.index_bits ? operand - f.config.index_bits : 0;
      const Int t = rest & ((Int(1) << t_bits) - Int(1));
      const Int segments = Int(1) << f.config.index_bits;
      const Int c0 = entry_of(table, j);
      const Int c1 = entry_of(table, j + segments);
      const Int c2 = entry_of(table, j + segments + segments);
      const Int g =
          shifted_down((c1 << t_bits) - c2 * t, f.config.table_bits + t_bits - f.config.internal_bits);
      fraction = f.config.internal_bits;
      const int grid = std::max(f.config.table_bits, fraction + t_bits);
      const Int y = (c0 << (grid - f.config.table_bits)) - ((g * t) << (grid - fraction - t_bits));
      return shifted_down(y, grid - fraction);
    }
    case ReciprocalKind::lut_newton: {
      Int y = entry_of(table, j);
      fraction = f.config.table_bits;
      for (int i = 0; i < f.config.steps; ++i) {
        const Int a = shifted_down(nq * y, operand + fraction - f.config.internal_bits);
        y = shifted_down(y * ((Int(2) << f.config.internal_bits) - a), fraction);
        fraction = f.config.internal_bits;
      }
      return y;
    }
  }
  unreachable();
}

// Stands for m 2^-e.
template <class Value>
struct InverseOf {
  Value m, e;
};

// y one by one in 128 bits: units whose intermediates outgrow a lane.
template <class Int = int128>
HWY_NOINLINE Lanes approximate_wide(const ReciprocalFormats& f, const std::int64_t* table, Lanes d, Lanes top,
                                    int& fraction) {
  return by_lane([&](std::size_t i) HWY_ATTR {
    const Int nq = shifted_down(Int{lane(d, i)}, static_cast<int>(lane(top, i)) - f.config.operand_bits);
    return static_cast<std::int64_t>(approximate(f, table, nq, fraction));
  });
}

// 1 / (d 2^-fraction); d <= 0 is taken as 1.
template <class Watch>
HWY_INLINE InverseOf<Lanes> reciprocal(const ReciprocalFormats& f, const std::int64_t* table, Lanes d,
                                       int fraction, Watch watch) {
  d = max(d, Lanes(1));
  const Lanes top = top_bit(d);
  const Lanes exponent = top - Lanes(fraction);
  if (!has_table(f.config.kind)) {
    return f.config.normalize
               ? InverseOf<Lanes>{quantize_ratio(Lanes(1) << top, d, 0, f.output, watch), exponent}
               : InverseOf<Lanes>{quantize_ratio(Lanes(1), d, fraction, f.output, watch), Lanes(0)};
  }
  int y_fraction = 0;
  const Lanes y =
      f.fits_int64
          ? approximate(f, table, (d << (Lanes(62) - top)) >> (62 - f.config.operand_bits), y_fraction)
          : approximate_wide(f, table, d, top, y_fraction);
  if (f.config.normalize && f.output.fraction <= 61) {  // y < 2 has room on the output's grid
    return {quantize(y, y_fraction, f.output, watch), exponent};
  }
  if (f.config.normalize) {
    return {quantize(WideLanes(y), y_fraction, f.output, watch), exponent};
  }
  return {quantize(WideLanes(y), exponent + Lanes(y_fraction), f.output, watch), Lanes(0)};
}
// One integer: the unit's own function.
template <class Int, class Watch>
HWY_INLINE InverseOf<std::int64_t> reciprocal(const ReciprocalFormats& f, const std::int64_t* table, Int d,
                                              int fraction,
                                              Watch watch) requires(std::is_same_v<Int, std::int64_t> ||
                                                                    std::is_same_v<Int, int128>) {
  const Inverse out = model::reciprocal(f, table, d, fraction, watch);
  return {out.m, out.e};
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
