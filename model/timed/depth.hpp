// depth, timed: drops fragments that are not covered or behind; reads the stored code from memory; holds a
// fragment back while an earlier one of its pixel is on its way to merge.
#pragma once

#include "model/timed/traffic.hpp"
#include "model/timed/values.hpp"

namespace bitspan::timed {

class DepthStage : public PipeStage<FragmentItem> {
 public:
  DepthStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::depth), run.timing(Stage::depth), in, &out, run.fragments, &memory,
                  Memory::Port::depth, run.config.memory.latency),
        run_(run),
        traffic_(run) {}

 private:
  bool may_enter(const FragmentItem& item, std::uint64_t now) override {
    return item.fragment.covered == 0 || run_.pixel_free[run_.pixel(item.fragment)] <= now;
  }
  bool enters(FragmentItem& item) override {
    if (item.fragment.covered == 0) return false;
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
