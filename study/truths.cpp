// SPDX-License-Identifier: Apache-2.0
#include "study/truths.hpp"

#include <sys/sysinfo.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <numeric>
#include <span>
#include <utility>

#include "golden/mip_chain.hpp"
#include "study/engines.hpp"

namespace bitspan {
namespace {

constexpr std::size_t kept_configs = 4;

SceneTruth make_truth(const Config& config, const Scene& scene) {
  SceneTruth out;
  const auto levels = std::make_shared<golden::SceneLevels>(golden::scene_levels(config, scene));
  const std::span<const Triangle> all = scene.triangles;
  for (std::size_t at = 0; at < all.size(); at += SceneTruth::batch) {
    out.batches.emplace_back(config, scene, all.subspan(at, std::min(SceneTruth::batch, all.size() - at)),
                             levels);
  }
  out.frame = drawn("ideal", config, scene);
  return out;
}

}  // namespace

std::size_t SceneTruth::bytes() const {
  const auto pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  constexpr std::size_t per_pixel = 4 + sizeof(std::uint32_t) + 2 * sizeof(double) + sizeof(std::int32_t);
  return std::accumulate(batches.begin(), batches.end(), pixels * per_pixel,
                         [](std::size_t sum, const Truth& t) { return sum + sizeof t + t.bytes(); });
}

std::size_t half_of_memory() {
  const long pages = ::get_phys_pages();
  return pages > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(::getpagesize()) / 2 : 0;
}

std::list<Truths::Entry>::iterator Truths::find(const Config& key) {
  return std::ranges::find(entries_, key, &Entry::key);
}

void Truths::drop_last() {
  bytes_ -= entries_.back().bytes;
  entries_.pop_back();
}

std::shared_ptr<const SceneTruth> Truths::of(const Config& config, std::size_t scene) {
  const Config key = truth_config(config);
  std::promise<std::shared_ptr<const SceneTruth>> promise;
  Known known;
  {
    const std::lock_guard lock(mutex_);
    const auto found = find(key);
    if (found == entries_.end()) {
      entries_.push_front({key, std::vector<Known>(scenes_.size())});
      if (entries_.size() > kept_configs) drop_last();
    } else {
      entries_.splice(entries_.begin(), entries_, found);
    }
    Known& here = entries_.front().known.at(scene);
    known = here;
    if (!known.valid()) here = promise.get_future().share();
  }
  if (known.valid()) return known.get();
  try {
    auto made = std::make_shared<const SceneTruth>(make_truth(config, scenes_[scene]));
    promise.set_value(made);
    keep(key, scene, made->bytes());
    return made;
  } catch (...) {
    promise.set_exception(std::current_exception());
    throw;
  }
}

void Truths::keep(const Config& key, std::size_t scene, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto entry = find(key);
  if (entry == entries_.end()) return;
  entry->bytes += bytes;
  bytes_ += bytes;
  while (bytes_ > limit_ && entries_.size() > 1 && entries_.back().key != key) drop_last();
  if (bytes_ <= limit_) return;
  entry->known[scene] = {};
  entry->bytes -= bytes;
  bytes_ -= bytes;
}

std::shared_ptr<const SceneTruth> Truths::kept(const Config& config, std::size_t scene) {
  Known known;
  {
    const std::lock_guard lock(mutex_);
    const auto found = find(truth_config(config));
    if (found != entries_.end()) known = found->known.at(scene);
  }
  return known.valid() ? known.get() : nullptr;
}

std::size_t Truths::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace bitspan
