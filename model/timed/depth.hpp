// SPDX-License-Identifier: Apache-2.0
// depth and stencil, timed: drops fragments that a test fails; reads the stored code and the stencil plane
// from memory; holds a fragment back while an earlier one of its pixel may still change what it is tested
// against.
#pragma once

#include "model/timed/lod.hpp"
#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// The values of depth and stencil for a fragment that is drawn, for both modes; false where a test fails.
inline bool depth_values(Run& run, FragmentItem& item) {
  const std::size_t at = run.pixel(item.fragment);
  const GradientRecord* gradient = run.depth_gradients.of(item.fragment);
  FragmentRecord own;
  const FragmentRecord& drawn = model::as_drawn(run.pipeline.channels, item.fragment, &item.channels, own);
  bool passed = model::depth(run.pipeline.depth, drawn, gradient, run.frame.depth[at], item.depth);
  deliver(run.trace, item.depth);
  if (run.pipeline.stencil.test) {
    passed = model::stencil(run.pipeline.stencil, item.surface.back, item.depth, run.frame.stencil[at],
                            item.stencil);
    deliver(run.trace, item.stencil);
    run.frame.stencil[at] = static_cast<std::uint8_t>(item.stencil.value);
    if (item.stencil.pass == 0) ++run.counters.stencil_failed;
  }
  if (!passed) return false;
  ++run.counters.depth_passed;
  if (!run.tests_late()) {
    distance_values(run, item);
    lod_values(run, item);
  }
  return true;
}

// Whether a fragment that is tested holds its pixel from here on: one that goes on may write its depth code,
// and each writes the stencil plane.
inline bool holds_pixel(const Run& run, bool passed) { return passed || run.pipeline.stencil.test; }

class DepthStage : public PipeStage<FragmentItem> {
 public:
  DepthStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::depth), run.timing(Stage::depth), in, &out, run.fragments, &memory,
                  Memory::Port::depth, run.config.memory.latency),
        run_(run),
        traffic_(run) {}
  DepthTraffic& traffic() { return traffic_; }
  const DepthTraffic& traffic() const { return traffic_; }

 private:
  bool may_enter(const FragmentItem& item, std::uint64_t now) override {
    return !run_.is_drawn(item.fragment) || run_.pixel_free[run_.pixel(item.fragment)] <= now;
  }
  bool enters(FragmentItem& item) override {
    if (!run_.tests_late() && !drawn_values(run_, item)) return false;
    const bool passed = depth_values(run_, item);
    const std::size_t at = run_.pixel(item.fragment);
    ask(traffic_.accesses(), traffic_.ask(run_.pipeline, at, passed, item.stencil));
    item.holds_pixel = holds_pixel(run_, passed);
    if (item.holds_pixel) run_.pixel_free[at] = Run::never;
    return passed;
  }
  void leaves(FragmentItem& item, bool kept, std::uint64_t now) override {
    if (!kept) run_.release(item, now);
  }
  Run& run_;
  DepthTraffic traffic_;
};

}  // namespace bitspan::timed
