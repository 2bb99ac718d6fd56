// SPDX-License-Identifier: Apache-2.0
#include "golden/rotate.hpp"

#include "golden/quantize.hpp"

extern "C" {
__float128 sinq(__float128 x);
__float128 cosq(__float128 x);
__float128 acosq(__float128 x);
}

namespace bitspan::golden {

Rotation::Rotation(const RotateFormats& formats, int turn) : formats_(formats), turn_(turn) {
  check_rotate(formats, turn);
  const Quad pi = acosq(-1);
  const Quantizer<Quad> t(formats.t);
  const Quantizer<Quad> s(formats.s);
  for (int step = 0; step <= turn / 8; ++step) {
    const Quad angle = 2 * pi * step / turn;
    // tan(a / 2) = sin a / (1 + cos a). A twelfth of a turn has the one sine that is rational.
    const Quad sine = 12 * step == turn ? Quad(0.5) : sinq(angle);
    tangents_.push_back(t.raw(t(step == 0 ? Quad(0) : sinq(angle) / (1 + cosq(angle)))));
    sines_.push_back(s.raw(s(sine)));
  }
}

PlaneVector Rotation::operator()(PlaneVector vector, int angle) const {
  const Quantizer<Quad> q(formats_.xy);
  const AngleParts parts = angle_parts(angle, turn_);
  const auto size = static_cast<std::size_t>(parts.rest < 0 ? -parts.rest : parts.rest);
  const Quad sign = parts.rest < 0 ? -1 : 1;
  const Quad t = sign * Quad(tangents_[size]) * pow2<Quad>(-formats_.t.fraction());
  const Quad s = sign * Quad(sines_[size]) * pow2<Quad>(-formats_.s.fraction());
  Quad x = q.value(vector.x);
  Quad y = q.value(vector.y);
  const auto turn_quarters = [&] {
    const Quad old = x;
    switch (parts.quarter) {
      case 1:
        x = q(-y);
        y = old;
        return;
      case -1:
        x = y;
        y = q(-old);
        return;
      case 2:
      case -2:
        x = q(-x);
        y = q(-y);
        return;
      default:
        return;
    }
  };
  if (angle > 0) turn_quarters();
  x = q.sum(x, -q.product(t, y));
  y = q.sum(y, q.product(s, x));
  x = q.sum(x, -q.product(t, y));
  if (angle < 0) turn_quarters();
  return {q.raw(x), q.raw(y)};
}

}  // namespace bitspan::golden
