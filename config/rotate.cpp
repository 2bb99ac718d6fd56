// SPDX-License-Identifier: Apache-2.0
#include "config/rotate.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace bitspan {
namespace {

// Of one rounding: half an ulp, or nearly one.
double rotate_rounding(const Format& f) {
  const bool is_cut = f.rounding == Rounding::trn || f.rounding == Rounding::trn_zero;
  return std::ldexp(is_cut ? 1.0 : 0.5, -f.fraction());
}

}  // namespace

RotateFormats rotate_formats(const Config& config) {
  return {config.format(FormatId::rotate_t), config.format(FormatId::rotate_s),
          config.format(FormatId::rotate_xy)};
}

void check_rotate(const RotateFormats& formats, int turn) {
  if (turn < 8 || turn > turn_limit || turn % 8 != 0) {
    throw InputError("rotate: " + std::to_string(turn) +
                     " steps in a turn are not legal; expected a multiple of 8, 8.." +
                     std::to_string(turn_limit));
  }
  // Golden's widest numbers have 113 bits.
  constexpr int product_limit = 112;
  for (const auto& [format, id] :
       {std::pair{&formats.t, FormatId::rotate_t}, std::pair{&formats.s, FormatId::rotate_s}}) {
    const std::string key = "formats." + std::string(key_of(id));
    if (!format->is_signed || format->integer < 1 || format->fraction() < 0 || format->fraction() > 60) {
      throw InputError(key + " is not legal; expected signed, int 1 or more, 0..60 fraction bits");
    }
    if (format->word + formats.xy.word > product_limit) {
      throw InputError(key + " and formats.rotate.xy have " + std::to_string(format->word + formats.xy.word) +
                       " bits together; legal: at most " + std::to_string(product_limit));
    }
  }
  if (!formats.xy.is_signed) throw InputError("formats.rotate.xy is unsigned; expected a sign");
}

double rotate_error_bound(const RotateFormats& formats, double length) {
  // Of 45 degrees: tan(a / 2), sin a, and how much longer x - t y may be than the vector; all rounded up.
  constexpr double t = 0.41422, s = 0.70711, longer = 1.0824;
  const double q = rotate_rounding(formats.xy);
  const double of_t = rotate_rounding(formats.t);
  const double of_s = rotate_rounding(formats.s);
  const double first = q + of_t * length;
  const double y = q + of_s * (longer * length + first) + s * first;
  const double x = first + q + of_t * (length + y) + t * y;
  return std::max(x, y);  // quarters behind the products exchange the two
}

}  // namespace bitspan
