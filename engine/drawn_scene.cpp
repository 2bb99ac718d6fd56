// SPDX-License-Identifier: Apache-2.0
#include "engine/drawn_scene.hpp"

namespace bitspan {

void DrawnScene::begin(const Scene& scene) {
  now_ = &scene;
  views_ = Views(scene);
  version_ = view_version_ = 0;
}

void DrawnScene::run(const Target& target) {
  views_.select(target.k);
  take_view();
}

void DrawnScene::run(const ViewChange& change) {
  views_.change(change);
  take_view();
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
