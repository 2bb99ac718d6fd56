// SPDX-License-Identifier: Apache-2.0
// Stage `constants`: computed once per scene.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "config/lines.hpp"
#include "engine/records.hpp"
#include "golden/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// What the range of a projector's distances gives, as the view's range does.
struct ProjectorConstants {
  int s_exponent = 0;      // E_p
  std::int64_t s_max = 0;  // s_max', raw on setup.s
  std::int64_t b = 0;      // B_p, raw on setup.b
};

// The brightness of a vertex, as a raw value of q.
using VertexLight = std::function<std::int64_t(const Vertex& vertex, const Quantizer<Quad>& q)>;

struct Constants {
  ConstantsRecord record;
  int s_exponent = 0;                           // E: s is normalised by 2^-E
  std::vector<LineId> channels;                 // those in use
  double z_max = 0;                             // 2^depth.bits - 1
  double fog_distance = 1;                      // DT, where the scene has fog
  std::optional<ProjectorConstants> projector;  // where the scene has one, and the configuration its unit
  VertexLight light;                            // where the channel light is in use
};

// Throws InputError where the scene's range of s, its projector's, or its fog distance does not fit the
// formats.
Constants make_constants(const Config& config, const Scene& scene);

}  // namespace bitspan::golden
