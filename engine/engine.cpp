// SPDX-License-Identifier: Apache-2.0
#include "engine/engine.hpp"

#include <algorithm>

namespace bitspan {

std::span<const DrawCommand> commands_of(const Scene& scene, std::size_t first, std::size_t count) {
  const std::size_t last = first + count;
  const auto begin = std::ranges::lower_bound(scene.commands, first, {}, &DrawCommand::before);
  const auto end = last == scene.triangles.size()
                       ? scene.commands.end()
                       : std::ranges::lower_bound(scene.commands, last, {}, &DrawCommand::before);
  return {begin, std::max(begin, end)};
}

void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count, Trace* trace) {
  draw_scene(engine, scene, first, count, static_cast<std::int64_t>(first), trace);
}

void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count,
                std::int64_t first_index, Trace* trace) {
  const std::size_t last = first + count;
  const auto draw = [&](std::size_t end) {
    engine.draw(std::span(scene.triangles).subspan(first, end - first), first_index, trace);
    first_index += static_cast<std::int64_t>(end - first);
    first = end;
  };
  for (const DrawCommand& command : commands_of(scene, first, count)) {
    if (command.before > first) draw(command.before);
    engine.execute(command, first_index, trace);
  }
  // A call without triangles still delivers the constants.
  if (first < last || count == 0) draw(last);
}

}  // namespace bitspan
