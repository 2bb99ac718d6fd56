// SPDX-License-Identifier: Apache-2.0
#include "scene/plan.hpp"

#include "config/config.hpp"

namespace bitspan {
namespace {

// The commands stand in front of the pass's triangles: none is left behind the scene's last one.
void append(const Pass& pass, Scene& scene) {
  if (pass.triangles.empty()) {
    throw InputError("pass '" + pass.name + "': has no triangle; expected one at least");
  }
  const auto command = [&](auto what) { scene.commands.push_back({scene.triangles.size(), what}); };
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
    for (int times = 1;; ++times) {
      append(pass, scene);
      const std::uint64_t count = draw(scene, counter);
      if (count == 0) break;
      if (times >= limit) {
        throw InputError("pass '" + pass.name + "': " + counter + " is " + std::to_string(count) +
                         " at repetition " + std::to_string(times) + "; expected 0 by then");
      }
    }
  }
}

}  // namespace bitspan
