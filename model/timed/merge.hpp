// merge, timed: reads the stored colour where it blends, writes colour and depth code.
#pragma once

#include "model/timed/traffic.hpp"
#include "model/timed/values.hpp"

namespace bitspan::timed {

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
