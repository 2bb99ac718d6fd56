// SPDX-License-Identifier: Apache-2.0
// merge, timed: reads the stored colour where it blends, writes colour and depth code.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// The values of candidate, which works in merge's clock.
inline void candidate_values(Run& run, FragmentItem& item) {
  CandidateRecord taken;
  model::candidate(run.pipeline.depth.formats, item.fragment, item.depth, item.texel, item.fog,
                   run.frame.candidates[run.pixel(item.fragment)], taken);
  deliver(run.trace, taken);
  ++run.counters.candidates;
}

// The values of merge, for both modes; writes the frame.
inline void merge_values(Run& run, FragmentItem& item) {
  if (holds_candidates(run.pipeline.state.translucency_pass)) return candidate_values(run, item);
  std::uint8_t* color = run.frame.color.data() + 4 * run.pixel(item.fragment);
  const WriteMask mask = model::write_mask(run.pipeline.state);
  MergeRecord merged;
  model::merge(run.pipeline.merge, item.depth, item.texel, item.fog, {color[0], color[1], color[2], color[3]},
               merged);
  deliver(run.trace, merged);
  if (run.pipeline.merge.changes_alpha) {
    const MergeAlphaRecord alpha = model::merged_alpha(run.pipeline.merge, item.texel, color[3]);
    deliver(run.trace, alpha);
    if (mask.stores(3)) color[3] = static_cast<std::uint8_t>(alpha.a);
  }
  write_fragment(run.frame, item.fragment, merged, run.uv_ulp, mask);
  ++run.counters.written;
}

class MergeStage : public PipeStage<FragmentItem> {
 public:
  MergeStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in)
      : PipeStage(to_string(Stage::merge), run.timing(Stage::merge), in, nullptr, run.fragments, &memory,
                  Memory::Port::merge, run.config.memory.latency),
        run_(run),
        traffic_(run) {}
  MergeTraffic& traffic() { return traffic_; }
  const MergeTraffic& traffic() const { return traffic_; }

 private:
  bool enters(FragmentItem& item) override {
    ask(traffic_.accesses(),
        traffic_.ask(traffic_.needs(run_.pipeline, item.texel.a), run_.pixel(item.fragment)));
    merge_values(run_, item);
    return true;
  }
  void leaves(FragmentItem& item, bool /*kept*/, std::uint64_t now) override { run_.release(item, now); }
  Run& run_;
  MergeTraffic traffic_;
};

}  // namespace bitspan::timed
