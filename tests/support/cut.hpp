// SPDX-License-Identifier: Apache-2.0
// A scene in memory, given in pieces as a stream is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "scene/scene.hpp"

namespace bitspan {

// Gives a scene in pieces of that many triangles, one per call, and null behind the last one. A piece has the
// scene's view; the `before` of its commands counts from its first triangle.
class Cut {
 public:
  Cut(const Scene& scene, std::size_t size) : scene_(scene), size_(size) {}
  const Scene* operator()() {
    if (first_ > 0 && first_ >= scene_.triangles.size()) return nullptr;
    const std::size_t end = std::min(first_ + size_, scene_.triangles.size());
    piece_ = with_view(scene_);
    piece_.triangles.assign(scene_.triangles.begin() + static_cast<std::ptrdiff_t>(first_),
                            scene_.triangles.begin() + static_cast<std::ptrdiff_t>(end));
    for (DrawCommand command : scene_.commands) {
      if (command.before < first_ || (command.before >= end && end < scene_.triangles.size())) continue;
      command.before -= first_;
      piece_.commands.push_back(std::move(command));
    }
    first_ = end;
    return &piece_;
  }

 private:
  const Scene& scene_;
  Scene piece_;
  std::size_t size_, first_ = 0;
};

}  // namespace bitspan
