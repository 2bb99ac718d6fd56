// SPDX-License-Identifier: Apache-2.0
// depth, timed: drops fragments that are not covered or behind; reads the stored code from memory; holds a
// fragment back while an earlier one of its pixel is on its way to merge.
#pragma once

#include "model/timed/lod.hpp"
#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// Whether the fragment comes to depth, for both modes.
inline bool drawn_values(Run& run, const FragmentItem& item) {
  if (item.fragment.covered == 0) return false;
  if (run.is_drawn(item.fragment)) return true;
  ++run.counters.masked;
  return false;
}

// The values of depth for a covered fragment, for both modes; false where it is behind.
inline bool depth_values(Run& run, FragmentItem& item) {
  const std::uint32_t stored = run.frame.depth[run.pixel(item.fragment)];
  const bool passed = model::depth(run.pipeline.depth, item.fragment, stored, item.depth);
  deliver(run.trace, item.depth);
  if (!passed) return false;
  ++run.counters.depth_passed;
  lod_values(run, item);
  return true;
}

class DepthStage : public PipeStage<FragmentItem> {
 public:
  DepthStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::depth), run.timing(Stage::depth), in, &out, run.fragments, &memory,
                  Memory::Port::depth, run.config.memory.latency),
        run_(run),
        traffic_(run) {}

 private:
  bool may_enter(const FragmentItem& item, std::uint64_t now) override {
    return !run_.is_drawn(item.fragment) || run_.pixel_free[run_.pixel(item.fragment)] <= now;
  }
  bool enters(FragmentItem& item) override {
    if (!drawn_values(run_, item)) return false;
    const std::size_t at = run_.pixel(item.fragment);
    if (traffic_.access(at)) ask_read(traffic_.word_bytes());
    if (!depth_values(run_, item)) return false;
    run_.pixel_free[at] = Run::never;
    return true;
  }
  Run& run_;
  DepthTraffic traffic_;
};

}  // namespace bitspan::timed
