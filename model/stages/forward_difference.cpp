// SPDX-License-Identifier: Apache-2.0
#include "model/stages/forward_difference.hpp"

#include "model/numeric/quantize.hpp"

namespace bitspan::model {

ForwardDifferenceStage prepare_forward_difference(const CurveFormats& formats, int fraction, int k) {
  check_curve(formats, fraction, k);
  ForwardDifferenceStage stage;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    stage.d[i] =
        make_register(formats[i], static_cast<RegisterId>(static_cast<std::size_t>(FormatId::curve_d0) + i));
  }
  stage.k = k;
  return stage;
}

CurveRegisters start_curve(const ForwardDifferenceStage& stage, const CurveCoefficients& curve) {
  // t in steps: t^i is a power of two of its coefficient.
  const auto term = [&](std::size_t i) {
    return Exact{curve.power[i], curve.fraction + static_cast<int>(i) * stage.k};
  };
  const Exact six_a{term(3).raw * 6, term(3).fraction};
  const Exact two_b{term(2).raw * 2, term(2).fraction};
  const std::array<Exact, 4> start{term(0), term(1) + term(2) + term(3), six_a + two_b, six_a};
  CurveRegisters d;
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = quantize(start[i], stage.d[i], NoObserve{});
  return d;
}

void forward_difference(const ForwardDifferenceStage& stage, CurveRegisters& d) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Exact sum = value_of(d[i], stage.d[i]) + value_of(d[i + 1], stage.d[i + 1]);
    d[i] = quantize(sum, stage.d[i], NoObserve{});
  }
}

}  // namespace bitspan::model
