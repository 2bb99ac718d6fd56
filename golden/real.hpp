// SPDX-License-Identifier: Apache-2.0
// The floating-point types that golden computes in, behind one set of names, so that a stage is written once.
//
// Real is double (53 significant bits), long double (x87, 64) or Quad (113), or Checked<T> of one of these,
// which verifies by error-free transformations that every sum and product it forms is exact. What a stage
// writes with + - and * is exact, because its type was chosen so (golden/precision.hpp). What one Real may
// not hold is a Pair or an ExactSum: these carry the rounding error along, so that nothing is lost, and say
// so where it would be. Only a division rounds: its result is a candidate that its user corrects
// (golden/quantize.hpp).
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

// These are functions of GCC's libquadmath. They are declared here because its header is in GCC's own folder,
// which other tools do not search.
extern "C" {
__float128 floorq(__float128 x);
__float128 scalbnq(__float128 x, int e);
__float128 sqrtq(__float128 x);
__float128 expq(__float128 x);
}

namespace bitspan::golden {

using Quad = __float128;

// A sum or product that Checked found to be rounded: a defect of golden/precision.cpp, never bad input.
struct InexactError : std::logic_error {
  using std::logic_error::logic_error;
};
[[noreturn]] void throw_inexact(const char* what);
[[noreturn]] void throw_not_raw();

// a b - rounded for a built-in T and rounded = a * b: exact (Dekker), by Veltkamp's split of a and b into
// halves.
template <class T>
[[gnu::always_inline]] inline T product_error(T a, T b, T rounded) {
  constexpr double power = std::same_as<T, double> ? 0x1p27 : std::same_as<T, long double> ? 0x1p32 : 0x1p57;
  constexpr T factor = T(power) + 1;
  const T a_scaled = factor * a;
  const T a_high = a_scaled - (a_scaled - a);
  const T a_low = a - a_high;
  const T b_scaled = factor * b;
  const T b_high = b_scaled - (b_scaled - b);
  const T b_low = b - b_high;
  return ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

// a + b = sum + error, exactly (Knuth), for a built-in T.
template <class T>
struct TwoSum {
  T sum, error;
  TwoSum(T a, T b) : sum(a + b) {
    const T from_b = sum - a;
    error = (a - (sum - from_b)) + (b - from_b);
  }
};

template <class T>
class Checked {
 public:
  Checked() = default;
  // Implicit, as the built-in types are.
  Checked(T value) : value_(value) {}  // NOLINT(google-explicit-constructor)
  template <std::integral I>
  Checked(I value) : value_(static_cast<T>(value)) {  // NOLINT(google-explicit-constructor)
    if (static_cast<Quad>(value) != static_cast<Quad>(value_)) throw_inexact("conversion");
  }
  T base() const { return value_; }

  friend Checked operator+(Checked a, Checked b) {
    const TwoSum<T> both(a.value_, b.value_);
    if (both.error != 0) throw_inexact("sum");
    return both.sum;
  }
  friend Checked operator-(Checked a) { return -a.value_; }
  friend Checked operator-(Checked a, Checked b) { return a + -b; }
  friend Checked operator*(Checked a, Checked b) {
    const T product = a.value_ * b.value_;
    if (product_error(a.value_, b.value_, product) != 0) throw_inexact("product");
    return product;
  }
  // A candidate quotient, not exact.
  friend Checked operator/(Checked a, Checked b) { return a.value_ / b.value_; }
  Checked& operator+=(Checked b) { return *this = *this + b; }
  Checked& operator-=(Checked b) { return *this = *this - b; }
  friend bool operator==(Checked a, Checked b) { return a.value_ == b.value_; }
  friend bool operator!=(Checked a, Checked b) { return a.value_ != b.value_; }
  friend bool operator<(Checked a, Checked b) { return a.value_ < b.value_; }
  friend bool operator>(Checked a, Checked b) { return a.value_ > b.value_; }
  friend bool operator<=(Checked a, Checked b) { return a.value_ <= b.value_; }
  friend bool operator>=(Checked a, Checked b) { return a.value_ >= b.value_; }

 private:
  T value_ = 0;
};

// The built-in type behind Real, and its significant bits.
template <class Real>
struct RealTraits {
  using Base = Real;
  static constexpr bool checked = false;
};
template <class T>
struct RealTraits<Checked<T>> {
  using Base = T;
  static constexpr bool checked = true;
};
template <class Real>
inline constexpr int real_bits = std::same_as<typename RealTraits<Real>::Base, double>        ? 53
                                 : std::same_as<typename RealTraits<Real>::Base, long double> ? 64
                                                                                              : 113;

// The built-in value of a Real.
template <class T>
T base_of(T x) {
  return x;
}
template <class T>
T base_of(Checked<T> x) {
  return x.base();
}

// A value that one built-in T need not hold: high + low.
template <class T>
struct Pair {
  T high = 0, low = 0;
  Pair scaled(T power_of_two) const { return {high * power_of_two, low * power_of_two}; }
  Pair operator-() const { return {-high, -low}; }
};
template <class Real>
using PairOf = Pair<typename RealTraits<Real>::Base>;

template <class Real>
[[gnu::always_inline]] inline PairOf<Real> exact_product(Real a, Real b) {
  const auto high = base_of(a) * base_of(b);
  return {high, product_error(base_of(a), base_of(b), high)};
}

// A sum of terms of any sizes as a Pair, with a word on whether the Pair holds all of it.
template <class T>
class ExactSum {
 public:
  explicit ExactSum(T x) : value_{x, 0} {}
  explicit ExactSum(const Pair<T>& x) : value_(x) {}
  [[gnu::always_inline]] ExactSum& add(T x) {
    const TwoSum<T> high(value_.high, x);
    const TwoSum<T> low(value_.low, high.error);
    value_ = {high.sum, low.sum};
    lost_ |= low.error != 0;
    return *this;
  }
  ExactSum& add(const Pair<T>& x) { return add(x.high).add(x.low); }
  // high is the sum rounded to T, low what that leaves out.
  Pair<T> get() const {
    const TwoSum<T> both(value_.high, value_.low);
    return {both.sum, both.error};
  }
  bool exact() const { return !lost_; }

 private:
  Pair<T> value_;
  bool lost_ = false;
};

// floor of an x that is small enough to have a fraction, |x| < 2^51 for double and 2^62 for long double:
// adding 1.5 * 2^(p-1) leaves no room for one.
[[gnu::always_inline]] inline double floor_of_small(double x) {
  constexpr double no_fraction = 0x1.8p52;
  const double nearest = (x + no_fraction) - no_fraction;
  return nearest - (nearest > x ? 1.0 : 0.0);
}
inline long double floor_of_small(long double x) {
  constexpr long double no_fraction = 0x1.8p63L;
  const long double nearest = (x + no_fraction) - no_fraction;
  return nearest - (nearest > x ? 1.0L : 0.0L);
}
inline Quad floor_of_small(Quad x) { return floorq(x); }
// The bound of floor_of_small, and of what Quantizer rounds without a second look.
template <class T>
inline constexpr T small_limit = T(0x1p111);
template <>
inline constexpr double small_limit<double> = 0x1p51;
template <>
inline constexpr long double small_limit<long double> = 0x1p62L;

template <class T>
T magnitude(T x) {
  return x < 0 ? -x : x;
}
inline double magnitude(double x) { return std::fabs(x); }

[[gnu::always_inline]] inline double floor_of(double x) {
  return magnitude(x) < small_limit<double> ? floor_of_small(x) : std::floor(x);
}
inline long double floor_of(long double x) {
  return magnitude(x) < small_limit<long double> ? floor_of_small(x) : std::floor(x);
}
inline Quad floor_of(Quad x) { return floorq(x); }
template <class T>
Checked<T> floor_of(Checked<T> x) {
  return floor_of(x.base());
}

// floor(log2 x) of a normal x > 0.
inline int exponent_of(double x) {
  return static_cast<int>((std::bit_cast<std::uint64_t>(x) >> 52) & 0x7ff) - 1023;
}
inline int exponent_of(long double x) {
  std::uint16_t top = 0;
  std::memcpy(&top, reinterpret_cast<const char*>(&x) + 8, sizeof top);
  return (top & 0x7fff) - 16383;
}
inline int exponent_of(Quad x) {
  std::uint16_t top = 0;
  std::memcpy(&top, reinterpret_cast<const char*>(&x) + 14, sizeof top);
  return (top & 0x7fff) - 16383;
}
template <class T>
int exponent_of(Checked<T> x) {
  return exponent_of(x.base());
}

// 2^e, |e| <= 1022.
template <class Real>
Real pow2(int e) {
  return Real(std::bit_cast<double>(static_cast<std::uint64_t>(1023 + e) << 52));
}

// An integer-valued x as an integer; throws std::logic_error where x is none, or not of 64 bits.
template <class T>
[[gnu::always_inline]] inline std::int64_t to_integer(T x) {
  if (!(x >= -0x1p63 && x < 0x1p63)) [[unlikely]]
    throw_not_raw();
  const auto integer = static_cast<std::int64_t>(x);
  if (static_cast<T>(integer) != x) [[unlikely]]
    throw_not_raw();
  return integer;
}
// Reads the significand: the x87 would change its rounding mode twice.
inline std::int64_t to_integer(long double x) {
  std::uint64_t significand = 0;
  std::memcpy(&significand, &x, sizeof significand);
  if (significand == 0) return 0;
  const int shift = 63 - exponent_of(x);
  if (x == -0x1p63L) return std::numeric_limits<std::int64_t>::min();
  if (shift < 1 || shift > 63 || (significand << 1 << (63 - shift)) != 0) throw_not_raw();
  const auto magnitude = static_cast<std::int64_t>(significand >> shift);
  return x < 0 ? -magnitude : magnitude;
}
template <class T>
std::int64_t to_integer(Checked<T> x) {
  return to_integer(x.base());
}

// The nearest double, for the frame's dumps only.
template <class T>
double to_double(T x) {
  return static_cast<double>(x);
}
template <class T>
double to_double(Checked<T> x) {
  return static_cast<double>(x.base());
}

}  // namespace bitspan::golden
