// SPDX-License-Identifier: Apache-2.0
// texture, timed: looks its texels up in the cache and fetches the lines that are missing.
#pragma once

#include "model/timed/lod.hpp"
#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// The same of the second unit, where it is on. It looks up every fragment that the first one does; `lives`:
// what the first one does not kill.
inline bool second_values(Run& run, FragmentItem& item, bool lives) {
  const model::TextureSecondStage& stage = run.pipeline.texture_second;
  if (!stage.is_on()) return lives;
  const int levels =
      run.pipeline.has_lod ? static_cast<int>(run.pipeline.mip_chains.of(stage.image)->size()) : 1;
  const model::ProjectStage& project = run.pipeline.project;
  if (project.is_on) {
    model::project(project, item.fragment, &item.channels, item.projected);
    item.second_lod = {};
  } else {
    item.second_lod = model::second_level(stage, item.lod, levels);
  }
  if (!lives) return false;
  if (project.is_on) deliver(run.trace, item.projected);
  TextureSecondRecord second;
  FragmentRecord own;
  const FragmentRecord& looked_up =
      model::as_second(run.pipeline.channels, item.fragment, &item.channels, own);
  const bool goes_on = model::fragment_texture_second(run.pipeline, looked_up, item.lod, item.texel,
                                                      project.is_on ? &item.projected : nullptr, second);
  deliver(run.trace, second);
  item.texel = model::combined(item.texel, second);
  return goes_on;
}

// The values of texture, for both modes; false where the fragment is killed.
inline bool texture_values(Run& run, FragmentItem& item) {
  if (run.tests_late()) {
    distance_values(run, item);
    lod_values(run, item);
  }
  FragmentRecord own;
  const FragmentRecord& drawn = model::as_drawn(run.pipeline.channels, item.fragment, &item.channels, own);
  const bool lives = model::fragment_texture(run.pipeline, drawn, run.image(item), item.lod, item.texel);
  deliver(run.trace, item.texel);
  const bool goes_on = second_values(run, item, lives);
  if (!goes_on) ++run.counters.killed;
  return goes_on;
}

class TextureStage : public PipeStage<FragmentItem> {
 public:
  TextureStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::texture), run.timing(Stage::texture), in, &out, run.fragments, &memory,
                  Memory::Port::texture, run.config.memory.latency),
        run_(run),
        traffic_(run) {}
  const Cache& cache() const { return traffic_.cache(); }
  TextureTraffic& traffic() { return traffic_; }

 private:
  bool enters(FragmentItem& item) override {
    if (run_.tests_late() && !drawn_values(run_, item)) return false;
    const bool lives = texture_values(run_, item);
    ask(traffic_.accesses(), traffic_.ask(run_.pipeline, item));
    return lives;
  }
  void leaves(FragmentItem& item, bool kept, std::uint64_t now) override {
    if (!kept) run_.release(item, now);
  }

  Run& run_;
  TextureTraffic traffic_;
};

}  // namespace bitspan::timed
