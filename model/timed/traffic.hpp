// SPDX-License-Identifier: Apache-2.0
// What the fragments ask of the memory. Which of them need a request follows from the order they come in, and
// not from the clocks they come on; so both modes share it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "config/modes.hpp"
#include "model/numeric/exact.hpp"
#include "model/timed/cache.hpp"
#include "model/timed/memory.hpp"
#include "model/timed/run.hpp"

namespace bitspan::timed {

// The cache of a buffer; none where the configuration has none.
std::optional<Cache> make_buffer_cache(const Run& run, std::string_view name, const BufferCache& cache);
// The first two accesses of a stage with such a cache: a replaced line's write, a line's read.
inline unsigned line_asks(const Cache::LookUp& found) {
  return (found.writes_back ? 1U : 0U) | (found.fetches ? 2U : 0U);
}

// depth: reads the stored code of each fragment that it tests; with the stencil test it reads the plane's
// value, too, and writes it where it changes.
class DepthTraffic {
 public:
  explicit DepthTraffic(const Run& run);
  // A line's write and read with a cache, the code's read without, the stencil plane's read and write.
  const std::array<Access, 5>& accesses() const { return accesses_; }
  // Of a fragment that is tested; without the stencil test `stencil` is not read.
  Asks ask(const model::Pipeline& pipeline, std::size_t pixel, bool passed, const StencilRecord& stencil) {
    const std::uint64_t address = pixel * depth_bytes_;
    unsigned asks = 0;
    if (cache_) {
      asks = line_asks(cache_->look_up(address, false));
      // Its line is there, whatever becomes of the fragment behind the tests.
      if (passed && pipeline.state.depth_write) cache_->look_up(address, true);
    } else if (depth_.access(address)) {
      asks = 4;
    }
    if (!pipeline.stencil.test) return static_cast<Asks>(asks);
    if (stencil_read_.access(pixel)) asks |= 8U;
    if (stencil.value != stencil.stored && stencil_write_.access(pixel)) asks |= 16U;
    return static_cast<Asks>(asks);
  }
  void cleared(const Clear& clear) {
    if (cache_ && clear.depth) cache_->flush();
  }
  // Its planes are elsewhere in memory from here on.
  void target_changed() {
    if (cache_) cache_->flush();
    for (WordRegister* word : {&depth_, &stencil_read_, &stencil_write_}) word->forget();
  }
  const std::optional<Cache>& cache() const { return cache_; }

 private:
  std::uint64_t depth_bytes_;
  WordRegister depth_, stencil_read_, stencil_write_;
  std::optional<Cache> cache_;
  std::array<Access, 5> accesses_;
};

// texture: the texels of each fragment through the cache.
class TextureTraffic {
 public:
  explicit TextureTraffic(const Run& run);
  // The scene is another one than at that version: the cache forgets the texels where a texture is.
  void scene_changed(const Run& run, std::uint64_t since);
  // Lines to fetch, 4 per level and unit.
  const std::array<Access, 16>& accesses() const { return accesses_; }
  // Of a fragment that comes to texture, by the first unit alone; texture: -1 for none, u and v raw. Without
  // mip chains `lod` is not read.
  Asks ask(const TexelLookup& by, int texture, std::int64_t u, std::int64_t v, const LodRecord& lod) {
    return asks_of(misses(by, texture, u, v, lod));
  }
  // The same by both units, the first one's texels before the second one's.
  Asks ask(const model::Pipeline& pipeline, const FragmentItem& item) {
    const FragmentRecord& f = item.fragment;
    const int first =
        misses(model::lookup_at(pipeline.texture, item.lod), item.surface.texture, f.u, f.v, item.lod);
    const model::TextureStage& second = pipeline.texture_second.fetch;
    if (!pipeline.project.is_on) {
      FragmentRecord own;
      const FragmentRecord& at = model::as_second(pipeline.channels, f, &item.channels, own);
      return asks_of(first + misses(model::lookup_at(second, item.second_lod), pipeline.state.texture1, at.u,
                                    at.v, item.second_lod));
    }
    const ProjectRecord& p = item.projected;
    return asks_of(first + (p.inside == 0
                                ? 0
                                : misses(second.lookup, pipeline.state.texture1, p.s, p.t, item.second_lod)));
  }
  const Cache& cache() const { return cache_; }

 private:
  // One axis of a texture.
  struct Axis {
    std::int64_t size = 1;
    bool power_of_two = true;
    int halved = 0;  // from level 0 on
    // -1: outside, where no texel is read.
    std::int64_t wrapped(std::int64_t i, TextureWrap wrap) const {
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
  };
  void place_textures(const Run& run);
  static Asks asks_of(int misses) { return static_cast<Asks>((1U << misses) - 1); }
  int misses(const TexelLookup& by, int texture, std::int64_t u, std::int64_t v, const LodRecord& lod);
  int misses(const TexelLookup& by, const Image& image, std::int64_t u, std::int64_t v);
  bool misses_texel(const Image& image, std::int64_t i, std::int64_t j) {
    if (i < 0 || j < 0 || is_procedural(image.format)) return false;
    if (image.format != TexelFormat::rgba8888) {
      return !cache_.access(image.base + block_at(image.format, static_cast<int>(image.across.size), i, j));
    }
    return !cache_.access(image.base + static_cast<std::uint64_t>(j * image.across.size + i) * color_bytes);
  }
  // Of x = raw 2^-(fraction + halved): floor(x - 1/2) where the filter weighs texels, else floor(x).
  std::int64_t texel(std::int64_t raw, int halved, bool weighs) const {
    if (shift_ >= 0 && halved == 0) return (raw - (weighs ? half_ : 0)) >> shift_;
    return static_cast<std::int64_t>(
        model::floor_of(model::Exact{raw, fraction_ + halved} - model::Exact{weighs ? 1 : 0, 1}));
  }

  int fraction_;
  int shift_ = -1;  // fraction_, where 64 bits are enough
  std::int64_t half_ = 0;
  Cache cache_;
  std::array<Access, 16> accesses_{};
  std::vector<Image> images_;          // each texture, with a mip chain each of its levels
  std::vector<std::size_t> first_of_;  // by texture
};

// merge: reads the stored colour where the fragment blends, writes colour and depth code.
class MergeTraffic {
 public:
  explicit MergeTraffic(const Run& run);
  // A line's write and read with a cache, the colour's read without, the writes of colour and depth code.
  const std::array<Access, 5>& accesses() const { return accesses_; }

  // What a fragment needs of the memory.
  struct Needs {
    bool color_read = false, color_write = true, depth_write = true;
  };
  // a: texture's, raw.
  Needs needs(const model::Pipeline& pipeline, std::int64_t a) const {
    const DrawState& state = pipeline.state;
    // Candidates are held beside the picture, in a memory that answers within the clock.
    if (holds_candidates(state.translucency_pass)) return {false, false, false};
    return {state.color_write && model::reads_stored_color(pipeline.merge, a), state.color_write,
            state.depth_write};
  }
  Asks ask(Needs needs, std::size_t pixel) {
    const std::uint64_t address = pixel * color_bytes;
    unsigned asks = 0;
    if (cache_) {
      if (needs.color_read) asks |= line_asks(cache_->look_up(address, false));
      if (needs.color_write) asks |= line_asks(cache_->look_up(address, true));
    } else if (needs.color_read && color_read_.access(address)) {
      asks |= 4U;
    }
    if (needs.color_write && !keeps_color_ && color_write_.access(address)) asks |= 8U;
    if (needs.depth_write && !keeps_depth_ && depth_write_.access(pixel * depth_bytes_)) asks |= 16U;
    return static_cast<Asks>(asks);
  }
  void cleared(const Clear& clear) {
    if (cache_ && (clear.color || clear.alpha)) cache_->flush();
  }
  // As DepthTraffic's.
  void target_changed() {
    if (cache_) cache_->flush();
    for (WordRegister* word : {&color_read_, &color_write_, &depth_write_}) word->forget();
  }
  const std::optional<Cache>& cache() const { return cache_; }

 private:
  std::uint64_t depth_bytes_;
  WordRegister color_read_, color_write_, depth_write_;
  std::optional<Cache> cache_;
  bool keeps_color_, keeps_depth_;  // in a cache: no write goes to the memory by itself
  std::array<Access, 5> accesses_;
};

// Of all caches that are measured.
void add_reports(const Cache& texture, const DepthTraffic& depth, const MergeTraffic& merge,
                 TimedReport& report);

}  // namespace bitspan::timed
