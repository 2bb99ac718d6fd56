// SPDX-License-Identifier: Apache-2.0
#include "engine/drawn_scene.hpp"

#include <utility>

namespace bitspan {

void DrawnScene::begin(const Scene& scene) {
  now_ = &scene;
  views_ = Views(scene);
  version_ = view_version_ = 0;
  texture_versions_.clear();
}

void DrawnScene::run(const Target& target) {
  views_.select(target.k);
  take_view();
}

void DrawnScene::run(const ViewChange& change) {
  views_.change(change);
  take_view();
}

void DrawnScene::run(const Copy& copy, const Frame& frame, int depth_bits) {
  Texture texture;
  texture.name = now_->textures.at(static_cast<std::size_t>(copy.texture)).name;
  texture.width = frame.width;
  texture.height = frame.height;
  if (copy.plane == CopyPlane::color) {
    texture.rgba = frame.color;
  } else {
    texture.format = TexelFormat::depth;
    texture.raw.resize(4 * frame.depth.size());
    auto out = texture.raw.begin();
    for (const std::uint32_t code : frame.depth) {
      const std::uint32_t word = code << (32 - depth_bits);  // the code's top bit on the word's
      for (int at = 0; at < 32; at += 8) *out++ = static_cast<std::uint8_t>(word >> at);
    }
  }
  set_texture(static_cast<std::size_t>(copy.texture), std::move(texture));
}

void DrawnScene::set_texture(std::size_t index, Texture texture) {
  own().textures.at(index) = std::move(texture);
  texture_versions_.resize(own_.textures.size());
  texture_versions_[index] = ++version_;
}

Scene& DrawnScene::own() {
  if (now_ != &own_) {
    own_.name = now_->name;
    own_.textures = now_->textures;
    static_cast<View&>(own_) = *now_;
    now_ = &own_;
  }
  return own_;
}

void DrawnScene::take_view() {
  if (static_cast<const View&>(*now_) == views_.now()) return;
  static_cast<View&>(own()) = views_.now();
  view_version_ = ++version_;
}

}  // namespace bitspan
