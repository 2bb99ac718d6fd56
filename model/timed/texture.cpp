#include "model/timed/texture.hpp"

#include <algorithm>

namespace bitspan::timed {
namespace {

std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
  return (i % size + size) % size;
}

}  // namespace

TextureStage::TextureStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
    : PipeStage("texture", run.timing(Stage::texture), in, &out, run.fragments, &memory,
                Memory::Port::texture, run.config.memory.latency),
      run_(run),
      cache_(run.config.memory.cache_line_bytes, run.config.memory.cache_sets, run.config.memory.cache_ways) {
  const auto line = static_cast<std::uint64_t>(run.config.memory.cache_line_bytes);
  std::uint64_t next = 0;
  for (const Texture& texture : run.scene.textures) {
    base_.push_back(next);
    next += (texture.rgba.size() + line - 1) / line * line;
  }
}

bool TextureStage::enters(FragmentItem& item) {
  const Texture* image =
      item.texture < 0 ? nullptr : &run_.scene.textures[static_cast<std::size_t>(item.texture)];
  const model::TextureStage& stage = run_.pipeline.texture;
  const bool lives = model::texture(stage, image, item.fragment, item.texel);
  if (run_.trace != nullptr) run_.trace->texture.push_back(item.texel);

  if (image != nullptr && stage.filter == TextureFilter::nearest) {
    look_up(item.texture, item.texel.i, item.texel.j);
  } else if (image != nullptr) {
    const auto corner = [&](std::int64_t raw) {
      return static_cast<std::int64_t>(model::floor_of(model::value_of(raw, stage.uv) - model::Exact{1, 1}));
    };
    const std::int64_t i = corner(item.fragment.u);
    const std::int64_t j = corner(item.fragment.v);
    for (const std::int64_t dj : {0, 1}) {
      for (const std::int64_t di : {0, 1}) {
        look_up(item.texture, wrapped(i + di, image->width, stage.wrap),
                wrapped(j + dj, image->height, stage.wrap));
      }
    }
  }
  if (!lives) ++run_.counters.killed;
  return lives;
}

void TextureStage::look_up(int texture, std::int64_t i, std::int64_t j) {
  const auto number = static_cast<std::size_t>(texture);
  const auto texel = static_cast<std::uint64_t>(j * run_.scene.textures[number].width + i);
  if (!cache_.access(base_[number] + texel * color_bytes)) {
    ask_read(static_cast<std::uint64_t>(run_.config.memory.cache_line_bytes));
  }
}

}  // namespace bitspan::timed
