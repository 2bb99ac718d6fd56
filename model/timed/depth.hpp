// depth, timed: drops fragments that are not covered or behind; reads the stored code from memory; holds a
// fragment back while an earlier one of its pixel is on its way to merge.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

class DepthStage : public PipeStage<FragmentItem> {
 public:
  DepthStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage("depth", run.timing(Stage::depth), in, &out, run.fragments, &memory, Memory::Port::depth,
                  run.config.memory.latency),
        run_(run),
        word_(run.config.memory, run.depth_bytes()) {}

 private:
  bool may_enter(const FragmentItem& item, std::uint64_t now) override {
    return item.fragment.covered == 0 || run_.pixel_free[run_.pixel(item.fragment)] <= now;
  }
  bool enters(FragmentItem& item) override {
    const FragmentRecord& fragment = item.fragment;
    if (fragment.covered == 0) return false;
    const std::size_t at = run_.pixel(fragment);
    if (word_.access(at * run_.depth_bytes())) ask_read(word_.word_bytes());
    const bool passed = model::depth(run_.pipeline.depth, fragment, run_.frame.depth[at], item.depth);
    if (run_.trace != nullptr) run_.trace->depth.push_back(item.depth);
    if (!passed) return false;
    ++run_.counters.depth_passed;
    run_.pixel_free[at] = Run::never;
    return true;
  }
  Run& run_;
  WordRegister word_;
};

}  // namespace bitspan::timed
