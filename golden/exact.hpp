// SPDX-License-Identifier: Apache-2.0
// Exact numbers of the oracles: integers of any size, numbers that know how far off they are, and the grid
// that all distances of a scene lie on.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "golden/oracle.hpp"

namespace bitspan::golden {

// Of any size; up to 512 bits without an allocation.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked,
                                           std::allocator<boost::multiprecision::limb_type>>,
    boost::multiprecision::et_off>;

// A number that is off by no more than `error`. Such numbers decide almost all signs. Where the error leaves
// a sign open, integers decide.
struct Approx {
  double value = 0, error = 0;
};
// The rounding of `value` loses at most half of what is added here. The other half, and the factor, cover the
// roundings of the error itself.
inline Approx rounded(double value, double error) {
  return {value, error * (1 + 0x1p-48) + 0x1p-52 * std::abs(value) + std::numeric_limits<double>::min()};
}
inline Approx operator+(Approx a, Approx b) { return rounded(a.value + b.value, a.error + b.error); }
inline Approx operator-(Approx a, Approx b) { return rounded(a.value - b.value, a.error + b.error); }
inline Approx operator*(Approx a, Approx b) {
  return rounded(a.value * b.value,
                 std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error);
}
inline Approx abs(Approx a) { return {std::abs(a.value), a.error}; }

// -1, 0 or 1; none where the error leaves it open.
inline std::optional<int> sign_of(const Integer& a) { return a.sign(); }
inline std::optional<int> sign_of(Approx a) {
  if (!(std::abs(a.value) > a.error)) return std::nullopt;
  return a.value > 0 ? 1 : -1;
}

// The whole numbers m with s = m 2^grid, for distances that lie on that grid.
class DistanceGrid {
 public:
  explicit DistanceGrid(std::span<const OracleFace> faces) {
    for (const OracleFace& face : faces) {
      for (const IdealTriangle::Corner& corner : face.shape.v) {
        const auto [mantissa, exponent] = parts_of(corner.s);
        lowest_ = std::min(lowest_, exponent + std::countr_zero(mantissa));
        highest_ = std::max(highest_, exponent + 64);
      }
    }
  }
  Integer whole(long double s) const {
    const auto [mantissa, exponent] = parts_of(s);
    Integer out = mantissa >> std::max(lowest_ - exponent, 0);
    out <<= std::max(exponent - lowest_, 0);
    return out;
  }
  // s in a unit in which the largest lies in 1/2..1.
  double scaled(long double s) const { return static_cast<double>(std::ldexp(s, -highest_)); }
  // 1/s of one step of the grid times q, which is in units of that 1/s.
  long double inverse(long double q) const { return std::ldexp(q, -lowest_); }

 private:
  // s = mantissa 2^exponent.
  static std::pair<std::uint64_t, int> parts_of(long double s) {
    int exponent = 0;
    const long double mantissa = std::ldexp(std::frexp(s, &exponent), 64);
    return {static_cast<std::uint64_t>(mantissa), exponent - 64};
  }
  int lowest_ = std::numeric_limits<int>::max();
  int highest_ = std::numeric_limits<int>::min();
};

// 1/S over the picture is a plane: (x a + y b + c) / d at the centre of pixel (x, y), in units of the grid's
// 1/s. d is positive.
struct InversePlane {
  Integer a, b, c, d;
};
inline InversePlane inverse_plane(const IdealTriangle& t, const DistanceGrid& grid) {
  std::array<Integer, 3> s;
  for (std::size_t i = 0; i < 3; ++i) s[i] = grid.whole(t.v[i].s);
  const auto at = [&](std::int64_t x, std::int64_t y) {
    const Areas areas = areas_at(t, centre_of(t, x, y));
    Integer sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += Integer(areas.part[i]) * s[(i + 1) % 3] * s[(i + 2) % 3];
    return sum;
  };
  InversePlane out;
  out.c = at(0, 0);
  out.a = at(1, 0) - out.c;
  out.b = at(0, 1) - out.c;
  out.d = Integer(areas_at(t, centre_of(t, 0, 0)).whole) * s[0] * s[1] * s[2];
  if (out.d < 0) out = {-out.a, -out.b, -out.c, -out.d};
  return out;
}

}  // namespace bitspan::golden
