// SPDX-License-Identifier: Apache-2.0
#include "study/curves.hpp"

#include <algorithm>
#include <cmath>

#include "config/config.hpp"
#include "scene/generate/cubic.hpp"

namespace bitspan {

AdderCurve curve_by_adders(const model::ForwardDifferenceStage& stage, const ControlPoints& control,
                           int fraction) {
  const Cubic<std::int64_t> cubic = cubic_of(bezier_matrix, 1, control);
  const int steps = 1 << stage.k;
  const long double ulp = std::ldexp(1.0L, -stage.d[0].fraction);
  AdderCurve out;
  out.points.reserve(static_cast<std::size_t>(steps) + 1);
  CurveRegisters d = model::start_curve(stage, {cubic.power, fraction});
  for (int n = 0; n <= steps; ++n) {
    const long double point = static_cast<long double>(d[0]) * ulp;
    out.points.push_back(static_cast<double>(point));
    // Over 2^3k exactly; the difference rounds once.
    using Wide = __int128;
    const Wide t = n;
    const Wide truth =
        ((cubic.power[3] * t + Wide{cubic.power[2]} * steps) * t + Wide{cubic.power[1]} * steps * steps) * t +
        Wide{cubic.power[0]} * steps * steps * steps;
    const long double error = point - std::ldexp(static_cast<long double>(truth), -fraction - 3 * stage.k);
    out.worst = std::max(out.worst, static_cast<double>(std::fabs(error)));
    if (n < steps) {
      model::forward_difference(stage, d);
    } else {
      out.misses_end = error != 0;
    }
  }
  return out;
}

CurveSet curves_of(const PatchSet& patches, int k) {
  if (patches.fraction < 0) {
    throw InputError(patches.name +
                     ": its control points lie beyond 2^20; a study of curves has them on a grid "
                     "with fraction bits");
  }
  CurveSet out{patches.fraction, k, {}};
  for (const Patch& patch : patches.patches) {
    for (const PatchGrid& grid : patch.axis) {
      for (std::size_t i = 0; i < 4; ++i) {
        out.curves.push_back(grid[i]);
        out.curves.push_back({grid[0][i], grid[1][i], grid[2][i], grid[3][i]});
      }
    }
  }
  return out;
}

Metrics curve_metrics(const Config& config, const CurveSet& set) {
  const CurveFormats formats = curve_formats(config);
  const model::ForwardDifferenceStage stage = model::prepare_forward_difference(formats, set.fraction, set.k);
  double worst = 0, missed = 0, inexact = 0;
  for (const ControlPoints& control : set.curves) {
    const AdderCurve curve = curve_by_adders(stage, control, set.fraction);
    worst = std::max(worst, curve.worst);
    missed += curve.misses_end ? 1 : 0;
    inexact += curve.worst > 0 ? 1 : 0;
  }
  const double steps_per_unit = std::ldexp(1.0, set.fraction);
  double bits = 0;
  for (const Format& f : formats) bits += f.word;
  return {{"curve.error_max", worst * steps_per_unit},
          {"curve.error_bound", curve_error_bound(formats, set.fraction, set.k) * steps_per_unit},
          {"curve.missed_ends", missed},
          {"curve.inexact", inexact},
          {"curve.curves", static_cast<double>(set.curves.size())},
          {"curve.register_bits", bits}};
}

void add_curve_metrics(const Metrics& of_scene, Metrics& all) {
  for (const auto& [name, value] : of_scene) {
    const auto [place, is_new] = all.try_emplace(name, value);
    if (is_new || name == "curve.register_bits") continue;
    const bool is_error = name == "curve.error_max" || name == "curve.error_bound";
    place->second = is_error ? std::max(place->second, value) : place->second + value;
  }
}

}  // namespace bitspan
