// SPDX-License-Identifier: Apache-2.0
// What the fragments ask of the memory. Which of them need a request follows from the order they come in, and
// not from the clocks they come on; so both modes share it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "config/modes.hpp"
#include "model/numeric/exact.hpp"
#include "model/timed/cache.hpp"
#include "model/timed/memory.hpp"
#include "model/timed/run.hpp"

namespace bitspan::timed {

// depth: reads the stored code of each covered fragment.
class DepthTraffic {
 public:
  explicit DepthTraffic(const Run& run) : bytes_(run.depth_bytes()), word_(run.config.memory, bytes_) {}
  std::uint64_t word_bytes() const { return word_.word_bytes(); }
  // True where the pixel's code has to be read.
  bool access(std::size_t pixel) { return word_.access(pixel * bytes_); }

 private:
  std::uint64_t bytes_;
  WordRegister word_;
};

// texture: the texels of each fragment through the cache.
class TextureTraffic {
 public:
  explicit TextureTraffic(const Run& run);
  // The lines to fetch for a fragment that comes to texture, 0..4 per level; texture: -1 for none, u and v
  // raw. Without mip chains `lod` is not read.
  int misses(int texture, std::int64_t u, std::int64_t v, const LodRecord& lod);
  const Cache& cache() const { return cache_; }

 private:
  // One axis of a texture.
  struct Axis {
    std::int64_t size = 1;
    bool power_of_two = true;
    bool clamp = false;
    std::int64_t wrapped(std::int64_t i) const {
      if (clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
      if (power_of_two) return i & (size - 1);
      const std::int64_t rest = i % size;
      return rest < 0 ? rest + size : rest;
    }
  };
  struct Image {
    Axis across, down;
    std::uint64_t base = 0;  // byte address
    int level = 0;
  };
  int misses(const Image& image, std::int64_t u, std::int64_t v);
  bool misses_texel(const Image& image, std::int64_t i, std::int64_t j) {
    return !cache_.access(image.base + static_cast<std::uint64_t>(j * image.across.size + i) * color_bytes);
  }
  // Of x = raw 2^-(fraction + level): floor(x - 1/2) where the filter weighs texels, else floor(x).
  std::int64_t texel(std::int64_t raw, int level) const {
    if (shift_ >= 0 && level == 0) return (raw - half_) >> shift_;
    return static_cast<std::int64_t>(model::floor_of(model::Exact{raw, fraction_ + level} -
                                                     model::Exact{weighs_texels(filter_) ? 1 : 0, 1}));
  }

  TextureFilter filter_;
  int fraction_;
  int shift_ = -1;  // fraction_, where 64 bits are enough
  std::int64_t half_ = 0;
  Cache cache_;
  std::vector<Image> images_;          // each texture, with a mip chain each of its levels
  std::vector<std::size_t> first_of_;  // by texture
};

// The least raw alpha that is 1 or more: a fragment with less is mixed.
std::int64_t opaque_alpha(const Config& config);

// merge: reads the stored colour where the fragment blends, writes colour and depth code.
class MergeTraffic {
 public:
  explicit MergeTraffic(const Run& run);

  struct Ask {
    bool color_read = false, color_write = false, depth_write = false;  // put in this order
  };
  // a: texture's, raw.
  bool blends(std::int64_t a) const { return a < opaque_; }
  Ask access(bool blends, std::size_t pixel) {
    return {blends && color_read_.access(pixel * color_bytes), color_write_.access(pixel * color_bytes),
            depth_write_.access(pixel * depth_bytes_)};
  }
  std::uint64_t color_word_bytes() const { return color_read_.word_bytes(); }
  std::uint64_t depth_word_bytes() const { return depth_write_.word_bytes(); }

 private:
  std::int64_t opaque_;
  std::uint64_t depth_bytes_;
  WordRegister color_read_, color_write_, depth_write_;
};

}  // namespace bitspan::timed
