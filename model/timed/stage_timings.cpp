// SPDX-License-Identifier: Apache-2.0
#include "model/timed/stage_timings.hpp"

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"

namespace bitspan::timed {

std::array<StageTiming, stage_count> stage_timings(const Config& config) {
  Config like_rtl = config;
  like_rtl.pixel_reciprocal.pipelined = true;
  // With the bus, lod works in the clock of depth, and texture has the latency of a single level.
  like_rtl.mip = MipMode::none;
  const PixelTiming rtl = pixel_timing(like_rtl);
  std::array<StageTiming, stage_count> timings = config.timing;
  const auto follow = [&](Stage stage, int latency, bool takes_unit) {
    StageTiming& t = timings[static_cast<std::size_t>(stage)];
    t.latency = latency;
    t.interval = takes_unit && !config.pixel_reciprocal.pipelined ? rtl.pixel_unit : 1;
  };
  follow(Stage::depth, rtl.depth.total, is_linear_in_distance(config.depth_code));
  follow(Stage::texture, rtl.texture.total, false);
  follow(Stage::fog, rtl.fog.total, is_linear_in_distance(config.fog));
  follow(Stage::merge, rtl.merge.total_blending, false);
  return timings;
}

}  // namespace bitspan::timed
