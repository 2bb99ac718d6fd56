// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of golden/: exact rationals as an oracle for Q, and random scenes and configurations.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>
#include <string>

#include "config/config.hpp"
#include "golden/real.hpp"
#include "scene/scene.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::test {

using Int = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

inline Int power_of_two(int e) { return Int(1) << static_cast<unsigned>(e); }
inline Rational scale(const Rational& x, int e) {
  return e >= 0 ? x * Rational(power_of_two(e)) : x / Rational(power_of_two(-e));
}
inline Int floor_of(const Rational& x) {
  const Int n = numerator(x);
  const Int d = denominator(x);
  Int q = n / d;
  if (n < 0 && q * d != n) --q;
  return q;
}
inline Int modulo(const Int& n, const Int& m) {
  const Int rest = n % m;
  return rest < 0 ? rest + m : rest;
}

// Q of docs/numeric-spec.md on rationals, in raw units; written from SystemC's definitions, by case of the
// tie.
inline Int rounded(const Rational& x, Rounding mode) {
  const Rational half(1, 2);
  const Int low = floor_of(x);
  const Rational rest = x - Rational(low);
  const Int nearest_up = floor_of(x + half);
  const bool tie = rest == half;
  switch (mode) {
    case Rounding::trn:
      return low;
    case Rounding::trn_zero:
      return x < 0 ? Int(-floor_of(-x)) : low;
    case Rounding::rnd:
      return nearest_up;
    case Rounding::rnd_zero:
      return tie ? (x < 0 ? Int(low + 1) : low) : nearest_up;
    case Rounding::rnd_min_inf:
      return tie ? low : nearest_up;
    case Rounding::rnd_inf:
      return tie ? (x < 0 ? low : Int(low + 1)) : nearest_up;
    case Rounding::rnd_conv:
      return tie ? (low % 2 == 0 ? low : Int(low + 1)) : nearest_up;
  }
  return 0;
}
inline Int fitted(const Int& n, const Format& f) {
  const unsigned word = static_cast<unsigned>(f.word);
  const Int top = power_of_two(f.is_signed ? f.word - 1 : f.word) - 1;
  const Int bottom = f.is_signed ? Int(-top - 1) : Int(0);
  if (f.overflow == Overflow::sat_sym && f.is_signed && n == bottom) return -top;
  if (n >= bottom && n <= top) return n;
  switch (f.overflow) {
    case Overflow::sat:
      return n < bottom ? bottom : top;
    case Overflow::sat_sym:
      return n < bottom ? (f.is_signed ? Int(-top) : Int(0)) : top;
    case Overflow::sat_zero:
      return 0;
    case Overflow::wrap: {
      const Int low = modulo(n, power_of_two(f.word));
      return low > top ? Int(low - power_of_two(f.word)) : low;
    }
    case Overflow::wrap_sm: {
      const Int bits = modulo(n, power_of_two(f.word + 1));
      const bool above = bit_test(bits, word);
      const bool old_sign = bit_test(bits, word - 1);
      const Int mask = power_of_two(f.word - 1) - 1;
      Int low = bits & mask;
      if (above != old_sign) low ^= mask;
      return above ? Int(low - power_of_two(f.word - 1)) : low;
    }
  }
  return 0;
}
inline Int oracle_raw(const Format& f, const Rational& x) {
  return fitted(rounded(scale(x, f.fraction()), f.rounding), f);
}
inline Rational oracle_q(const Format& f, const Rational& x) {
  return scale(Rational(oracle_raw(f, x)), -f.fraction());
}
inline Rational value_of(const Format& f, std::int64_t raw) {
  return scale(Rational(Int(raw)), -f.fraction());
}

// An exact rational of a double.
inline Rational rational_of(double x) {
  int e = 0;
  const double m = std::frexp(x, &e);
  return scale(Rational(Int(static_cast<std::int64_t>(std::ldexp(m, 53)))), e - 53);
}

// A random source with the few draws the tests need; each test names its seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(engine_);
  }
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  bool flip() { return integer(0, 1) == 1; }
  // A signed integer of up to `bits` bits, small ones and ones near powers of two being frequent.
  __int128 wide_integer(int bits) {
    const int used = static_cast<int>(integer(1, bits));
    __int128 out = 0;
    for (int i = 0; i < used; i += 32) out = (out << 32) + static_cast<__int128>(integer(0, 0xffffffffLL));
    const auto mask = static_cast<__int128>((static_cast<unsigned __int128>(1) << used) - 1);
    out &= mask;
    const std::int64_t kind = integer(0, 7);
    if (kind == 0) out = mask;
    if (kind == 1) out = (mask >> 1) + 1;
    return flip() ? -out : out;
  }

 private:
  std::mt19937_64 engine_;
};

inline Int int_of(__int128 x) {
  const bool negative = x < 0;
  const auto magnitude = static_cast<unsigned __int128>(negative ? -x : x);
  const Int out =
      (Int(static_cast<std::uint64_t>(magnitude >> 64)) << 64) + static_cast<std::uint64_t>(magnitude);
  return negative ? Int(-out) : out;
}

inline Scene test_scene(int width = 96, int height = 80) {
  Scene scene;
  scene.width = width;
  scene.height = height;
  scene.s_min = 1;
  scene.s_max = 200;
  scene.focal = 70;
  scene.background = {10, 20, 30};
  scene.fog = Fog{{90, 120, 200}, 60};
  Texture texture;
  texture.width = 8;
  texture.height = 4;
  for (int i = 0; i < 8 * 4 * 4; ++i) texture.rgba.push_back(static_cast<std::uint8_t>((i * 37 + 11) % 256));
  scene.textures.push_back(texture);
  return scene;
}

inline Vertex random_vertex(Draw& draw, const Scene& scene, double margin, double spread, double cx,
                            double cy) {
  Vertex out;
  out.x = std::fmin(std::fmax(cx + draw.real(-spread, spread), -margin), scene.width + margin);
  out.y = std::fmin(std::fmax(cy + draw.real(-spread, spread), -margin), scene.height + margin);
  if (draw.integer(0, 3) == 0) out.x = std::floor(out.x) + 0.5;  // through pixel centres
  if (draw.integer(0, 3) == 0) out.y = std::floor(out.y) + 0.5;
  out.s = draw.real(scene.s_min, scene.s_max);
  if (draw.integer(0, 9) == 0) out.s = scene.s_min;
  if (draw.integer(0, 9) == 0) out.s = scene.s_max;
  out.u = draw.real(-30, 60);
  out.v = draw.real(-30, 60);
  for (double& c : out.c) c = draw.integer(0, 4) == 0 ? 1.0 : draw.real(0, 1);
  return out;
}

inline Triangle random_triangle(Draw& draw, const Scene& scene) {
  const double spread = std::exp2(draw.real(-1, 7));
  const double cx = draw.real(0, scene.width);
  const double cy = draw.real(0, scene.height);
  Triangle out;
  for (Vertex& v : out.v) v = random_vertex(draw, scene, 40, spread, cx, cy);
  out.texture = draw.integer(0, 4) == 0 ? -1 : 0;
  return out;
}

}  // namespace bitspan::test
