// SPDX-License-Identifier: Apache-2.0
#include "model/mip_chain.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "engine/mip.hpp"

namespace bitspan::model {
namespace {

Texture halved(const Texture& from) {
  Texture to;
  to.name = from.name;
  to.width = std::max(1, from.width >> 1);
  to.height = std::max(1, from.height >> 1);
  const auto row = static_cast<std::size_t>(from.width) * 4;
  // A side of one texel stands for both texels of a pair.
  const std::size_t right = from.width > 1 ? 4 : 0;
  const std::size_t down = from.height > 1 ? row : 0;
  for (int j = 0; j < to.height; ++j) {
    for (int i = 0; i < to.width; ++i) {
      const std::size_t at = static_cast<std::size_t>(j) * 2 * down + static_cast<std::size_t>(i) * 2 * right;
      for (std::size_t c = at; c < at + 4; ++c) {
        const unsigned sum =
            0U + from.rgba[c] + from.rgba[c + right] + from.rgba[c + down] + from.rgba[c + right + down];
        to.rgba.push_back(static_cast<std::uint8_t>((sum + 2) >> 2));
      }
    }
  }
  return to;
}

}  // namespace

MipChain make_mip_chain(const Texture& texture) {
  MipChain levels{texture};
  while (levels.back().width > 1 || levels.back().height > 1) {
    Texture next = halved(levels.back());
    levels.push_back(std::move(next));
  }
  return levels;
}

MipChains::MipChains(const Config& config, const Scene& scene) {
  if (!has_lod(config)) return;
  check_mip_textures(config, scene);
  first_ = scene.textures.data();
  for (const Texture& texture : scene.textures) chains_.push_back(make_mip_chain(texture));
}

}  // namespace bitspan::model
