// SPDX-License-Identifier: Apache-2.0
#include "golden/mip_chain.hpp"

#include <algorithm>
#include <cmath>

#include "config/modes.hpp"
#include "engine/mip.hpp"
#include "golden/texel.hpp"

namespace bitspan::golden {

std::vector<Texture> mip_levels(const Texture& texture) {
  std::vector<Texture> levels{texture};
  for (int level = 1; texture.width >> level > 0 || texture.height >> level > 0; ++level) {
    const Texture& finer = levels.back();
    Texture coarser;
    coarser.name = texture.name;
    coarser.width = std::max(texture.width >> level, 1);
    coarser.height = std::max(texture.height >> level, 1);
    coarser.rgba.resize(4 * static_cast<std::size_t>(coarser.width) *
                        static_cast<std::size_t>(coarser.height));
    const auto code = [&finer](int i, int j, int channel) {
      const int column = std::min(i, finer.width - 1);
      const int row = std::min(j, finer.height - 1);
      return static_cast<double>(fetch_texel(finer, column, row)[static_cast<std::size_t>(channel)]);
    };
    std::size_t at = 0;
    for (int j = 0; j < coarser.height; ++j) {
      for (int i = 0; i < coarser.width; ++i) {
        for (int channel = 0; channel < 4; ++channel) {
          const double mean = (code(2 * i, 2 * j, channel) + code(2 * i + 1, 2 * j, channel) +
                               code(2 * i, 2 * j + 1, channel) + code(2 * i + 1, 2 * j + 1, channel)) /
                              4;
          coarser.rgba[at++] = static_cast<std::uint8_t>(std::floor(mean + 0.5));
        }
      }
    }
    levels.push_back(std::move(coarser));
  }
  return levels;
}

SceneLevels scene_levels(const Config& config, const Scene& scene) {
  if (!has_lod(config)) return {};
  check_mip_textures(config, scene);
  SceneLevels out;
  for (const Texture& texture : scene.textures) out.push_back(mip_levels(texture));
  return out;
}

}  // namespace bitspan::golden
