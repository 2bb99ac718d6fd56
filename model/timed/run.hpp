// SPDX-License-Identifier: Apache-2.0
// What the stages of one timed run share: the prepared stage functions, the frame, the counters, the trace.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <string_view>
#include <vector>

#include "engine/engine.hpp"
#include "model/pipeline.hpp"
#include "model/timed/items.hpp"
#include "model/timed/stage.hpp"
#include "model/timed/stage_timings.hpp"

namespace bitspan::timed {

struct Run {
  Run(const Config& c, const Scene& s)
      : config(c),
        scene(s),
        timings(stage_timings(c)),
        pipeline(model::make_pipeline(c, s)),
        frame(model::cleared_frame(pipeline, s)),
        uv_ulp(std::ldexp(1.0, -pipeline.texture.uv.fraction)) {}

  const Config& config;
  const Scene& scene;
  std::array<StageTiming, stage_count> timings;
  model::Pipeline pipeline;
  Frame frame;
  double uv_ulp;  // the value of 1 in a fragment's u and v
  Counters counters;
  Trace* trace = nullptr;                // of the draw under way; may be null
  std::deque<GradientRecord> gradients;  // where lod takes them: of the triangles between setup and depth
  Pool<TriangleItem> triangles;
  Pool<RowItem> rows;
  Pool<FragmentItem> fragments;
  // Mode cycle: first clock on which depth may test a fragment of the pixel: `never` while another one is
  // between depth and merge. Set by depth, released by the stage where the fragment ends.
  std::vector<std::uint64_t> pixel_free;
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

  std::size_t pixel(const FragmentRecord& fragment) const { return pixel_of(frame, fragment); }
  // The fragment's texture, null for none.
  const Texture* image(const FragmentItem& item) const {
    return item.texture < 0 ? nullptr : &scene.textures[static_cast<std::size_t>(item.texture)];
  }
  // Whether the fragment covers its pixel, and scissor and stipple let it be drawn.
  bool is_drawn(const FragmentRecord& fragment) const {
    return fragment.covered != 0 &&
           (!masks_pixels(pipeline.state) || model::is_drawn(pipeline.state, fragment.x, fragment.y));
  }
  void release(const FragmentRecord& fragment, std::uint64_t now) { pixel_free[pixel(fragment)] = now + 1; }
  // Bytes of a depth code in memory: 1, 2 or 4.
  std::uint64_t depth_bytes() const { return config.depth_bits <= 8 ? 1 : config.depth_bits <= 16 ? 2 : 4; }
  // Returns the name of the stage that walks a triangle's rows in this mode.
  std::string_view walk_name() const {
    return pipeline.const_depth_rows ? stage_name<PlaneRecord> : stage_name<RowRecord>;
  }
  const StageTiming& timing(Stage stage) const { return timings[static_cast<std::size_t>(stage)]; }
};

inline constexpr std::uint64_t color_bytes = 4;  // of a pixel, and of a texel

}  // namespace bitspan::timed
