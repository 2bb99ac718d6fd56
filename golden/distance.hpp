// SPDX-License-Identifier: Apache-2.0
// Stage `distance`: how far a fragment is from the viewer; and the zones of the picture. [T12]
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "config/modes.hpp"
#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "golden/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments; appends a record for each.
using DistanceStage =
    std::function<void(std::span<const FragmentRecord* const>, std::vector<DistanceRecord>&)>;
DistanceStage make_distance(Arithmetic arithmetic, const Config& config, const Constants& constants,
                            const Scene& scene);

// G of each zone, raw on distance.g. Throws InputError where the scene's focal length is not legal.
std::vector<std::int64_t> zone_factors(const Config& config, const Scene& scene);

// r^2 in the middle of a zone over W^2 + H^2, exactly.
Quad middle_of_zone(const Config& config, int zone);

// The zone of a pixel, by its distance from the picture's middle.
template <class Real>
class Zoning {
 public:
  Zoning(const Config& config, const Scene& scene)
      : by_(config.fog_zone), width_(scene.width), height_(scene.height), zones_(1 << config.fog_zone_bits) {}
  std::int64_t operator()(std::int64_t x, std::int64_t y) const {
    const Real dx = Real(2 * x + 1 - width_);
    const Real dy = Real(2 * y + 1 - height_);
    const Real r2 = dx * dx + dy * dy;
    const Real r2_max = Real(width_ * width_ + height_ * height_);
    switch (by_) {
      case FogZone::r2:
        return std::min<std::int64_t>(zones_ - 1, to_integer(whole_of_quotient(r2 * zones_, r2_max).whole));
      case FogZone::r: {
        // Zone k begins where (2^j r)^2 = k^2 r_max^2; the root is only a first guess.
        const Real scaled = r2 * zones_ * zones_;
        const auto starts_by = [&](std::int64_t k) { return Real(k) * Real(k) * r2_max <= scaled; };
        auto zone = static_cast<std::int64_t>(
            std::sqrt(static_cast<double>(base_of(r2)) / static_cast<double>(base_of(r2_max))) * zones_);
        zone = std::clamp<std::int64_t>(zone, 0, zones_ - 1);
        while (!starts_by(zone)) --zone;
        while (zone + 1 < zones_ && starts_by(zone + 1)) ++zone;
        return zone;
      }
    }
    unreachable();
  }

 private:
  FogZone by_;
  std::int64_t width_, height_;
  int zones_;
};

}  // namespace bitspan::golden
