// SPDX-License-Identifier: Apache-2.0
#include "scene/plan.hpp"

#include <algorithm>

#include "config/config.hpp"

namespace bitspan {
namespace {

// The commands stand in front of the pass's triangles: none is left behind the scene's last one.
void append(const Pass& pass, Scene& scene) {
  if (pass.triangles.empty()) {
    throw InputError("pass '" + pass.name + "': has no triangle; expected one at least");
  }
  const auto command = [&](auto what) { scene.commands.push_back({scene.triangles.size(), what}); };
  if (pass.resolves) command(Resolve{});
  for (const Copy& copy : pass.copies) command(copy);
  command(Target{pass.target});
  if (pass.view) command(*pass.view);
  for (const StateChange& state : pass.states) command(state);
  if (pass.clear) command(*pass.clear);
  scene.triangles.insert(scene.triangles.end(), pass.triangles.begin(), pass.triangles.end());
}

}  // namespace

void flatten(std::span<const Pass> passes, Scene& scene, const DrawPass& draw) {
  for (const Pass& pass : passes) {
    if (!pass.repeat) {
      append(pass, scene);
      continue;
    }
    const auto& [counter, limit] = *pass.repeat;
    if (!draw) {
      throw InputError("pass '" + pass.name + "': is repeated; expected an engine that counts " + counter);
    }
    draw(scene, counter);  // what stands in front of it is not in its count
    Pass again = pass;
    for (int times = 1;; ++times) {
      append(again, scene);
      const std::vector<bool> added = draw(scene, counter);
      const auto left = std::ranges::count(added, true);
      if (left == 0) break;
      if (times >= limit) {
        throw InputError("pass '" + pass.name + "': " + std::to_string(left) + " triangles add to " +
                         counter + " at repetition " + std::to_string(times) + "; expected none by then");
      }
      auto flag = added.begin();
      std::erase_if(again.triangles, [&](const Triangle&) { return !*flag++; });
    }
  }
}

}  // namespace bitspan
