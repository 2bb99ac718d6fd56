// SPDX-License-Identifier: Apache-2.0
#include "engine/mip.hpp"

#include <bit>
#include <string>

#include "config/modes.hpp"

namespace bitspan {

void check_mip_textures(const Config& config, const Scene& scene) {
  if (!has_lod(config)) return;
  const auto legal = [](int side) {
    return side >= 1 && side <= 1 << max_mip_level && std::has_single_bit(static_cast<unsigned>(side));
  };
  for (const Texture& t : scene.textures) {
    if (legal(t.width) && legal(t.height)) continue;
    throw InputError("scene '" + scene.name + "': texture '" + t.name + "' has " + std::to_string(t.width) +
                     "x" + std::to_string(t.height) +
                     " texels, and texture.mip = " + std::string(to_string(config.mip)) +
                     " needs sides that are powers of two, at most " + std::to_string(1 << max_mip_level));
  }
}

}  // namespace bitspan
