// SPDX-License-Identifier: Apache-2.0
// texture, timed: looks its texels up in the cache and fetches the lines that are missing.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/traffic.hpp"

namespace bitspan::timed {

// The values of texture, for both modes; false where the fragment is killed.
inline bool texture_values(Run& run, FragmentItem& item) {
  const bool lives =
      model::fragment_texture(run.pipeline, item.fragment, run.image(item), item.lod, item.texel);
  deliver(run.trace, item.texel);
  if (!lives) ++run.counters.killed;
  return lives;
}

class TextureStage : public PipeStage<FragmentItem> {
 public:
  TextureStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::texture), run.timing(Stage::texture), in, &out, run.fragments, &memory,
                  Memory::Port::texture, run.config.memory.latency),
        run_(run),
        line_bytes_(static_cast<std::uint64_t>(run.config.memory.cache_line_bytes)),
        traffic_(run) {}
  const Cache& cache() const { return traffic_.cache(); }

 private:
  bool enters(FragmentItem& item) override {
    const bool lives = texture_values(run_, item);
    for (int n = traffic_.misses(item.texture, item.fragment.u, item.fragment.v, item.lod); n > 0; --n)
      ask_read(line_bytes_);
    return lives;
  }
  void leaves(FragmentItem& item, bool kept, std::uint64_t now) override {
    if (!kept) run_.release(item.fragment, now);
  }

  Run& run_;
  std::uint64_t line_bytes_;
  TextureTraffic traffic_;
};

}  // namespace bitspan::timed
