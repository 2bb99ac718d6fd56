// SPDX-License-Identifier: Apache-2.0
// Keeps what `ideal` says of the scenes of a study, as long as it fits in memory.
#pragma once

#include <cstddef>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "config/config.hpp"
#include "engine/frame.hpp"
#include "report/truth.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// The truth of one scene under one truth_config.
struct SceneTruth {
  // So many triangles are drawn and compared at once, so that their records stay in the cache.
  static constexpr std::size_t batch = 64;
  std::vector<Truth> batches;
  Frame frame;
  std::size_t bytes() const;
};

// Returns half of the memory that the machine has, in bytes.
std::size_t half_of_memory();

// Its functions may be called from several threads.
class Truths {
 public:
  // The scenes must outlive it.
  Truths(const std::vector<Scene>& scenes, std::size_t limit) : scenes_(scenes), limit_(limit) {}
  // Returns the truth of a scene. The first thread that asks computes it; the others wait. Where those that
  // are kept would take more bytes than the limit, the ones asked for longest ago make room, but those of the
  // same truth_config stay: then this one is not kept.
  std::shared_ptr<const SceneTruth> of(const Config& config, std::size_t scene);
  // Returns it where it is kept or under way, else null.
  std::shared_ptr<const SceneTruth> kept(const Config& config, std::size_t scene);
  std::size_t bytes() const;

 private:
  using Known = std::shared_future<std::shared_ptr<const SceneTruth>>;
  struct Entry {
    Config key;                // truth_config
    std::vector<Known> known;  // per scene
    std::size_t bytes = 0;
  };
  std::list<Entry>::iterator find(const Config& key);
  void keep(const Config& key, std::size_t scene, std::size_t bytes);
  void drop_last();

  const std::vector<Scene>& scenes_;
  std::size_t limit_, bytes_ = 0;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the one asked for last is the first
};

}  // namespace bitspan
