// texture, timed: looks its texels up in the cache and fetches the lines that are missing.
#pragma once

#include "model/timed/cache.hpp"
#include "model/timed/run.hpp"

namespace bitspan::timed {

class TextureStage : public PipeStage<FragmentItem> {
 public:
  TextureStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out);
  const Cache& cache() const { return cache_; }

 private:
  bool enters(FragmentItem& item) override;
  void leaves(FragmentItem& item, bool kept, std::uint64_t now) override {
    if (!kept) run_.release(item.fragment, now);
  }
  void look_up(int texture, std::int64_t i, std::int64_t j);

  Run& run_;
  Cache cache_;
  std::vector<std::uint64_t> base_;  // byte address of each texture
};

}  // namespace bitspan::timed
