// SPDX-License-Identifier: Apache-2.0
#include "scene/draw_state.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <type_traits>

#include "config/check.hpp"
#include "scene/scene.hpp"

namespace bitspan {
namespace {

constexpr std::array<std::string_view, 2> truth_names{"false", "true"};

template <class T>
constexpr StateRegister make_register(std::string_view key, std::int64_t low, std::int64_t high,
                                      std::string_view meaning) {
  if constexpr (std::is_enum_v<T>) {
    return {key, enum_names<T>, false, 0, static_cast<std::int64_t>(enum_names<T>.size()) - 1, meaning};
  } else if constexpr (std::is_same_v<T, bool>) {
    return {key, truth_names, true, 0, 1, meaning};
  } else {
    return {key, {}, false, low, high, meaning};
  }
}

constexpr auto registers = std::to_array<StateRegister>({
#define BITSPAN_STATE_REGISTER(A, type, member, key, low, high, first, meaning) \
  make_register<type>(key, low, high, meaning),
    BITSPAN_DRAW_STATE(BITSPAN_STATE_REGISTER, )
#undef BITSPAN_STATE_REGISTER
});

void set_register(DrawState& state, std::size_t index, std::int64_t value) {
  std::size_t i = 0;
#define BITSPAN_SET_REGISTER(A, type, member, key, low, high, first, meaning) \
  if (i++ == index) state.member = static_cast<type>(value);
  BITSPAN_DRAW_STATE(BITSPAN_SET_REGISTER, )
#undef BITSPAN_SET_REGISTER
}

// What a configuration violates with another filter. One that is not legal itself (Config{}) takes any.
std::optional<Violation> violation_by(TextureFilter filter, Config config) {
  if (filter == config.filter || first_violation(config)) return std::nullopt;
  config.filter = filter;
  return first_violation(config);
}

void check_filter(const char* key, TextureFilter filter, const Config& config) {
  const auto violation = violation_by(filter, config);
  if (!violation) return;
  throw InputError(std::string(key) + ": is " + std::string(to_string(filter)) + ", for which " +
                   violation->key + " " + violation->text);
}

}  // namespace

bool takes_filter(const Config& config, TextureFilter filter) { return !violation_by(filter, config); }

DrawState first_state(const Config& c) {
  DrawState state;
#define BITSPAN_FIRST_VALUE(A, type, member, key, low, high, first, meaning) state.member = first;
  BITSPAN_DRAW_STATE(BITSPAN_FIRST_VALUE, )
#undef BITSPAN_FIRST_VALUE
  return state;
}

bool masks_pixels(const DrawState& s) {
  return s.scissor_left > 0 || s.scissor_top > 0 || s.scissor_right < scissor_limit ||
         s.scissor_bottom < scissor_limit || s.stipple != 0xffffffff;
}

std::span<const StateRegister> state_registers() { return registers; }

std::optional<std::size_t> find_state_register(std::string_view key) {
  const auto found = std::ranges::find(registers, key, &StateRegister::key);
  if (found == registers.end()) return std::nullopt;
  return static_cast<std::size_t>(found - registers.begin());
}

std::vector<std::int64_t> state_values(const DrawState& state) {
  return {
#define BITSPAN_STATE_VALUE(A, type, member, key, low, high, first, meaning) \
  static_cast<std::int64_t>(state.member),
      BITSPAN_DRAW_STATE(BITSPAN_STATE_VALUE, )
#undef BITSPAN_STATE_VALUE
  };
}

DrawState changed_state(DrawState state, const StateChange& change, const Config& config) {
  if (change.reset) state = first_state(config);
  for (const StateSetting& setting : change.settings) set_register(state, setting.index, setting.value);
  // Fragments that the texture kills behind an early test would have changed the stencil plane already.
  if (state.stencil_test && state.depth_when == DepthWhen::early) {
    throw InputError(
        "depth.when: \"early\" is not legal with stencil.test, because a fragment that the texture kills "
        "would change the stencil plane; expected \"late\"");
  }
  // A configuration that is not legal itself (Config{}) takes any.
  if (takes_projection(state.texture1_coordinates) && !has_project(config.project) &&
      !first_violation(config)) {
    throw InputError(
        "texture1.coordinates: is project, and the configuration has project.unit = none; expected uv, or "
        "project.unit = reciprocal");
  }
  check_filter("texture.filter", state.texture_filter, config);
  check_filter("texture1.filter", state.texture1_filter, config);
  check_filter("texture.magnify", first_magnified(state).filter, config);
  check_filter("texture1.magnify", second_magnified(state).filter, config);
  return state;
}

DrawState changed_state(const DrawState& state, const StateChange& change, const Config& config,
                        std::size_t textures) {
  const DrawState next = changed_state(state, change, config);
  if (next.texture1 >= 0 && static_cast<std::size_t>(next.texture1) >= textures) {
    throw InputError("texture1: texture " + std::to_string(next.texture1) +
                     " does not exist, the scene has " + std::to_string(textures) + "; expected -1 to " +
                     std::to_string(static_cast<std::int64_t>(textures) - 1));
  }
  return next;
}

std::vector<DrawState> states_of(const Config& config, std::span<const DrawCommand> commands) {
  std::vector<DrawState> out = all_states_of(config, commands);
  out.erase(out.begin());
  return out;
}

std::vector<DrawState> all_states_of(const Config& config, std::span<const DrawCommand> commands) {
  std::vector<DrawState> out{first_state(config)};
  for (const DrawCommand& command : commands) {
    if (const auto* change = std::get_if<StateChange>(&command.what)) {
      out.push_back(changed_state(out.back(), *change, config));
    }
  }
  return out;
}

std::vector<int> targets_of(std::span<const DrawCommand> commands) {
  std::set<int> out{0};
  for (const DrawCommand& command : commands) {
    if (const auto* target = std::get_if<Target>(&command.what)) out.insert(target->k);
  }
  return {out.begin(), out.end()};
}

void check_target(int k) {
  if (k >= 0 && k < target_limit) return;
  throw InputError("target: " + std::to_string(k) + " does not exist; expected 0.." +
                   std::to_string(target_limit - 1));
}

void Views::select(int k) {
  check_target(k);
  std::optional<View>& view = of_[static_cast<std::size_t>(k)];
  if (!view) view = now();
  target_ = k;
}

void Views::change(const ViewChange& change) {
  View& view = *of_[static_cast<std::size_t>(target_)];
  view = changed_view(view, change);
}

void Views::execute(const DrawCommand& command) {
  if (const auto* target = std::get_if<Target>(&command.what)) select(target->k);
  if (const auto* view = std::get_if<ViewChange>(&command.what)) change(*view);
}

bool may_change_view(const DrawCommand& command) {
  return std::holds_alternative<ViewChange>(command.what) || std::holds_alternative<Target>(command.what);
}

bool changes_scene(std::span<const DrawCommand> commands) {
  return std::ranges::any_of(commands, [](const DrawCommand& c) {
    return std::holds_alternative<ViewChange>(c.what) || std::holds_alternative<Copy>(c.what);
  });
}

int target_at(std::span<const DrawCommand> commands, std::size_t index) {
  int out = 0;
  for (const DrawCommand& command : commands) {
    if (command.before > index) break;
    if (const auto* target = std::get_if<Target>(&command.what)) out = target->k;
  }
  return out;
}

void check_copy(const Scene& scene, const Views& views, const Copy& copy) {
  const auto& textures = scene.textures;
  if (copy.texture < 0 || static_cast<std::size_t>(copy.texture) >= textures.size()) {
    throw InputError("copy.texture: " + std::to_string(copy.texture) + " does not exist, the scene has " +
                     std::to_string(textures.size()) + " textures; expected an index below");
  }
  check_target(copy.target);
  const std::optional<View>& view = views.of(copy.target);
  if (!view) {
    throw InputError("copy.target: " + std::to_string(copy.target) +
                     " has not been drawn on; expected a line {\"target\": " + std::to_string(copy.target) +
                     "} in front");
  }
  const Texture& texture = textures[static_cast<std::size_t>(copy.texture)];
  if (texture.width == view->width && texture.height == view->height) return;
  const auto size = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  throw InputError("copy: texture " + std::to_string(copy.texture) + " has " +
                   size(texture.width, texture.height) + " texels, target " + std::to_string(copy.target) +
                   " has " + size(view->width, view->height) + " pixels; expected the same size");
}

View view_at(const Scene& scene, std::size_t index) {
  Views views(scene);
  for (const DrawCommand& command : scene.commands) {
    if (command.before > index) break;
    views.execute(command);
  }
  return views.now();
}

void check_commands(const Config& config, const Scene& scene) {
  DrawState state = first_state(config);
  Views views(scene);
  for (const DrawCommand& command : scene.commands) {
    views.execute(command);
    if (const auto* copy = std::get_if<Copy>(&command.what)) check_copy(scene, views, *copy);
    if (const auto* change = std::get_if<StateChange>(&command.what)) {
      state = changed_state(state, *change, config, scene.textures.size());
    }
  }
}

void erase_triangles(Scene& scene, std::size_t first, std::size_t count) {
  const auto from = scene.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  scene.triangles.erase(from, from + static_cast<std::ptrdiff_t>(count));
  for (DrawCommand& command : scene.commands) {
    if (command.before > first)
      command.before = std::max(first, command.before - std::min(count, command.before));
  }
  const auto moved = [&](std::size_t at) {
    return at <= first ? at : std::max(first, at - std::min(count, at));
  };
  for (Quadric& q : scene.quadrics) {
    const std::size_t end = moved(q.first + q.count);
    q.first = moved(q.first);
    q.count = end - q.first;
  }
  std::erase_if(scene.quadrics, [](const Quadric& q) { return q.count == 0; });
}

}  // namespace bitspan
