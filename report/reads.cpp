// SPDX-License-Identifier: Apache-2.0
#include "report/reads.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "golden/mip_chain.hpp"
#include "golden/sampling.hpp"

namespace bitspan {
namespace {

// A unit of the draw state, as "stencil" of "stencil.back.fail", and a stage that reads its registers. Where
// a scissor or the stipple keeps a fragment from being drawn, depth has no record of it.
struct UnitOfStage {
  std::string_view unit;
  RecordType stage;
};
constexpr std::array units{UnitOfStage{"scissor", RecordType::depth},
                           UnitOfStage{"stipple", RecordType::depth},
                           UnitOfStage{"depth", RecordType::depth},
                           UnitOfStage{"stencil", RecordType::stencil},
                           UnitOfStage{"texture", RecordType::lod},
                           UnitOfStage{"texture1", RecordType::project},
                           UnitOfStage{"chroma", RecordType::texture},
                           UnitOfStage{"alpha", RecordType::texture},
                           UnitOfStage{"texture", RecordType::texture},
                           UnitOfStage{"texture1", RecordType::texture},
                           UnitOfStage{"chroma", RecordType::texture_second},
                           UnitOfStage{"alpha", RecordType::texture_second},
                           UnitOfStage{"texture", RecordType::texture_second},
                           UnitOfStage{"texture1", RecordType::texture_second},
                           UnitOfStage{"translucency", RecordType::texture},
                           UnitOfStage{"translucency", RecordType::texture_second},
                           UnitOfStage{"translucency", RecordType::candidate},
                           UnitOfStage{"color", RecordType::merge},
                           UnitOfStage{"depth", RecordType::merge},
                           UnitOfStage{"blend", RecordType::merge},
                           UnitOfStage{"logic", RecordType::merge},
                           UnitOfStage{"target", RecordType::merge},
                           UnitOfStage{"color", RecordType::merge_alpha},
                           UnitOfStage{"blend", RecordType::merge_alpha},
                           UnitOfStage{"logic", RecordType::merge_alpha},
                           UnitOfStage{"target", RecordType::merge_alpha}};

// The texels of a fragment.
class Texels : golden::Sampling<golden::Quad> {
 public:
  Texels(const Config& config, const TexelLookup& by) : Sampling(config), by_(by) {}

  // texture: that level of `whole`.
  void add(const Texture& whole, const Texture& texture, std::int64_t level, std::int64_t u, std::int64_t v,
           std::vector<Read>& out) const {
    const golden::Quad across = golden::Quad(texture.width) / golden::Quad(whole.width);
    const golden::Quad down = golden::Quad(texture.height) / golden::Quad(whole.height);
    const golden::Quad half = weighs_texels(by_.filter) ? 0.5 : 0;
    const std::int64_t i = golden::to_integer(golden::floor_of(q_uv_.value(u) * across - half));
    const std::int64_t j = golden::to_integer(golden::floor_of(q_uv_.value(v) * down - half));
    const int side = weighs_texels(by_.filter) ? 2 : 1;
    for (int k = 0; k < side * side; ++k) {
      const std::int64_t column = wrapped(i + k % side, texture.width, by_.wrap_u);
      const std::int64_t row = wrapped(j + k / side, texture.height, by_.wrap_v);
      std::string codes = fmt::format("{}", fmt::join(fetch(texture, column, row), " "));
      // What a shadow map compares.
      if (texture.format == TexelFormat::depth && !in_border(texture, column, row))
        codes += fmt::format(", word {:#010x}", golden::depth_word(texture, column, row));
      out.push_back({fmt::format("texel ({}, {}) of level {}", column, row, level), std::move(codes)});
    }
  }

 private:
  TexelLookup by_;
};

const RecordCopy* fed_by(const Divergence& d, RecordType type) {
  const auto found = std::ranges::find(d.upstream, type, &RecordCopy::type);
  return found == d.upstream.end() ? nullptr : &*found;
}

std::int64_t field(const RecordCopy& record, std::string_view name) {
  return record.values[static_cast<std::size_t>(field_index(record.type, name))];
}

// texture: index into the scene's, or -1. chosen: the record that has the level, null without levels. Of lod
// and project, the texture alone.
void add_texels(const Divergence& d, const Config& config, const Scene& scene, int texture,
                const TexelLookup& by, const RecordCopy* chosen, std::vector<Read>& out) {
  const RecordCopy* fragment = fed_by(d, RecordType::fragment);
  if (texture < 0 || fragment == nullptr) return;
  const Texture& image = scene.textures[static_cast<std::size_t>(texture)];
  out.push_back({"texture", fmt::format("{} {}, {}x{}", texture, image.name, image.width, image.height)});
  // The size tells the last level, and what is inside.
  if (d.type == RecordType::lod || d.type == RecordType::project) return;
  const Texels texels(config, by);
  if (const RecordCopy* projected = fed_by(d, RecordType::project); projected != nullptr) {
    if (field(*projected, "inside") == 0) return;
    texels.add(image, image, 0, field(*projected, "s"), field(*projected, "t"), out);
    return;
  }
  const std::int64_t u = field(*fragment, "u");
  const std::int64_t v = field(*fragment, "v");
  if (!has_lod(config) || chosen == nullptr) {
    texels.add(image, image, 0, u, v, out);
    return;
  }
  const std::vector<Texture> levels = golden::mip_levels(image);
  const auto last = static_cast<std::int64_t>(levels.size()) - 1;
  const std::int64_t level = std::clamp<std::int64_t>(field(*chosen, "level"), 0, last);
  texels.add(image, levels[static_cast<std::size_t>(level)], level, u, v, out);
  if (field(*chosen, "f") == 0 || level == last) return;
  texels.add(image, levels[static_cast<std::size_t>(level + 1)], level + 1, u, v, out);
}

// The planes that a stage reads or writes at the pixel, as they stood in front of the triangle.
void add_pixel(const Divergence& d, const Frame& frame, std::vector<Read>& out) {
  if (!d.x || !d.y || *d.x < 0 || *d.y < 0 || *d.x >= frame.width || *d.y >= frame.height) return;
  const auto pixel = static_cast<std::size_t>(*d.y * frame.width + *d.x);
  if (d.type == RecordType::merge || d.type == RecordType::merge_alpha) {
    const auto rgba = std::span(frame.color).subspan(4 * pixel, 4);
    out.push_back({"stored color", fmt::format("{}", fmt::join(rgba, " "))});
  }
  out.push_back({"stored depth", fmt::format("{}", frame.depth[pixel])});
  if (!frame.stencil.empty()) out.push_back({"stored stencil", fmt::format("{}", frame.stencil[pixel])});
}

bool reads_pixel(RecordType type) {
  return type == RecordType::depth || type == RecordType::stencil || type == RecordType::merge ||
         type == RecordType::merge_alpha;
}

// The state in force for a triangle.
DrawState state_at(const Config& config, const Scene& scene, std::size_t triangle) {
  const auto end = std::ranges::upper_bound(scene.commands, triangle, {}, &DrawCommand::before);
  return all_states_of(config, {scene.commands.begin(), end}).back();
}

// The pixels as triangle `count` finds them.
const Frame& frame_in_front_of(const Scene& scene, std::size_t count, Scene& front, Engine& engine) {
  front = scene;
  front.triangles.resize(count);
  std::erase_if(front.commands, [&](const DrawCommand& command) { return command.before > count; });
  engine.begin(front);
  draw_scene(engine, front, 0, count, nullptr);
  return engine.frame();
}

}  // namespace

bool reads_register(RecordType type, std::string_view key) {
  const std::string_view unit = key.substr(0, key.find('.'));
  return std::ranges::any_of(units, [&](const UnitOfStage& u) { return u.stage == type && u.unit == unit; });
}

void add_reads(Divergence& d, const Config& config, const Scene& scene, Engine& engine) {
  if (d.type == RecordType::count || !d.triangle || *d.triangle < 0 ||
      static_cast<std::size_t>(*d.triangle) >= scene.triangles.size()) {
    return;
  }
  const auto index = static_cast<std::size_t>(*d.triangle);
  const Triangle& triangle = scene.triangles[index];
  if (d.type == RecordType::setup) {
    for (const Vertex& v : triangle.v) {
      d.read.push_back({"vertex x y s u v, r g b a",
                        fmt::format("{} {} {} {} {}, {}", v.x, v.y, v.s, v.u, v.v, fmt::join(v.c, " "))});
    }
  }
  const DrawState state = state_at(config, scene, index);
  const std::vector<std::int64_t> values = state_values(state);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const StateRegister& r = state_registers()[i];
    if (!reads_register(d.type, r.key)) continue;
    d.read.push_back({std::string(r.key), r.names.empty()
                                              ? fmt::format("{}", values[i])
                                              : std::string(r.names[static_cast<std::size_t>(values[i])])});
  }
  if (d.type == RecordType::texture || d.type == RecordType::lod)
    add_texels(d, config, scene, triangle.texture, first_lookup(state), fed_by(d, RecordType::lod), d.read);
  if (d.type == RecordType::project)
    add_texels(d, config, scene, state.texture1, second_lookup(state), nullptr, d.read);
  // Its level is its own.
  if (d.type == RecordType::texture_second)
    add_texels(d, config, scene, state.texture1, second_lookup(state),
               d.reference_record ? &*d.reference_record : &*d.other_record, d.read);
  if (d.type == RecordType::fog && scene.fog)
    d.read.push_back({"fog color", fmt::format("{}", fmt::join(scene.fog->color, " "))});
  if (reads_pixel(d.type)) {
    Scene front;
    add_pixel(d, frame_in_front_of(scene, index, front, engine), d.read);
  }
}

}  // namespace bitspan
