// SPDX-License-Identifier: Apache-2.0
#include "model/timed/traffic.hpp"

#include <bit>
#include <utility>

#include "scene/texels.hpp"

namespace bitspan::timed {

std::optional<Cache> make_buffer_cache(const Run& run, std::string_view name, const BufferCache& cache) {
  if (!has_cache(cache.mode)) return std::nullopt;
  std::optional<Cache> out(std::in_place, CacheShape{cache.line_bytes, cache.sets, cache.ways, cache.hash},
                           keeps_writes(cache.mode));
  out->measure(name, run.watch_caches);
  return out;
}

DepthTraffic::DepthTraffic(const Run& run)
    : depth_bytes_(run.depth_bytes()),
      depth_(run.config.memory, depth_bytes_),
      stencil_read_(run.config.memory, 1),
      stencil_write_(run.config.memory, 1),
      cache_(make_buffer_cache(run, "depth", run.config.memory.depth_cache)) {
  const auto line = static_cast<std::uint64_t>(run.config.memory.depth_cache.line_bytes);
  accesses_ = {{{line, false},
                {line, true},
                {depth_.word_bytes(), true},
                {stencil_read_.word_bytes(), true},
                {stencil_write_.word_bytes(), false}}};
}

TextureTraffic::TextureTraffic(const Run& run)
    : fraction_(run.config.format(FormatId::span_uv).fraction()),
      cache_({run.config.memory.cache_line_bytes, run.config.memory.cache_sets, run.config.memory.cache_ways,
              run.config.memory.cache_hash}) {
  if (run.measures_texture_cache) cache_.measure("texture", run.watch_caches);
  // A word that leaves room for half a texel less.
  if (fraction_ >= 1 && fraction_ <= 62 && run.config.format(FormatId::span_uv).word <= 62) {
    shift_ = fraction_;
    half_ = std::int64_t{1} << (fraction_ - 1);
  }
  const auto line = static_cast<std::uint64_t>(run.config.memory.cache_line_bytes);
  accesses_.fill({line, true});
  place_textures(run);
}

void TextureTraffic::scene_changed(const Run& run, std::uint64_t since) {
  bool others = false;
  for (std::size_t i = 0; i < run.scene->textures.size(); ++i) {
    others = others || run.scene.texture_version(i) > since;
  }
  if (!others) return;
  place_textures(run);
  cache_.flush();
}

void TextureTraffic::place_textures(const Run& run) {
  images_.clear();
  first_of_.clear();
  const auto line = static_cast<std::uint64_t>(run.config.memory.cache_line_bytes);
  const auto axis = [&](int size, int halved) {
    return Axis{
        .size = size, .power_of_two = std::has_single_bit(static_cast<unsigned>(size)), .halved = halved};
  };
  std::uint64_t next = 0;
  const auto place = [&](const Texture& texture, model::Halvings halved) {
    images_.push_back(
        {axis(texture.width, halved.across), axis(texture.height, halved.down), next, texture.format});
    next += (byte_count(texture) + line - 1) / line * line;
  };
  const auto& chains = run.pipeline.mip_chains.all();
  for (std::size_t i = 0; i < run.scene->textures.size(); ++i) {
    first_of_.push_back(images_.size());
    if (chains.empty()) {
      place(run.scene->textures[i], {});
    } else {
      for (std::size_t level = 0; level < chains[i].size(); ++level)
        place(chains[i][level],
              model::halvings(chains[i][0].width, chains[i][0].height, static_cast<std::int64_t>(level)));
    }
  }
}

int TextureTraffic::misses(const TexelLookup& by, int texture, std::int64_t u, std::int64_t v,
                           const LodRecord& lod) {
  if (texture < 0) return 0;
  const auto at = first_of_[static_cast<std::size_t>(texture)] + static_cast<std::size_t>(lod.level);
  const int own = misses(by, images_[at], u, v);
  return lod.f == 0 ? own : own + misses(by, images_[at + 1], u, v);
}

int TextureTraffic::misses(const TexelLookup& by, const Image& image, std::int64_t u, std::int64_t v) {
  const bool weighs = weighs_texels(by.filter);
  const std::int64_t i = texel(u, image.across.halved, weighs);
  const std::int64_t j = texel(v, image.down.halved, weighs);
  const std::int64_t i0 = image.across.wrapped(i, by.wrap_u);
  const std::int64_t j0 = image.down.wrapped(j, by.wrap_v);
  int count = misses_texel(image, i0, j0) ? 1 : 0;
  switch (by.filter) {
    case TextureFilter::nearest:
      break;
    case TextureFilter::bilinear: {
      const std::int64_t i1 = image.across.wrapped(i + 1, by.wrap_u);
      const std::int64_t j1 = image.down.wrapped(j + 1, by.wrap_v);
      count += misses_texel(image, i1, j0) ? 1 : 0;
      count += misses_texel(image, i0, j1) ? 1 : 0;
      count += misses_texel(image, i1, j1) ? 1 : 0;
      break;
    }
  }
  return count;
}

MergeTraffic::MergeTraffic(const Run& run)
    : depth_bytes_(run.depth_bytes()),
      color_read_(run.config.memory, color_bytes),
      color_write_(run.config.memory, color_bytes),
      depth_write_(run.config.memory, depth_bytes_),
      cache_(make_buffer_cache(run, "color", run.config.memory.color_cache)),
      keeps_color_(keeps_writes(run.config.memory.color_cache.mode)),
      keeps_depth_(keeps_writes(run.config.memory.depth_cache.mode)) {
  const auto line = static_cast<std::uint64_t>(run.config.memory.color_cache.line_bytes);
  accesses_ = {{{line, false},
                {line, true},
                {color_read_.word_bytes(), true},
                {color_write_.word_bytes(), false},
                {depth_write_.word_bytes(), false}}};
}

void add_reports(const Cache& texture, const DepthTraffic& depth, const MergeTraffic& merge,
                 TimedReport& report) {
  const auto add = [&](const Cache* cache) {
    if (cache == nullptr) return;
    if (const auto measured = cache->report()) report.caches.push_back(*measured);
  };
  add(&texture);
  add(depth.cache() ? &*depth.cache() : nullptr);
  add(merge.cache() ? &*merge.cache() : nullptr);
}

}  // namespace bitspan::timed
