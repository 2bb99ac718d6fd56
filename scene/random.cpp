// SPDX-License-Identifier: Apache-2.0
#include "scene/random.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "scene/exact.hpp"
#include "scene/geometry.hpp"
#include "scene/plan.hpp"
#include "scene/procedural.hpp"
#include "scene/shadow.hpp"
#include "scene/texels.hpp"

namespace bitspan {

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) {
    seed += 0x9e3779b97f4a7c15;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::bits() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

std::int64_t Random::integer(std::int64_t low, std::int64_t high) {
  const std::uint64_t range = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
  if (range == 0) return static_cast<std::int64_t>(bits());
  // Values beyond the last whole multiple of the range would favour the low results.
  const std::uint64_t limit = ~std::uint64_t{0} - ~std::uint64_t{0} % range;
  std::uint64_t draw = bits();
  while (draw >= limit) draw = bits();
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + draw % range);
}

double Random::unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

double Random::uniform(double low, double high) { return low + (high - low) * unit(); }

double Random::log_uniform(double low, double high) {
  if (!(low < high)) return low;
  const int octaves = std::ilogb(high / low);
  while (true) {
    const double octave = std::ldexp(low, static_cast<int>(integer(0, octaves)));
    const double value = octave * (1 + unit());
    if (value <= high) return value;
  }
}

bool Random::chance(double probability) { return unit() < probability; }

namespace {

Texture random_texture(Random& random, int index, const RandomOptions& options) {
  Texture texture;
  texture.name = "random" + std::to_string(index) + ".png";
  texture.width = static_cast<int>(random.integer(1, options.texture_size_max));
  texture.height = static_cast<int>(random.integer(1, options.texture_size_max));
  // No draw where there is nothing to decide: a seed of before gives the scene of before.
  const bool powers = options.power_of_two_probability > 0 && random.chance(options.power_of_two_probability);
  if (options.mip_chains || powers) {
    texture.width = static_cast<int>(std::bit_floor(static_cast<unsigned>(texture.width)));
    texture.height = static_cast<int>(std::bit_floor(static_cast<unsigned>(texture.height)));
  }
  const bool has_alpha = random.chance(0.4);
  const bool has_holes = random.chance(0.5);
  const std::size_t texels =
      static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  texture.rgba.reserve(texels * 4);
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint64_t draw = random.bits();
    const bool hole = has_holes && (draw >> 32) % 8 == 0;  // the transparent code T4
    const auto byte = [draw](unsigned shift) { return static_cast<std::uint8_t>(draw >> shift); };
    texture.rgba.push_back(hole ? 255 : byte(0));
    texture.rgba.push_back(hole ? 0 : byte(8));
    texture.rgba.push_back(hole ? 255 : byte(16));
    // A fifth of the texels each clear and opaque, the rest between.
    std::uint8_t alpha = 255;
    if (has_alpha) {
      const std::uint64_t kind = (draw >> 40) % 5;
      alpha = kind == 0 ? std::uint8_t{0} : kind == 1 ? std::uint8_t{255} : byte(24);
    }
    texture.rgba.push_back(alpha);
  }
  return texture;
}

// A position on one of several grids: ties of the snap, pixel centres and pixel borders come up often.
double on_grid(Random& random, double value) {
  constexpr double grids[] = {0x1p-10, 0x1p-5, 0x1p-4, 0.5, 1};
  const double grid = random.chance(0.7) ? 0x1p-10 : grids[random.integer(0, 4)];
  return std::floor(value / grid) * grid;
}

Triangle random_triangle(Random& random, const Scene& scene, const RandomOptions& options) {
  Triangle triangle;
  const double size = random.log_uniform(options.size_min, options.size_max);
  const double x = random.uniform(-size / 4, scene.width + size / 4);
  const double y = random.uniform(-size / 4, scene.height + size / 4);
  const bool same_depth = random.chance(0.15);  // no perspective
  const bool same_edge = random.chance(0.15);   // a horizontal or vertical edge
  const bool any_color = random.chance(0.7);
  const bool translucent = random.chance(options.translucent_probability);
  const double uv = random.log_uniform(1, options.uv_limit);
  const double base_s = random.log_uniform(scene.s_min, scene.s_max);
  const bool local_s = random.chance(0.5);  // like a real surface: depth in proportion to size
  for (Vertex& v : triangle.v) {
    v.x = on_grid(random, x + random.uniform(-size / 2, size / 2));
    v.y = on_grid(random, y + random.uniform(-size / 2, size / 2));
    v.s = local_s ? base_s * random.uniform(0.75, 1.25) : random.log_uniform(scene.s_min, scene.s_max);
    if (same_depth) v.s = base_s;
    if (random.chance(0.03)) v.s = random.chance(0.5) ? scene.s_min : scene.s_max;
    v.s = std::clamp(v.s, scene.s_min, scene.s_max);
    v.u = std::floor(random.uniform(-uv, uv) * 0x1p12) * 0x1p-12;
    v.v = std::floor(random.uniform(-uv, uv) * 0x1p12) * 0x1p-12;
    if (any_color) {
      for (std::size_t i = 0; i < 3; ++i) v.c[i] = static_cast<double>(random.integer(0, 1 << 16)) * 0x1p-16;
    }
    if (translucent) v.c[3] = static_cast<double>(random.integer(0, 1 << 16)) * 0x1p-16;
  }
  if (same_edge) {
    if (random.chance(0.5)) {
      triangle.v[1].y = triangle.v[0].y;
    } else {
      triangle.v[1].x = triangle.v[0].x;
    }
  }
  if (!scene.textures.empty() && random.chance(0.85)) {
    triangle.texture =
        static_cast<int>(random.integer(0, static_cast<std::int64_t>(scene.textures.size()) - 1));
  }
  return triangle;
}

std::array<std::uint8_t, 3> random_color(Random& random) {
  const std::uint64_t draw = random.bits();
  return {static_cast<std::uint8_t>(draw), static_cast<std::uint8_t>(draw >> 8),
          static_cast<std::uint8_t>(draw >> 16)};
}

// Registers of levels of detail: later still, and drawn by a generator of their own.
bool is_level_register(std::string_view key) {
  return key.ends_with(".lod.bias") || key.find(".level.") != std::string_view::npos ||
         key.ends_with(".magnify");
}

bool is_projection_register(std::string_view key) {
  constexpr auto registers = std::to_array<std::string_view>(
      {"texture1.coordinates", "texture1.outside", "texture1.compare", "texture1.func", "texture1.bias"});
  return std::ranges::find(registers, key) != registers.end();
}

// Registers that a function of their own draws: draw_projection, draw_translucency.
bool is_drawn_apart(std::string_view key) {
  return is_projection_register(key) || key == "translucency.pass";
}

}  // namespace

bool is_later_register(std::string_view key) {
  constexpr auto later = std::to_array<std::string_view>(
      {"alpha.zero", "color.mask", "target.round", "stencil.back.ref", "stencil.back.mask",
       "stencil.back.write", "texture.filter", "texture.wrap.u", "texture.wrap.v", "texture1.filter",
       "texture1.wrap.u", "texture1.wrap.v"});
  return is_drawn_apart(key) || is_level_register(key) || std::ranges::find(later, key) != later.end();
}

namespace {

// "stencil" of "stencil.back.fail".
std::string_view unit_of_register(std::string_view key) { return key.substr(0, key.find('.')); }
// A factor of the blend; the factor `half` came later, too.
bool is_factor(const StateRegister& r) { return !r.names.empty() && r.names.back() == "half"; }
std::vector<std::string_view> units_of_registers(const RandomOptions& options) {
  std::vector<std::string_view> out;
  for (const StateRegister& r : state_registers()) {
    const bool of_target = r.key.starts_with("target.") || r.key.starts_with("chroma.");
    if (of_target && !options.targets) continue;
    if (r.key.starts_with("texture1") && !options.second_texture) continue;
    if (is_later_register(r.key)) continue;
    if (out.empty() || out.back() != unit_of_register(r.key)) out.push_back(unit_of_register(r.key));
  }
  return out;
}

// Values that do something: most of a scissor's legal ones are outside of the picture.
std::int64_t random_value(Random& random, const StateRegister& r, const Scene& scene,
                          const RandomOptions& options) {
  if (r.key.ends_with(".filter")) return random.integer(r.low, options.weighed_texels ? r.high : r.low);
  if (r.key.find(".wrap.") != std::string_view::npos)
    return random.integer(r.low, options.every_wrap ? r.high : r.low + 1);
  if (r.key.ends_with(".magnify")) return random.integer(r.low, options.weighed_texels ? r.high : r.high - 1);
  // A chain of few levels has levels on either side of both ends, and rarely the least one is above the
  // other.
  if (r.key.ends_with(".level.least"))
    return random.chance(0.2) ? random.integer(r.low, r.high) : random.integer(0, 2);
  if (r.key.ends_with(".level.greatest"))
    return random.chance(0.2) ? random.integer(r.low, r.high) : random.integer(0, 5);
  if (r.key == "scissor.left" || r.key == "scissor.top") {
    return random.integer(0, (r.key == "scissor.left" ? scene.width : scene.height) / 2);
  }
  if (r.key == "scissor.right" || r.key == "scissor.bottom") {
    const int size = r.key == "scissor.right" ? scene.width : scene.height;
    return random.integer(size / 2, size + 1);
  }
  if (r.key == "depth.bias") return random.integer(-4096, 4096);
  if (r.key == "texture1") return random.integer(-1, static_cast<std::int64_t>(scene.textures.size()) - 1);
  // A range that holds neither every texel nor hardly any.
  if (r.key.starts_with("chroma.low.")) return random.integer(0, 160);
  if (r.key.starts_with("chroma.high.")) return random.integer(96, 255);
  // All bits but a few: a picture without any pixel tells nothing.
  if (r.key == "stipple") return random.integer(r.low, r.high) | random.integer(r.low, r.high);
  if (is_factor(r)) return random.integer(r.low, r.high - 1);
  return random.integer(r.low, r.high);
}

DrawCommand random_command(Random& random, Random& later, Random& levels, const Scene& scene,
                           DrawState& state, const RandomOptions& options) {
  if (random.chance(0.1)) {
    Clear clear;
    if (random.chance(0.3)) clear.color = random_color(random);
    if (random.chance(0.3)) clear.alpha = static_cast<std::uint8_t>(random.integer(0, 255));
    clear.depth = random.chance(0.5);
    if (random.chance(0.3)) clear.stencil = static_cast<std::uint8_t>(random.integer(0, 255));
    if (clear == Clear{}) clear.depth = true;
    clear.masked = options.later_registers && later.chance(0.5);
    return {.what = clear};
  }
  StateChange change;
  change.reset = random.chance(0.25);
  // Each register once, as in a line of a stream.
  const auto set = [&](std::size_t index, std::int64_t value) {
    std::erase_if(change.settings, [&](const StateSetting& s) { return s.index == index; });
    change.settings.push_back({index, value});
  };
  const std::vector<std::string_view> units = units_of_registers(options);
  for (auto n = random.integer(1, 4); n > 0; --n) {
    const std::string_view unit =
        units[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(units.size()) - 1))];
    if (unit == "stencil" && !options.late_tests) continue;
    // A stencil register does nothing without the test.
    if (unit == "stencil" && random.chance(0.9)) set(*find_state_register("stencil.test"), 1);
    // Nor do the others of the second texture unit while it is off.
    if (unit == "texture1" && random.chance(0.9)) {
      const std::size_t index = *find_state_register("texture1");
      set(index, random_value(random, state_registers()[index], scene, options));
    }
    for (std::size_t index = 0; index < state_registers().size(); ++index) {
      const StateRegister& r = state_registers()[index];
      if (unit_of_register(r.key) != unit || r.key == "stencil.test" || is_later_register(r.key)) continue;
      if (!random.chance(0.4)) continue;
      if (!options.late_tests && r.key == "depth.when") continue;
      set(index, random_value(random, r, scene, options));
    }
  }
  for (std::size_t index = 0; options.later_registers && index < state_registers().size(); ++index) {
    const StateRegister& r = state_registers()[index];
    if (r.key.starts_with("texture1") && !options.second_texture) continue;
    if (is_drawn_apart(r.key)) continue;
    if (is_level_register(r.key)) {
      if (options.level_registers && levels.chance(0.2)) set(index, random_value(levels, r, scene, options));
      continue;
    }
    if (is_later_register(r.key) && later.chance(0.2)) set(index, random_value(later, r, scene, options));
    if (is_factor(r) && later.chance(0.1)) set(index, r.high);
  }
  try {
    state = changed_state(state, change, {});
  } catch (const InputError&) {
    // The one rule between registers.
    set(*find_state_register("depth.when"), static_cast<std::int64_t>(DepthWhen::late));
    state = changed_state(state, change, {});
  }
  return {.what = change};
}

// The ends of 0..1 come often.
double unit_value(Random& random) { return std::clamp(random.uniform(-0.25, 1.25), 0.0, 1.0); }

}  // namespace

Scene random_scene(std::uint64_t seed, const RandomOptions& options) {
  Random random(seed);
  Scene scene;
  scene.name = "random-" + std::to_string(seed);
  scene.width = options.width;
  scene.height = options.height;
  scene.s_min = random.log_uniform(0x1p-6, 64);
  scene.s_max =
      scene.s_min * random.log_uniform(std::min(1.25, options.depth_ratio_max), options.depth_ratio_max);
  scene.focal = random.uniform(0.5, 2) * options.width;
  scene.background = random_color(random);
  if (random.chance(options.fog_probability)) {
    scene.fog = Fog{random_color(random), random.uniform(0.1, 1) * scene.s_max};
  }
  const auto textures = random.integer(0, options.textures);
  for (int i = 0; i < textures; ++i) scene.textures.push_back(random_texture(random, i, options));
  scene.triangles.reserve(static_cast<std::size_t>(options.triangles));
  while (scene.triangles.size() < static_cast<std::size_t>(options.triangles)) {
    Triangle triangle = random_triangle(random, scene, options);
    if (options.stacked_probability > 0 && !scene.triangles.empty() &&
        random.chance(options.stacked_probability)) {
      for (std::size_t i = 0; i < triangle.v.size(); ++i) {
        triangle.v[i].x = scene.triangles.back().v[i].x;
        triangle.v[i].y = scene.triangles.back().v[i].y;
      }
    }
    if (orientation(triangle) != 0) scene.triangles.push_back(triangle);
  }
  // Last, so that a scene's triangles do not depend on them.
  DrawState state = first_state({});
  Random targets(~seed);  // its own, so that nothing else of a scene depends on its targets
  Random later(~seed ^ 0x5851f42d4c957f2d);
  Random levels(~seed ^ 0x2545f4914f6cdd1d);
  const double target_probability = options.several_targets ? options.command_probability / 4 : 0;
  for (std::size_t i = 0; options.command_probability > 0 && i < scene.triangles.size(); ++i) {
    if (targets.chance(target_probability)) {
      scene.commands.push_back({.before = i, .what = Target{static_cast<int>(targets.integer(0, 2))}});
    }
    if (!random.chance(options.command_probability)) continue;
    scene.commands.push_back(random_command(random, later, levels, scene, state, options));
    scene.commands.back().before = i;
  }
  return scene;
}

void draw_pass(Random& random, Scene& scene) {
  if (scene.textures.empty() || scene.triangles.size() < 2) return;
  const auto last = static_cast<std::int64_t>(scene.triangles.size()) - 1;
  const auto begin = static_cast<std::size_t>(random.integer(0, last - 1));
  const auto end = static_cast<std::size_t>(random.integer(static_cast<std::int64_t>(begin) + 1, last));
  const auto texture = random.integer(0, static_cast<std::int64_t>(scene.textures.size()) - 1);
  const Texture& image = scene.textures[static_cast<std::size_t>(texture)];
  // Above those of random_scene, so that no other command draws on it.
  const auto own = static_cast<int>(random.integer(3, target_limit - 1));
  ViewChange view{.width = image.width, .height = image.height};
  // All distances stay in the range.
  if (random.chance(0.5)) view.s_min = scene.s_min * random.uniform(0.8, 1);
  if (random.chance(0.5)) view.s_max = scene.s_max * random.uniform(1, 1.25);
  if (random.chance(0.5)) view.focal = random.uniform(1, 1000);
  if (random.chance(0.5)) view.background = random_color(random);
  if (random.chance(0.5)) {
    view.fog = random.chance(0.5)
                   ? std::optional(Fog{random_color(random), random.uniform(0.1, 1) * scene.s_max})
                   : std::nullopt;
  }
  const auto plane = random.chance(0.5) ? CopyPlane::color : CopyPlane::depth;
  const std::vector<DrawCommand> first{{begin, Target{own}}, {begin, view}};
  const std::vector<DrawCommand> then{{end, Copy{own, plane, static_cast<int>(texture)}},
                                      {end, Target{target_at(scene.commands, begin)}}};
  // What else changes the target in between would draw elsewhere.
  std::erase_if(scene.commands, [&](const DrawCommand& c) {
    return c.before > begin && c.before <= end && std::holds_alternative<Target>(c.what);
  });
  const auto insert = [&](std::size_t before, const std::vector<DrawCommand>& commands) {
    const auto at =
        std::ranges::find_if(scene.commands, [&](const DrawCommand& c) { return c.before > before; });
    scene.commands.insert(at, commands.begin(), commands.end());
  };
  insert(begin, first);
  insert(end, then);
}

void draw_lines(Random& random, Scene& scene, double probability) {
  for (Triangle& triangle : scene.triangles) {
    if (!random.chance(probability)) continue;
    triangle.is_line = true;
    if (random.chance(0.5)) std::swap(triangle.v[0], triangle.v[1]);
    // Level, upright and diagonal lines, and points, which seldom come by themselves.
    if (random.chance(0.1)) triangle.v[1].x = triangle.v[0].x;
    if (random.chance(0.1)) triangle.v[1].y = triangle.v[0].y;
    if (random.chance(0.1)) triangle.v[1].y = triangle.v[0].y + triangle.v[1].x - triangle.v[0].x;
    triangle.v[2] = triangle.v[1];
  }
}

void draw_given_attributes(Random& random, Scene& scene, double probability) {
  for (Triangle& triangle : scene.triangles) {
    if (!random.chance(probability)) continue;
    for (Vertex& v : triangle.v) v.fog = unit_value(random);
  }
  // project_* are of draw_projection. These came later, and so stand behind fog, whose numbers stay.
  for (Triangle& triangle : scene.triangles) {
    if (random.chance(probability)) {
      for (Vertex& v : triangle.v) v.z = unit_value(random);
    }
    if (!random.chance(probability)) continue;
    for (Vertex& v : triangle.v) {
      v.u2 = random.uniform(-40, 40);
      v.v2 = random.uniform(-40, 40);
    }
  }
}

namespace {

// Puts a command in front of a triangle, behind the others there.
template <class What>
void put_before(Scene& scene, std::size_t triangle, What what) {
  const auto at =
      std::ranges::find_if(scene.commands, [&](const DrawCommand& c) { return c.before > triangle; });
  scene.commands.insert(at, {.before = triangle, .what = std::move(what)});
}

}  // namespace

void draw_translucency(Random& random, Scene& scene) {
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (random.chance(0.125)) put_before(scene, i, Resolve{});
    if (i > 0 && !random.chance(0.125)) continue;
    put_before(scene, i, StateChange{.settings = {state_setting("translucency.pass", random.integer(0, 2))}});
  }
  put_before(scene, scene.triangles.size(), Resolve{});
}

void draw_projection(Random& random, Scene& scene) {
  if (scene.textures.empty()) return;
  const auto texture = random.integer(0, static_cast<std::int64_t>(scene.textures.size()) - 1);
  const Texture& image = scene.textures[static_cast<std::size_t>(texture)];
  const double middle = std::sqrt(scene.s_min * scene.s_max);
  Viewpoint view;
  view.width = image.width;
  view.height = image.height;
  view.focal = image.width * random.log_uniform(0.25, 4);
  view.position = Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * middle;
  look_at(view, view.position, {random.uniform(-1, 1), random.uniform(-1, 1), 2 * middle}, {0, -1, 0});
  give_projection(scene.triangles, scene, view);
  scene.projector.emplace();
  scene.projector->s_min = middle * random.log_uniform(0.01, 1);
  scene.projector->s_max = scene.projector->s_min * random.log_uniform(1.5, 1000);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (i > 0 && !random.chance(0.125)) continue;
    const StateChange change{.settings = {state_setting("texture1", texture),
                                          state_setting("texture1.coordinates", random.chance(0.875) ? 1 : 0),
                                          state_setting("texture1.outside", random.integer(0, 1)),
                                          state_setting("texture1.compare", random.integer(0, 1)),
                                          state_setting("texture1.func", random.integer(0, 7)),
                                          state_setting("texture1.bias", random.integer(-4096, 4096)),
                                          state_setting("texture1.red", random.integer(0, 255))}};
    put_before(scene, i, change);
  }
}

LightTaken light_taken(const Config& config) {
  return {.point = has_light_points(config),
          .lunar = has_lunar(config),
          .fall = has_light_fall(config),
          .map = has_relief(config),
          .shadow = has_light_shadow(config)};
}

void draw_light(Random& random, Scene& scene, const LightTaken& takes) {
  const auto direction = [&random] {
    return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  };
  Light& light = scene.light.emplace();
  light.is_point = takes.point && random.chance(0.75);
  const double size =
      light.is_point ? scene.s_max * random.log_uniform(0.01, 4) : random.log_uniform(1e-6, 1e6);
  const Vec3 place = direction() * size;
  light.place = {place.x, place.y, light.is_point ? std::abs(place.z) : place.z};
  light.ambient = unit_value(random);
  light.specular = unit_value(random) * (1 - light.ambient);
  light.exponent = static_cast<int>(random.log_uniform(1, light_exponent_limit + 0.5));
  if (takes.lunar && random.chance(0.75)) light.lunar = random.log_uniform(0.01, light_lunar_limit);
  if (takes.fall && random.chance(0.75)) {
    light.reach = scene.s_max * random.log_uniform(random.chance(0.25) ? 0x1p-15 : 0.01, 4);
    light.offset = random.chance(0.5) ? 0 : random.log_uniform(0.01, light_offset_limit);
  }
  for (Triangle& triangle : scene.triangles) {
    if (random.chance(0.125)) continue;
    // Of a face, or of each vertex; toward the viewer more often than not.
    const bool is_flat = random.chance(0.25);
    Vec3 normal{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (i == 0 || !is_flat) {
        normal = direction();
        if (random.chance(0.75)) normal.z = -std::abs(normal.z);
        if (random.chance(0.75)) normal = of_length_1(normal);
      }
      set_normal(triangle.v[i], normal);
    }
  }
  if (!(takes.map || takes.shadow) || scene.textures.empty()) return;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const bool is_flat = random.chance(0.5);
    Vec3 field{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == 0 || !is_flat) field = direction() * random.log_uniform(1, 4000);
      Vertex& v = scene.triangles[i].v[k];
      v.lx = field.x;
      v.ly = field.y;
      v.lz = field.z;
    }
    if (!random.chance(0.25)) continue;
    const auto texture = random.integer(0, static_cast<std::int64_t>(scene.textures.size()) - 1);
    const bool is_shadow = takes.shadow && (!takes.map || random.chance(0.5));
    const auto op = !random.chance(0.75) ? TextureOp::modulate
                    : is_shadow          ? TextureOp::shadow
                                         : TextureOp::relief;
    put_before(
        scene, i,
        StateChange{.settings = {state_setting("texture1", texture), state_setting("texture1.op", op)}});
  }
}

void draw_texel_formats(Random& random, Scene& scene, double probability) {
  for (Texture& texture : scene.textures) {
    if (!random.chance(probability)) continue;
    // Depth codes come from copies.
    const auto last = static_cast<std::int64_t>(TexelFormat::noise);
    const auto format = static_cast<TexelFormat>(random.integer(1, last));
    const int table_size = texel_layout(format).table_size;
    if (is_procedural(format)) {
      texture = random_procedural(random, format, texture.width, texture.height);
      continue;
    }
    if (table_size == 0) {
      texture = converted(texture, format, {});
      continue;
    }
    texture.format = format;
    texture.rgba.clear();
    texture.raw.resize(raw_size(format, texture.width, texture.height));
    for (std::uint8_t& byte : texture.raw) byte = static_cast<std::uint8_t>(random.integer(0, 255));
    for (int k = 0; k < table_size; ++k) {
      const bool is_signed = table_size == yiq_table_size && k >= 16;
      texture.table.push_back(static_cast<std::int16_t>(random.integer(is_signed ? -256 : 0, 255)));
    }
  }
}

}  // namespace bitspan
