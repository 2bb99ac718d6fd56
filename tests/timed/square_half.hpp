// SPDX-License-Identifier: Apache-2.0
// A scene small enough to follow each clock and access by hand.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan {

inline StateChange state_change(const std::vector<std::pair<std::string, std::int64_t>>& state) {
  StateChange change;
  for (const auto& [key, value] : state) change.settings.push_back({*find_state_register(key), value});
  return change;
}

// A picture of 8x8 pixels and a triangle of 4 rows with 4, 3, 2 and 1 of them, in a draw state.
inline Scene square_half(const std::vector<std::pair<std::string, std::int64_t>>& state = {},
                         double alpha = 1) {
  Scene scene;
  scene.width = scene.height = 8;
  scene.s_min = 1;
  scene.s_max = 100;
  Triangle t;
  t.v[0] = {{0, 0, 2}, {}};
  t.v[1] = {{4.25, 0, 2}, {}};
  t.v[2] = {{0, 4.25, 2}, {}};
  for (Vertex& v : t.v) v.c = {1, 1, 1, alpha};
  scene.triangles.push_back(t);
  if (!state.empty()) scene.commands.push_back({0, state_change(state)});
  return scene;
}

}  // namespace bitspan
