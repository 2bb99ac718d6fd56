// SPDX-License-Identifier: Apache-2.0
// The scene of a run as its commands leave it. Storage, and no arithmetic: so golden and the model share it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/frame.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// It is the caller's scene until a command makes it another one, and then a copy without triangles and
// commands. Versions tell an engine what has changed since it prepared something: each change has a number of
// its own, from 1 on, and begin() is 0. Textures move in memory when the version becomes another one.
class DrawnScene {
 public:
  DrawnScene() = default;
  DrawnScene(const DrawnScene&) = delete;
  DrawnScene& operator=(const DrawnScene&) = delete;
  // The scene must outlive the run.
  void begin(const Scene& scene);
  bool has_begun() const { return now_ != nullptr; }
  // With the view of the target that is drawn on.
  const Scene& operator*() const { return *now_; }
  const Scene* operator->() const { return now_; }

  const Views& views() const { return views_; }
  std::uint64_t version() const { return version_; }
  std::uint64_t view_version() const { return view_version_; }
  std::uint64_t texture_version(std::size_t index) const {
    return index < texture_versions_.size() ? texture_versions_[index] : 0;
  }

  // As Engine::execute says, of the view alone.
  void run(const Target& target);
  void run(const ViewChange& change);
  // frame: of the target that is copied; depth_bits: of its codes.
  void run(const Copy& copy, const Frame& frame, int depth_bits);
  // Puts a texture of the same size in the place of one.
  void set_texture(std::size_t index, Texture texture);

 private:
  Scene& own();
  void take_view();

  const Scene* now_ = nullptr;
  Scene own_;
  Views views_;
  std::uint64_t version_ = 0, view_version_ = 0;
  std::vector<std::uint64_t> texture_versions_;  // empty before the first change
};

}  // namespace bitspan
