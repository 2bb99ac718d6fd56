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
    TextureWrap wrap = TextureWrap::cyclic;
    // -1: outside, where no texel is read.
    std::int64_t wrapped(std::int64_t i) const {
      switch (wrap) {
        case TextureWrap::clamp:
          return std::clamp<std::int64_t>(i, 0, size - 1);
        case TextureWrap::border:
          return i >= 0 && i < size ? i : -1;
        case TextureWrap::cyclic:
          return modulo(i, size);
        case TextureWrap::mirror: {
          const std::int64_t at = modulo(i, 2 * size);
          return at < size ? at : 2 * size - 1 - at;
        }
      }
      unreachable();
    }
    std::int64_t modulo(std::int64_t i, std::int64_t period) const {
      if (power_of_two) return i & (period - 1);
      const std::int64_t rest = i % period;
      return rest < 0 ? rest + period : rest;
    }
  };
  struct Image {
    Axis across, down;
    std::uint64_t base = 0;  // byte address
    TexelFormat format = TexelFormat::rgba8888;
    int level = 0;
  };
  int misses(const Image& image, std::int64_t u, std::int64_t v);
  bool misses_texel(const Image& image, std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0) return false;
    if (image.format != TexelFormat::rgba8888) {
      return !cache_.access(image.base + block_at(image.format, static_cast<int>(image.across.size), i, j));
    }
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

// merge: reads the stored colour where the fragment blends, writes colour and depth code.
class MergeTraffic {
 public:
  explicit MergeTraffic(const Run& run);

  struct Ask {
    bool color_read = false, color_write = false, depth_write = false;  // put in this order
  };
  // What a fragment needs of the memory.
  struct Needs {
    bool color_read = false, color_write = true, depth_write = true;
  };
  // a: texture's, raw.
  Needs needs(const model::Pipeline& pipeline, std::int64_t a) const {
    const DrawState& state = pipeline.state;
    return {state.color_write && model::reads_stored_color(pipeline.merge, a), state.color_write,
            state.depth_write};
  }
  Ask access(Needs needs, std::size_t pixel) {
    return {needs.color_read && color_read_.access(pixel * color_bytes),
            needs.color_write && color_write_.access(pixel * color_bytes),
            needs.depth_write && depth_write_.access(pixel * depth_bytes_)};
  }
  std::uint64_t color_word_bytes() const { return color_read_.word_bytes(); }
  std::uint64_t depth_word_bytes() const { return depth_write_.word_bytes(); }

 private:
  std::uint64_t depth_bytes_;
  WordRegister color_read_, color_write_, depth_write_;
};

}  // namespace bitspan::timed
