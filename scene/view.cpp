// SPDX-License-Identifier: Apache-2.0
#include "scene/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/config.hpp"
#include "scene/picture_size.hpp"

namespace bitspan {

std::string light_fault(const Light& light, double s_max) {
  const auto is_share = [](double x) { return x >= 0 && x <= 1; };
  const auto is_zero = [](double x) { return x == 0; };
  if (!std::ranges::all_of(light.place, [](double x) { return std::isfinite(x); }) ||
      (!light.is_point && std::ranges::all_of(light.place, is_zero))) {
    return light.is_point ? ".position: is not finite; expected three finite numbers"
                          : ".direction: is not legal; expected three finite numbers, not all 0";
  }
  if (!is_share(light.ambient)) return ".ambient: is not legal; expected a number from 0 to 1";
  if (!is_share(light.specular) || light.ambient + light.specular > 1) {
    return ".specular: is not legal; expected a number from 0 to 1, with ambient at most 1";
  }
  if (light.exponent < 1 || light.exponent > light_exponent_limit) {
    return fmt::format(".exponent: {} is not legal; expected a whole number 1..{}", light.exponent,
                       light_exponent_limit);
  }
  const auto beyond = [](double x, double most) { return !(x >= 0 && x <= most); };
  if (beyond(light.lunar, light_lunar_limit)) {
    return fmt::format(".lunar: is not legal; expected a number from 0 to {}", light_lunar_limit);
  }
  if (beyond(light.offset, light_offset_limit)) {
    return fmt::format(".offset: is not legal; expected a number from 0 to {}", light_offset_limit);
  }
  if (beyond(light.reach, std::numeric_limits<double>::max())) {
    return ".reach: is not legal; expected a number above 0, or 0 for brightness that does not fall";
  }
  if (light.reach > 0 && s_max > 0 &&
      beyond(std::abs(std::log2(light.reach) - std::log2(s_max)), reach_octaves)) {
    return fmt::format(".reach: {} is not legal; expected s_max 2^-{} to s_max 2^{}, which is {}",
                       light.reach, reach_octaves, reach_octaves, s_max);
  }
  return {};
}

View changed_view(View view, const ViewChange& change) {
  view.width = change.width.value_or(view.width);
  view.height = change.height.value_or(view.height);
  view.s_min = change.s_min.value_or(view.s_min);
  view.s_max = change.s_max.value_or(view.s_max);
  view.focal = change.focal.value_or(view.focal);
  view.background = change.background.value_or(view.background);
  view.fog = change.fog.value_or(view.fog);
  view.projector = change.projector.value_or(view.projector);
  view.light = change.light.value_or(view.light);
  if (!is_legal({view.width, view.height})) {
    throw InputError(fmt::format("width: {} x {} is not legal; expected 1..{} pixels each way and {} in all",
                                 view.width, view.height, picture_size_limit, picture_area_limit));
  }
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  const auto check_range = [&](const char* key, double s_min, double s_max) {
    if (positive(s_min) && positive(s_max) && s_min < s_max) return;
    throw InputError(
        fmt::format("{}: {} to s_max = {} is not legal; expected 0 < s_min < s_max", key, s_min, s_max));
  };
  check_range("s_min", view.s_min, view.s_max);
  if (view.projector) check_range("projector.s_min", view.projector->s_min, view.projector->s_max);
  if (!positive(view.focal)) throw InputError("focal: is not legal; expected a number above 0");
  if (view.fog && !positive(view.fog->distance)) {
    throw InputError("fog.distance: is not legal; expected a number above 0");
  }
  if (view.light) {
    if (const std::string fault = light_fault(*view.light, view.s_max); !fault.empty()) {
      throw InputError("light" + fault);
    }
  }
  return view;
}

}  // namespace bitspan
