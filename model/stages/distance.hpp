// SPDX-License-Identifier: Apache-2.0
// distance: how far a fragment is from the viewer, along the view axis (s) and in truth (d).
// docs/numeric-spec.md, "distance" (T12).
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/span.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// The picture in zones of the distance r from its middle.
struct ScreenZones {
  std::int64_t width = 0, height = 0;
  int bits = 4;
  FogZone by = FogZone::r2;
};
ScreenZones screen_zones(const Config& config, const Scene& scene);
int zone_of(const ScreenZones& zones, std::int64_t x, std::int64_t y);
// The least of (2x+1-W)^2 + (2y+1-H)^2 from which on a pixel has at least this zone.
std::int64_t zone_start(const ScreenZones& zones, std::int64_t zone);
// r^2 in the middle of a zone is this times (W^2 + H^2).
Exact middle_of(const ScreenZones& zones, int zone);

// A' = Q[distance.a](B s_max').
template <class Watch = NoObserve>
Exact distance_constant(const Config& config, const Constants& constants, Watch watch = {});

// G of each zone, raw on distance.g, exactly rounded. Throws InputError where the scene's focal length is not
// positive, or the picture's half diagonal is more than 2^16 times that.
template <class Watch = NoObserve>
std::vector<std::int64_t> zone_factors(const Config& config, const Scene& scene, Watch watch = {});

struct DistanceStage {
  bool true_distance = false;  // d is formed
  InverseDepth q;              // h + B
  Exact a;                     // A'
  bool fits_int64 = false;     // A' m does, and where it is rounded
  ReciprocalUnit reciprocal;   // R_pixel
  Register s, g, d;
  ScreenZones zones;
  std::vector<std::int64_t> factors;  // G, by zone
};
template <class Watch = NoObserve>
DistanceStage prepare_distance(const Config& config, const Constants& constants, const Scene& scene,
                               Watch watch = {});

// A fragment that comes to the texture.
template <class Watch = NoObserve>
void distance(const DistanceStage& stage, const FragmentRecord& fragment, DistanceRecord& out,
              Watch watch = {});

}  // namespace bitspan::model
