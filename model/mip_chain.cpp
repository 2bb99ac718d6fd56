// SPDX-License-Identifier: Apache-2.0
#include "model/mip_chain.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "engine/mip.hpp"
#include "model/stages/texel.hpp"

namespace bitspan::model {
namespace {

Texture halved(const Texture& from) {
  Texture to;
  to.name = from.name;
  to.width = std::max(1, from.width >> 1);
  to.height = std::max(1, from.height >> 1);
  // A side of one texel stands for both texels of a pair.
  const int right = from.width > 1 ? 1 : 0;
  const int down = from.height > 1 ? 1 : 0;
  for (int j = 0; j < to.height; ++j) {
    for (int i = 0; i < to.width; ++i) {
      const int x = 2 * right * i;
      const int y = 2 * down * j;
      const TexelCodes four[] = {texel_of(from, x, y), texel_of(from, x + right, y),
                                 texel_of(from, x, y + down), texel_of(from, x + right, y + down)};
      for (std::size_t c = 0; c < 4; ++c) {
        const unsigned sum = 0U + four[0][c] + four[1][c] + four[2][c] + four[3][c];
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

void MipChains::update(const DrawnScene& scene, std::uint64_t since) {
  first_ = scene->textures.data();
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    if (scene.texture_version(i) > since) chains_[i] = make_mip_chain(scene->textures[i]);
  }
}

}  // namespace bitspan::model
