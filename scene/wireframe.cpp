// SPDX-License-Identifier: Apache-2.0
#include "scene/wireframe.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "scene/plan.hpp"

namespace bitspan {

namespace {

using Place = std::array<double, 3>;
Place place_of(const ScreenPoint& p) { return {p.x, p.y, p.s}; }

std::vector<Triangle> edges_of(const std::vector<Triangle>& triangles) {
  std::set<std::pair<Place, Place>> seen;
  std::vector<Triangle> out;
  for (const Triangle& triangle : triangles) {
    const std::size_t edges = triangle.is_line ? 1 : 3;
    for (std::size_t i = 0; i < edges; ++i) {
      const Vertex& from = triangle.v[i];
      const Vertex& to = triangle.v[(i + 1) % 3];
      std::pair ends{place_of(from), place_of(to)};
      if (ends.second < ends.first) std::swap(ends.first, ends.second);
      if (!seen.insert(ends).second) continue;
      out.push_back({.v = {from, to, to}, .is_line = true});
    }
  }
  return out;
}

}  // namespace

int wireframe_bias(int depth_bits) { return 1 << std::max(0, depth_bits - 8); }

Scene wireframe(Scene scene, const WireframeOptions& options) {
  for (const DrawCommand& command : scene.commands) {
    if (command.before > 0 || !std::holds_alternative<StateChange>(command.what)) {
      throw InputError(
          scene.name +
          ": a wire frame is of one draw state and one target; expected no commands but changes of "
          "state in front of the first triangle");
    }
  }
  std::vector<Triangle> lines = edges_of(scene.triangles);
  if (!hides_lines(options.kind)) {
    scene.triangles = std::move(lines);
    scene.quadrics.clear();  // no triangle of theirs is left
    return scene;
  }
  const auto state = [&](std::size_t before, std::vector<StateSetting> settings) {
    scene.commands.push_back({.before = before, .what = StateChange{.settings = std::move(settings)}});
  };
  state(0, {state_setting("color.write", 0)});
  state(scene.triangles.size(), {state_setting("color.write", 1), state_setting("depth.bias", options.bias)});
  scene.triangles.insert(scene.triangles.end(), lines.begin(), lines.end());
  return scene;
}

}  // namespace bitspan
