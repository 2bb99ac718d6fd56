// SPDX-License-Identifier: Apache-2.0
#include "config/curve.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace bitspan {
namespace {

constexpr std::array<FormatId, 4> curve_registers{FormatId::curve_d0, FormatId::curve_d1, FormatId::curve_d2,
                                                  FormatId::curve_d3};
constexpr std::array<std::string_view, 4> curve_words{"the points", "the first differences",
                                                      "the second differences", "the third difference"};
// Golden's widest numbers have 113 bits; a sum has one more than its terms.
constexpr int curve_sum_limit = 112;

// Fraction bits of the exact starting values: of 6 a d^3 the 2 is a bit less.
std::array<int, 4> start_fractions(int fraction, int k) {
  const int low = k == 0 ? fraction : fraction + 3 * k - 1;
  return {fraction, fraction + 3 * k, low, low};
}

// What one rounding loses at most, of a value with `given` fraction bits.
double rounding_loss(const Format& f, int given) {
  if (given <= f.fraction()) return 0;
  const double ulp = std::ldexp(1.0, -f.fraction());
  const bool is_cut = f.rounding == Rounding::trn || f.rounding == Rounding::trn_zero;
  return is_cut ? ulp - std::ldexp(1.0, -given) : ulp / 2;
}

// What the registers lose at the start and in each step.
struct CurveLosses {
  std::array<double, 4> start{}, step{};
  std::array<int, 4> needed{};  // fraction bits with which the register loses nothing
};
CurveLosses losses_of(const CurveFormats& formats, int fraction, int k) {
  CurveLosses out;
  out.needed = start_fractions(fraction, k);
  std::array<int, 4> held{};  // fraction bits that a register's values have
  for (std::size_t i = 4; i-- > 0;) {
    out.start[i] = rounding_loss(formats[i], out.needed[i]);
    held[i] = std::min(out.needed[i], formats[i].fraction());
    if (i == 3) continue;
    out.step[i] = rounding_loss(formats[i], held[i + 1]);
    held[i] = std::max(held[i], std::min(held[i + 1], formats[i].fraction()));
    out.needed[i] = std::max(out.needed[i], held[i + 1]);
  }
  return out;
}

}  // namespace

CurveFormats curve_formats(const Config& config) {
  CurveFormats out;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = config.format(curve_registers[i]);
  return out;
}

void check_curve(const CurveFormats& formats, int fraction, int k) {
  if (k < 0 || k > curve_k_limit) {
    throw InputError("curve: 2^" + std::to_string(k) + " steps are not legal; expected 2^0..2^" +
                     std::to_string(curve_k_limit));
  }
  if (fraction < 0 || fraction > 40) {
    throw InputError("curve: " + std::to_string(fraction) +
                     " fraction bits of the coefficients are not legal; expected 0..40");
  }
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const Format& f = formats[i];
    int integer = f.integer;
    int below = f.fraction();
    if (i < 3) {
      integer = std::max(integer, formats[i + 1].integer);
      below = std::max(below, formats[i + 1].fraction());
    }
    if (integer + below > curve_sum_limit) {
      throw InputError("formats." + std::string(key_of(curve_registers[i])) +
                       " lies too far from the register behind it: their sum has " +
                       std::to_string(integer + below + 1) + " bits; legal: at most " +
                       std::to_string(curve_sum_limit + 1));
    }
  }
}

std::optional<std::string> curve_violation(const CurveFormats& formats, const ControlGrid& grid, int k) {
  const CurveLosses losses = losses_of(formats, grid.fraction, k);
  // Differences of a cubic in Bezier's form whose points are within m of 0: of two points 2 m; d times the
  // derivative 6 m; d^2 times the second one 24 m; d^3 times the third one 48 m.
  constexpr std::array<int, 4> spread{1, 2, 4, 8};
  constexpr std::array<int, 4> derivative{1, 6, 24, 48};
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const Format& f = formats[i];
    const std::string key = "formats." + std::string(key_of(curve_registers[i]));
    const std::string what = std::string(curve_words[i]) + " of 2^" + std::to_string(k) + " steps";
    if (!f.is_signed) return key + " is unsigned; " + what + " need a sign";
    if (losses.start[i] > 0 || losses.step[i] > 0) {
      return key + " has " + std::to_string(f.fraction()) + " fraction bits; " + what + " need " +
             std::to_string(losses.needed[i]);
    }
    const auto at_most = static_cast<long double>(grid.largest);
    const long double largest = std::ldexp(
        std::min(spread[i] * at_most, std::ldexp(derivative[i] * at_most, -static_cast<int>(i) * k)),
        -grid.fraction);
    const long double holds = std::ldexp(std::ldexp(1.0L, f.word - 1) - 1, -f.fraction());
    if (largest > holds) {
      return key + " holds at most " + std::to_string(static_cast<double>(holds)) + "; " + what + " reach " +
             std::to_string(static_cast<double>(largest));
    }
  }
  return std::nullopt;
}

double curve_error_bound(const CurveFormats& formats, int fraction, int k) {
  const CurveLosses losses = losses_of(formats, fraction, k);
  const double n = std::ldexp(1.0, k);
  // A loss of d1 is added n times, of d2 in n (n - 1) / 2 ways, of d3 in n (n - 1) (n - 2) / 6.
  const double twice = n * (n - 1) / 2;
  const double thrice = twice * (n - 2) / 3;
  return losses.start[0] + n * (losses.start[1] + losses.step[0]) +
         twice * (losses.start[2] + losses.step[1]) + thrice * (losses.start[3] + losses.step[2]);
}

}  // namespace bitspan
