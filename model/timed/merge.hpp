// SPDX-License-Identifier: Apache-2.0
// merge, timed: reads the stored colour where it blends, writes colour and depth code.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// The values of merge, for both modes; writes the frame.
inline void merge_values(Run& run, FragmentItem& item) {
  const std::uint8_t* color = run.frame.color.data() + 4 * run.pixel(item.fragment);
  MergeRecord merged;
  model::merge(run.pipeline.merge, item.depth, item.texel, item.fog, {color[0], color[1], color[2]}, merged);
  write_fragment(run.frame, item.fragment, merged, run.uv_ulp);
  ++run.counters.written;
  deliver(run.trace, merged);
}

class MergeStage : public PipeStage<FragmentItem> {
 public:
  MergeStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in)
      : PipeStage(to_string(Stage::merge), run.timing(Stage::merge), in, nullptr, run.fragments, &memory,
                  Memory::Port::merge, run.config.memory.latency),
        run_(run),
        traffic_(run) {}

 private:
  bool enters(FragmentItem& item) override {
    const MergeTraffic::Ask ask = traffic_.access(traffic_.blends(item.texel.a), run_.pixel(item.fragment));
    if (ask.color_read) ask_read(traffic_.color_word_bytes());
    if (ask.color_write) ask_write(traffic_.color_word_bytes());
    if (ask.depth_write) ask_write(traffic_.depth_word_bytes());
    merge_values(run_, item);
    return true;
  }
  void leaves(FragmentItem& item, bool /*kept*/, std::uint64_t now) override {
    run_.release(item.fragment, now);
  }
  Run& run_;
  MergeTraffic traffic_;
};

}  // namespace bitspan::timed
