// SPDX-License-Identifier: Apache-2.0
// A picture in passes: what is drawn on which target, with which view and state, in which order. A plan
// becomes a scene, whose commands every engine executes; docs/adding.md, "A pass plan".
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan {

// A register of the draw state, by its key, takes a value.
inline StateSetting state_setting(std::string_view key, std::int64_t value) {
  return {*find_state_register(key), value};
}
template <class E>
requires std::is_enum_v<E> StateSetting state_setting(std::string_view key, E value) {
  return state_setting(key, static_cast<std::int64_t>(value));
}

// A pass is appended again with those of its triangles that added to a counter of the engine, until none did.
// Throws InputError where one still does at `limit` times in all.
struct Repeat {
  std::string counter;
  int limit = 64;
};

struct Pass {
  std::string name;  // for messages
  int target = 0;
  std::optional<ViewChange> view{};
  bool resolves = false;              // what the target in force holds, in front of all else
  std::vector<Copy> copies{};         // behind that
  std::vector<StateChange> states{};  // behind the view
  std::optional<Clear> clear{};       // behind the states
  std::vector<Triangle> triangles{};  // one at least
  std::optional<Repeat> repeat{};
};

// Draws what the scene has had appended since the call before, and returns which of those triangles added to
// the counter.
using DrawPass = std::function<std::vector<bool>(const Scene& scene, const std::string& counter)>;

// Appends the commands and triangles of the passes to a scene, which has a view and textures already. draw:
// an engine that has begun with the scene; needed where a pass is repeated. Throws InputError where a pass
// has no triangle.
void flatten(std::span<const Pass> passes, Scene& scene, const DrawPass& draw = {});

}  // namespace bitspan
