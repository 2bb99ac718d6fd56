// SPDX-License-Identifier: Apache-2.0
#include "golden/forward_difference.hpp"

#include <algorithm>
#include <cstdlib>

#include "golden/with_real.hpp"

namespace bitspan::golden {
namespace {

// The narrowest number that holds every register, and the coefficients times 6.
Width width_of(const CurveFormats& formats, const CurveCoefficients& curve) {
  int bits = 0;
  for (const Format& f : formats) bits = std::max(bits, f.word);
  for (const std::int64_t c : curve.power)
    bits = std::max(bits, c == 0 ? 0 : exponent_of(Quad(c < 0 ? -Quad(c) : Quad(c))) + 4);
  return bits <= real_bits<double> ? Width::f64 : bits <= real_bits<long double> ? Width::x87 : Width::quad;
}

}  // namespace

std::vector<CurveRegisters> forward_difference(const CurveFormats& formats, const CurveCoefficients& curve,
                                               int k) {
  check_curve(formats, curve.fraction, k);
  return with_real({width_of(formats, curve), false}, [&]<class Real>() {
    const ForwardDifference<Real> unit(formats, k);
    std::array<Real, 4> power;
    for (std::size_t i = 0; i < power.size(); ++i) {
      power[i] = Real(curve.power[i]) * pow2<Real>(-curve.fraction);
    }
    std::array<Real, 4> d = unit.start(power);
    std::vector<CurveRegisters> out{unit.raw(d)};
    for (int n = 0; n < 1 << k; ++n) {
      unit.advance(d);
      out.push_back(unit.raw(d));
    }
    return out;
  });
}

}  // namespace bitspan::golden
