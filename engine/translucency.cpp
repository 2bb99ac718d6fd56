// SPDX-License-Identifier: Apache-2.0
#include "engine/translucency.hpp"

#include <array>
#include <utility>

#include "engine/draw_pass.hpp"
#include "scene/plan.hpp"

namespace bitspan {
namespace {

// The triangles from `first` on, which are all that is drawn on the target.
struct LastDraw {
  int target = 0;
  std::size_t first = 0;
};
// Of a scene with triangles. Throws InputError where something else is drawn on that target, or cleared.
LastDraw last_draw(const Scene& scene) {
  LastDraw out;
  std::array<bool, target_limit> is_touched{};
  for (const DrawCommand& command : scene.commands) {
    bool& touched = is_touched[static_cast<std::size_t>(out.target)];
    touched = touched || command.before > out.first || std::holds_alternative<Clear>(command.what) ||
              std::holds_alternative<Resolve>(command.what);
    out.first = command.before;
    if (const auto* target = std::get_if<Target>(&command.what)) out.target = target->k;
  }
  if (!is_touched[static_cast<std::size_t>(out.target)] && out.first < scene.triangles.size()) return out;
  throw InputError(scene.name +
                   ": translucency by passes is for a picture in one draw state; expected no triangle on its "
                   "target in front of its last command, and no clear or resolve there");
}

}  // namespace

Scene in_translucency_passes(Scene scene, Engine& engine) {
  if (scene.triangles.empty()) return scene;
  const auto [target, first] = last_draw(scene);
  const auto in = [](TranslucencyPass pass) {
    StateChange out{.settings = {state_setting("translucency.pass", pass)}};
    // A layer that is resolved is not in front of itself, whatever else the depth test lets pass.
    if (holds_candidates(pass)) out.settings.push_back(state_setting("depth.func", DepthFunc::less));
    return std::vector{out};
  };
  // Opaque fragments first, so that no candidate is held that one of them hides.
  const auto begin = scene.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  Pass opaque{.name = "opaque",
              .target = target,
              .states = in(TranslucencyPass::opaque),
              .triangles = {begin, scene.triangles.end()}};
  Pass translucent{.name = "translucent",
                   .target = target,
                   .resolves = true,
                   .states = in(TranslucencyPass::candidate),
                   .triangles = opaque.triangles,
                   .repeat = Repeat{.counter = "candidates", .limit = translucency_pass_limit}};
  scene.triangles.resize(first);
  engine.begin(scene);
  flatten(std::array{std::move(opaque), std::move(translucent)}, scene, draw_pass(engine));
  return scene;
}

}  // namespace bitspan
