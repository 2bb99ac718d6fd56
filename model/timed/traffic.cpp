// SPDX-License-Identifier: Apache-2.0
#include "model/timed/traffic.hpp"

#include <bit>

#include "scene/texels.hpp"

namespace bitspan::timed {

TextureTraffic::TextureTraffic(const Run& run)
    : filter_(run.config.filter),
      fraction_(run.config.format(FormatId::span_uv).fraction()),
      cache_(run.config.memory.cache_line_bytes, run.config.memory.cache_sets, run.config.memory.cache_ways) {
  // A word that leaves room for half a texel less.
  if (fraction_ >= 1 && fraction_ <= 62 && run.config.format(FormatId::span_uv).word <= 62) {
    shift_ = fraction_;
    half_ = weighs_texels(filter_) ? std::int64_t{1} << (fraction_ - 1) : 0;
  }
  const auto line = static_cast<std::uint64_t>(run.config.memory.cache_line_bytes);
  const auto axis = [&](int size) {
    return Axis{.size = size,
                .power_of_two = std::has_single_bit(static_cast<unsigned>(size)),
                .wrap = run.config.wrap};
  };
  std::uint64_t next = 0;
  for (const Texture& texture : run.scene.textures) {
    images_.push_back({axis(texture.width), axis(texture.height), next, texture.format});
    next += (byte_count(texture) + line - 1) / line * line;
  }
}

int TextureTraffic::misses(int texture, std::int64_t u, std::int64_t v) {
  if (texture < 0) return 0;
  const Image& image = images_[static_cast<std::size_t>(texture)];
  const std::int64_t i = texel(u);
  const std::int64_t j = texel(v);
  const std::int64_t i0 = image.across.wrapped(i);
  const std::int64_t j0 = image.down.wrapped(j);
  int count = misses(image, i0, j0) ? 1 : 0;
  switch (filter_) {
    case TextureFilter::nearest:
      break;
    case TextureFilter::bilinear: {
      const std::int64_t i1 = image.across.wrapped(i + 1);
      const std::int64_t j1 = image.down.wrapped(j + 1);
      count += misses(image, i1, j0) ? 1 : 0;
      count += misses(image, i0, j1) ? 1 : 0;
      count += misses(image, i1, j1) ? 1 : 0;
      break;
    }
  }
  return count;
}

MergeTraffic::MergeTraffic(const Run& run)
    : depth_bytes_(run.depth_bytes()),
      color_read_(run.config.memory, color_bytes),
      color_write_(run.config.memory, color_bytes),
      depth_write_(run.config.memory, depth_bytes_) {}

}  // namespace bitspan::timed
