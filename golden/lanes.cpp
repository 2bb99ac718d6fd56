// SPDX-License-Identifier: Apache-2.0
#include "golden/lanes.hpp"

#include <bit>

#include "golden/real.hpp"

namespace bitspan::golden {

namespace {

// Each loop is compiled for several kinds of vectors and picked when the program is loaded, which happens
// before the sanitizers are ready for it.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define BITSPAN_LANES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BITSPAN_LANES
#endif
// `ivdep` before each of them: a lane reads its own place only, so `out` may be one of the operands. Clang
// does not know the pragma.
#ifdef __clang__
#pragma clang diagnostic ignored "-Wunknown-pragmas"
#endif

struct Rounded {
  double whole;
  std::int64_t bad;
};

// high + low in ulps; high is the sum rounded.
[[gnu::always_inline]] inline Rounded narrow(double high, double low, const LaneFormat& q) {
  double whole = floor_of_small(high);
  whole -= whole == high && low < 0 ? 1.0 : 0.0;
  const double middle = whole + 0.5;
  const double at_tie = whole < 0 ? q.tie_below : q.tie;
  const double by_low = low > 0 ? q.above : low < 0 ? 0.0 : at_tie;
  whole += high > middle ? q.above : high == middle ? by_low : 0.0;
  const double low_end = whole < q.min ? q.min : whole;
  const double kept = low_end > q.max ? q.max : low_end;
  const std::int64_t outside = kept == whole ? 0 : q.strict;
  const std::int64_t small = magnitude(high) < small_limit<double> ? 0 : 1;
  return {kept, outside | small};
}

[[gnu::always_inline]] inline double floor_scaled(double x, double scale, double ulp) {
  return floor_of_small(x * scale) * ulp;
}

}  // namespace

LaneFormat::LaneFormat(const Format& format) {
  const int magnitude_bits = format.is_signed ? format.word - 1 : format.word;
  usable =
      format.rounding != Rounding::rnd_conv && format.rounding != Rounding::trn_zero && magnitude_bits <= 50;
  const Rounding mode = format.rounding;
  above = mode == Rounding::trn ? 0 : 1;
  tie = mode == Rounding::rnd || mode == Rounding::rnd_inf ? 1 : 0;
  tie_below = mode == Rounding::rnd || mode == Rounding::rnd_zero ? 1 : 0;
  if (!usable) return;
  max = pow2<double>(magnitude_bits) - 1;
  min = !format.is_signed ? 0 : format.overflow == Overflow::sat_sym ? -max : -max - 1;
  strict = format.overflow == Overflow::sat || format.overflow == Overflow::sat_sym ? 0 : 1;
}

BITSPAN_LANES std::int64_t lanes_narrow(const Column& x, double scale, const LaneFormat& format,
                                        std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const Rounded r = narrow(x.at[i] * scale, 0, q);
    out.at[i] = r.whole;
    bad += r.bad;
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_less(double constant, const Column& x, double scale,
                                             const LaneFormat& format, std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const TwoSum<double> sum(constant, -(x.at[i] * scale));
    const Rounded r = narrow(sum.sum, sum.error, q);
    out.at[i] = r.whole;
    bad += r.bad;
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_product(const Column& a, const Column& b, const Column& scales,
                                                double scale, const Column& c, double c_scale,
                                                const LaneFormat& format, std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double shift = scales.at[i] * scale;
    const double rounded = a.at[i] * b.at[i];
    const double rest = product_error(a.at[i], b.at[i], rounded) * shift;
    const TwoSum<double> high(rounded * shift, c.at[i] * c_scale);
    const TwoSum<double> low(rest, high.error);
    const TwoSum<double> both(high.sum, low.sum);
    const Rounded r = narrow(both.sum, both.error, q);
    out.at[i] = r.whole;
    bad += r.bad | (low.error == 0 ? 0 : 1);
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_short(const Column& a, const Column& b, double scale,
                                              const LaneFormat& format, std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const Rounded r = narrow(a.at[i] * b.at[i] * scale, 0, q);
    out.at[i] = r.whole;
    bad += r.bad;
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_mix(const Column& from, const Column& to, const Column& share,
                                            double scale, const LaneFormat& format, std::size_t n,
                                            Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const TwoSum<double> sum(from.at[i] * (1 - share.at[i]) * scale, to.at[i] * share.at[i] * scale);
    const Rounded r = narrow(sum.sum, sum.error, q);
    out.at[i] = r.whole;
    bad += r.bad;
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_toward(const Column& base, const Column& x, const Column& share,
                                               double share_ulp, double whole, double scale,
                                               const LaneFormat& format, std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double part = (x.at[i] - base.at[i]) * (share.at[i] * share_ulp) * scale;
    const TwoSum<double> sum(base.at[i] * scale, part);
    const bool all = share.at[i] >= whole;
    const Rounded r = narrow(all ? x.at[i] * scale : sum.sum, all ? 0.0 : sum.error, q);
    out.at[i] = r.whole;
    bad += r.bad;
  }
  return bad;
}

BITSPAN_LANES std::int64_t lanes_narrow_quotient(const Column& a, const Column& d, double scale,
                                                 const LaneFormat& format, std::size_t n, Column& out) {
  const LaneFormat q = format;
  std::int64_t bad = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double top = a.at[i] * scale;
    const double bottom = d.at[i];
    const double candidate = top / bottom;
    double whole = floor_of_small(candidate);
    const double back = whole * bottom;
    const double back_low = product_error(whole, bottom, back);
    const TwoSum<double> high(top, -back);
    const TwoSum<double> both(high.sum, -back_low);
    const double step = both.sum < 0 ? -1.0 : both.sum >= bottom ? 1.0 : 0.0;
    const double rest = both.sum - step * bottom;
    whole += step;
    const double twice = rest + rest;
    const double at_tie = whole < 0 ? q.tie_below : q.tie;
    whole += twice > bottom ? q.above : twice == bottom ? at_tie : 0.0;
    const double low_end = whole < q.min ? q.min : whole;
    const double kept = low_end > q.max ? q.max : low_end;
    out.at[i] = kept;
    const std::int64_t outside = kept == whole ? 0 : q.strict;
    const std::int64_t small = magnitude(candidate) < small_limit<double> ? 0 : 1;
    const std::int64_t lost = high.error == 0 && both.error == 0 ? 0 : 1;
    bad += outside | small | lost;
  }
  return bad;
}

BITSPAN_LANES void lanes_operand(const Column& x, double slope, double constant, double least, std::size_t n,
                                 Column& out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double d = x.at[i] * slope + constant;
    out.at[i] = d > 0 ? d : least;
  }
}

BITSPAN_LANES void lanes_split(const Column& d, std::size_t n, Column& m, Column& inverse_power,
                               std::int64_t* e) {
  constexpr std::uint64_t significand = (std::uint64_t{1} << 52) - 1;
  constexpr std::uint64_t one = std::uint64_t{1023} << 52;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const auto bits = std::bit_cast<std::uint64_t>(d.at[i]);
    const std::uint64_t biased = bits & ~significand;
    m.at[i] = std::bit_cast<double>((bits & significand) | one);
    inverse_power.at[i] = std::bit_cast<double>(2 * one - biased);
    e[i] = static_cast<std::int64_t>(biased >> 52) - 1023;
  }
}

BITSPAN_LANES void lanes_cut(const Column& x, double scale, double ulp, std::size_t n, Column& out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) out.at[i] = floor_scaled(x.at[i], scale, ulp);
}

BITSPAN_LANES void lanes_position(const Column& x, double scale, std::size_t n, Column& out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) out.at[i] = (x.at[i] - 1) * scale;
}

BITSPAN_LANES void lanes_newton(const Column& nq, double scale, double ulp, std::size_t n, Column& y) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double a = floor_scaled(nq.at[i] * y.at[i], scale, ulp);
    y.at[i] = floor_scaled(y.at[i] * (2 - a), scale, ulp);
  }
}

}  // namespace bitspan::golden
