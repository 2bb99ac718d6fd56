// SPDX-License-Identifier: Apache-2.0
// Ramps: runs of acc = Q(acc + step) that add the same each time, so that value i is start + i increment.
//
// They do where the step brings no bits below the accumulator's, or where the mode rounds by those bits alone
// (at a tie some modes look at the value); and as long as nothing overflows, which the two ends of a run
// tell.
#include "model/numeric/adder.hpp"
#include "model/numeric/quantize-inl.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_RAMP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_RAMP_INL
#undef BITSPAN_MODEL_NUMERIC_RAMP_INL
#else
#define BITSPAN_MODEL_NUMERIC_RAMP_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

struct RampLanes {
  Lanes increment;
  Lanes::Mask linear;
};

// `steps` additions from start on, 0 <= steps < 2^steps_bits, steps_bits <= 30.
HWY_INLINE RampLanes make_ramp(const Adder& adder, Lanes start, Lanes step, Lanes steps, int steps_bits) {
  const auto yes = Lanes(0) == Lanes(0);
  if (!adder.fits_int64) return {Lanes(0), !yes};
  RampLanes ramp{step << adder.step_up, yes};
  if (adder.acc_up > 0) {
    const Lanes kept = step >> adder.acc_up;
    const Lanes dropped = step - (kept << adder.acc_up);
    switch (adder.acc.mode) {
      case Rounding::trn:
      case Rounding::rnd:
      case Rounding::rnd_min_inf:
        ramp.increment = rounded_shift(step, adder.acc_up, adder.acc.mode);
        break;
      case Rounding::rnd_zero:
      case Rounding::rnd_inf:
      case Rounding::rnd_conv:
        ramp.increment = rounded_shift(step, adder.acc_up, Rounding::rnd);
        ramp.linear = dropped != Lanes(std::int64_t{1} << (adder.acc_up - 1));
        break;
      case Rounding::trn_zero:
        ramp.increment = kept;
        ramp.linear = dropped == Lanes(0);
        break;
    }
  }
  const Lanes largest(std::int64_t{1} << (61 - steps_bits));
  const Lanes end = start + steps * ramp.increment;
  ramp.linear = ramp.linear & (ramp.increment < largest) & (ramp.increment > -largest) &
                (end >= Lanes(adder.acc.min)) & (end <= Lanes(adder.acc.max));
  return ramp;
}

// What observers see of a ramp of `steps` additions, without walking it.
inline void note_ramp(const Adder& adder, std::int64_t start, std::int64_t step, std::int64_t increment,
                      std::int64_t steps, Statistics& statistics) {
  if (steps < 1) return;
  FieldStatistics& s = statistics.fields[static_cast<std::size_t>(adder.acc.id)];
  const std::int64_t first = start + increment;
  const std::int64_t last = start + increment * steps;
  const std::int64_t low = std::min(first, last);
  const std::int64_t high = std::max(first, last);
  s.min = s.count == 0 ? low : std::min(s.min, low);
  s.max = s.count == 0 ? high : std::max(s.max, high);
  s.count += static_cast<std::uint64_t>(steps);
  if (adder.acc_up > 0) {
    const std::int64_t floor = step >> adder.acc_up;
    const std::int64_t dropped = step - (floor << adder.acc_up);
    const std::int64_t part = adder.acc_up >= bias_fraction ? dropped >> (adder.acc_up - bias_fraction)
                                                            : dropped << (bias_fraction - adder.acc_up);
    s.bias += steps * (((increment - floor) << bias_fraction) - part);
  }
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
