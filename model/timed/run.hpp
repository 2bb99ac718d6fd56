// SPDX-License-Identifier: Apache-2.0
// What the stages of one timed run share: the prepared stage functions, the frame, the counters, the trace.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <string_view>
#include <vector>

#include "config/modes.hpp"
#include "engine/engine.hpp"
#include "model/pipeline.hpp"
#include "model/scene_run.hpp"
#include "model/timed/engine_systemc.hpp"
#include "model/timed/items.hpp"
#include "model/timed/stage.hpp"
#include "model/timed/stage_timings.hpp"

namespace bitspan::timed {

// The gradients of the triangles between setup and one of the stages that take them. Fragments come to a
// stage in the order of their triangles; late tests bring them to lod first.
class WaitingGradients {
 public:
  explicit WaitingGradients(bool taken) : taken_(taken) {}
  void put(const GradientRecord& gradient) {
    if (taken_) waiting_.push_back(gradient);
  }
  // Those of the fragment's triangle; null where the stage takes none. What is in front of them goes.
  const GradientRecord* of(const FragmentRecord& fragment) {
    if (!taken_) return nullptr;
    while (waiting_.front().triangle < fragment.triangle) waiting_.pop_front();
    return &waiting_.front();
  }

 private:
  bool taken_;
  std::deque<GradientRecord> waiting_;
};

struct Run : model::SceneRun {
  Run(const Config& c, const Scene& s, const SystemcOptions& options)
      : config(c),
        measures_texture_cache(options.measure_texture_cache),
        watch_caches(options.watch_caches),
        timings(stage_timings(c)) {
    pipeline = model::make_pipeline(c, s);
    uv_ulp = std::ldexp(1.0, -pipeline.texture.uv.fraction);
    begin(s, true);
  }

  const Config& config;
  bool measures_texture_cache;
  CacheWatch watch_caches;
  std::array<StageTiming, stage_count> timings;
  double uv_ulp = 1;       // the value of 1 in a fragment's u and v
  Trace* trace = nullptr;  // of the draw under way; may be null
  WaitingGradients depth_gradients{has_dz(config.depth_code)}, lod_gradients{has_lod_gradients(config)};
  std::deque<model::TrianglePlane>
      planes;  // slope.row = plane: of the triangles between setup and span_setup
  std::deque<model::TriangleChannels>
      channels;  // where some are in use: of the triangles between setup and span_setup
  Pool<TriangleItem> triangles;
  Pool<RowItem> rows;
  Pool<FragmentItem> fragments;
  // Mode cycle: first clock on which depth may test a fragment of the pixel: `never` while another one holds
  // it. Set by depth, released by the stage where that fragment ends.
  std::vector<std::uint64_t> pixel_free;
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

  model::TriangleChannels& channels_of(std::int64_t triangle) {
    return *std::ranges::lower_bound(channels, triangle, {},
                                     [](const model::TriangleChannels& c) { return c.setup.triangle; });
  }
  std::size_t pixel(const FragmentRecord& fragment) const { return pixel_of(frame, fragment); }
  // The fragment's texture, null for none.
  const Texture* image(const FragmentItem& item) const {
    return model::texture_of(*scene, item.surface.texture);
  }
  // Whether the fragment covers its pixel, and scissor and stipple let it be drawn.
  bool is_drawn(const FragmentRecord& fragment) const {
    return fragment.covered != 0 && model::is_drawn(pipeline, fragment);
  }
  // Whether depth and stencil are tested behind the texture.
  bool tests_late() const { return is_late(pipeline.state.depth_when); }
  // The fragment waits in front of no other one any more.
  void release(FragmentItem& item, std::uint64_t now) {
    if (!item.holds_pixel) return;
    item.holds_pixel = false;
    pixel_free[pixel(item.fragment)] = now + 1;
  }
  // Bytes of a depth code in memory: 1, 2 or 4.
  std::uint64_t depth_bytes() const { return config.depth_bits <= 8 ? 1 : config.depth_bits <= 16 ? 2 : 4; }
  // Returns the name of the stage that walks a triangle's rows in this mode.
  std::string_view walk_name() const {
    return pipeline.const_depth_rows ? stage_name<PlaneRecord> : stage_name<RowRecord>;
  }
  const StageTiming& timing(Stage stage) const { return timings[static_cast<std::size_t>(stage)]; }
};

inline constexpr std::uint64_t color_bytes = 4;  // of a pixel, and of a texel

// Whether the fragment goes on from span, for both modes: decided by the first stage behind it.
inline bool drawn_values(Run& run, const FragmentItem& item) {
  if (item.fragment.covered == 0) return false;
  if (run.is_drawn(item.fragment)) return true;
  ++run.counters.masked;
  return false;
}

}  // namespace bitspan::timed
