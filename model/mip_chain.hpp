// SPDX-License-Identifier: Apache-2.0
// The mip chains of a scene's textures; docs/numeric-spec.md, "Levels".
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/drawn_scene.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// The levels of a texture, the texture itself first.
using MipChain = std::vector<Texture>;
MipChain make_mip_chain(const Texture& texture);

// How often the sides of a texture are halved down to a level of its chain.
struct Halvings {
  int across = 0, down = 0;
};
inline Halvings halvings(int width, int height, std::int64_t level) {
  const auto of = [level](int side) {
    const std::int64_t most = std::bit_width(static_cast<unsigned>(side)) - 1;
    return static_cast<int>(std::min(level, most));
  };
  return {of(width), of(height)};
}

class MipChains {
 public:
  MipChains() = default;
  // Without chains in the configuration there are none. Throws InputError where a texture can have none.
  MipChains(const Config& config, const Scene& scene);
  // Brings the chains to what the scene has become since that version of it.
  void update(const DrawnScene& scene, std::uint64_t since);
  // The chain of a texture of the scene, null for null; the scene's textures have not moved.
  const MipChain* of(const Texture* texture) const {
    return texture == nullptr ? nullptr : &chains_[static_cast<std::size_t>(texture - first_)];
  }
  // By the texture's place in the scene; empty without chains.
  const std::vector<MipChain>& all() const { return chains_; }

 private:
  const Texture* first_ = nullptr;
  std::vector<MipChain> chains_;
};

}  // namespace bitspan::model
