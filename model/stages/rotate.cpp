// SPDX-License-Identifier: Apache-2.0
#include "model/stages/rotate.hpp"

#include <mpfr.h>

#include "model/numeric/quantize.hpp"

namespace bitspan::model {
namespace {

// A number of MPFR's, enough for any register here.
struct RotateReal {
  mpfr_t x;
  RotateReal() { mpfr_init2(x, 256); }
  ~RotateReal() { mpfr_clear(x); }
  RotateReal(const RotateReal&) = delete;
  RotateReal& operator=(const RotateReal&) = delete;
};

// x, 0 < x < 1 and no binary fraction, rounded into a register: its bits as far as the guard bit, and a last
// bit for all below.
std::int64_t into_register(RotateReal& x, const Register& r) {
  mpfr_mul_2si(x.x, x.x, r.fraction + 1, MPFR_RNDN);
  const std::int64_t floor = mpfr_get_si(x.x, MPFR_RNDD);
  return quantize(Exact{int128{floor} * 2 + 1, r.fraction + 2}, r, NoObserve{});
}

PlaneVector quarters(const RotateStage& stage, PlaneVector v, int quarter) {
  const auto negative = [&](std::int64_t raw) {
    return quantize(-value_of(raw, stage.xy), stage.xy, NoObserve{});
  };
  switch (quarter) {
    case 1:
      return {negative(v.y), v.x};
    case -1:
      return {v.y, negative(v.x)};
    case 2:
    case -2:
      return {negative(v.x), negative(v.y)};
    default:
      return v;
  }
}

}  // namespace

RotateStage prepare_rotate(const RotateFormats& formats, int turn) {
  check_rotate(formats, turn);
  RotateStage stage;
  stage.turn = turn;
  stage.t = make_register(formats.t, id_of(FormatId::rotate_t));
  stage.s = make_register(formats.s, id_of(FormatId::rotate_s));
  stage.xy = make_register(formats.xy, id_of(FormatId::rotate_xy));
  stage.tangents.push_back(0);
  stage.sines.push_back(0);
  RotateReal half, x;
  for (int step = 1; step <= turn / 8; ++step) {
    mpfr_const_pi(half.x, MPFR_RNDN);
    mpfr_mul_si(half.x, half.x, step, MPFR_RNDN);
    mpfr_div_si(half.x, half.x, turn, MPFR_RNDN);
    mpfr_tan(x.x, half.x, MPFR_RNDN);
    stage.tangents.push_back(into_register(x, stage.t));
    mpfr_mul_si(half.x, half.x, 2, MPFR_RNDN);
    mpfr_sin(x.x, half.x, MPFR_RNDN);
    // Of a twelfth of a turn: the one sine here that is a binary fraction.
    stage.sines.push_back(12 * step == turn ? quantize(Exact{1, 1}, stage.s, NoObserve{})
                                            : into_register(x, stage.s));
  }
  return stage;
}

RotateOperands rotate_operands(const RotateStage& stage, int angle) {
  const auto [quarter, rest] = angle_parts(angle, stage.turn);
  const auto size = static_cast<std::size_t>(rest < 0 ? -rest : rest);
  const int sign = rest < 0 ? -1 : 1;
  return {quarter, angle >= 0, sign * stage.tangents[size], sign * stage.sines[size]};
}

PlaneVector rotate(const RotateStage& stage, PlaneVector v, const RotateOperands& by) {
  const auto kept = [&](Exact x) { return quantize(x, stage.xy, NoObserve{}); };
  const auto at = [&](std::int64_t raw) { return value_of(raw, stage.xy); };
  if (by.is_first) v = quarters(stage, v, by.quarter);
  v.x = kept(at(v.x) - at(kept(value_of(by.t, stage.t) * at(v.y))));
  v.y = kept(at(v.y) + at(kept(value_of(by.s, stage.s) * at(v.x))));
  v.x = kept(at(v.x) - at(kept(value_of(by.t, stage.t) * at(v.y))));
  return by.is_first ? v : quarters(stage, v, by.quarter);
}

}  // namespace bitspan::model
