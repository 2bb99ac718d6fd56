// SPDX-License-Identifier: Apache-2.0
#include "engine/translucency.hpp"

#include <array>
#include <utility>

#include "engine/draw_pass.hpp"
#include "scene/plan.hpp"

namespace bitspan {

Scene in_translucency_passes(Scene scene, Engine& engine) {
  if (scene.triangles.empty()) return scene;
  std::vector<StateChange> states;
  for (const DrawCommand& command : scene.commands) {
    const auto* change = std::get_if<StateChange>(&command.what);
    if (change == nullptr || command.before > 0) {
      throw InputError(scene.name +
                       ": translucency by passes is for a scene with one draw state and one target; expected "
                       "no commands but changes of state in front of the first triangle");
    }
    states.push_back(*change);
  }
  const auto in = [&](TranslucencyPass pass) {
    std::vector<StateChange> out = states;
    StateChange& last = out.emplace_back();
    last.settings = {state_setting("translucency.pass", pass)};
    // A layer that is resolved is not in front of itself, whatever else the depth test lets pass.
    if (holds_candidates(pass)) last.settings.push_back(state_setting("depth.func", DepthFunc::less));
    return out;
  };
  // Opaque fragments first, so that no candidate is held that one of them hides.
  Pass opaque{
      .name = "opaque", .states = in(TranslucencyPass::opaque), .triangles = std::move(scene.triangles)};
  Pass translucent{.name = "translucent",
                   .resolves = true,
                   .states = in(TranslucencyPass::candidate),
                   .triangles = opaque.triangles,
                   .repeat = Repeat{.counter = "candidates", .limit = translucency_pass_limit}};
  scene.triangles.clear();
  scene.commands.clear();
  engine.begin(scene);
  flatten(std::array{std::move(opaque), std::move(translucent)}, scene, draw_pass(engine));
  return scene;
}

}  // namespace bitspan
