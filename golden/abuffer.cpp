// SPDX-License-Identifier: Apache-2.0
#include "golden/abuffer.hpp"

#include <algorithm>
#include <optional>
#include <ranges>

#include "config/modes.hpp"
#include "golden/engine_golden.hpp"
#include "golden/packed_depth.hpp"
#include "golden/quantize.hpp"
#include "golden/surface.hpp"
#include "scene/plan.hpp"

namespace bitspan::golden {
namespace {

constexpr int parts = 4;  // of a pixel, each way

// The triangle on a grid whose pixels are the parts of its own.
IdealTriangle in_parts(IdealTriangle t) {
  for (IdealTriangle::Corner& corner : t.v) {
    corner.x *= parts;
    corner.y *= parts;
  }
  return t;
}

std::uint16_t coverage(const Config& config, const IdealTriangle& t, std::int64_t x, std::int64_t y) {
  unsigned out = 0;
  for (int j = 0; j < parts; ++j) {
    for (int i = 0; i < parts; ++i) {
      const Areas areas = areas_at(t, centre_of(t, parts * x + i, parts * y + j));
      out |= covers(t, areas, config.fill_rule) ? 1U << (parts * j + i) : 0U;
    }
  }
  return static_cast<std::uint16_t>(out);
}

// Larger is farther.
std::int64_t farness(const Config& config, std::int64_t z) {
  if (has_dz(config.depth_code)) return unpacked(z, config.depth_bits).z;
  return nearer_is_larger(config.depth_code) ? -z : z;
}

bool is_opaque(const Config& config, const Layer& layer) {
  return Quantizer<Quad>(config.format(FormatId::texture_alpha)).value(layer.a) >= 1;
}

}  // namespace

ABuffer make_abuffer(const Config& config, const Scene& scene) {
  const std::unique_ptr<Engine> engine = make_golden(config);
  engine->begin(scene);
  for (const DrawCommand& command : scene.commands) {
    if (command.before > 0 || !std::holds_alternative<StateChange>(command.what)) {
      throw InputError(scene.name + ": an A-buffer is of one draw state; expected no other commands");
    }
    engine->execute(command, 0, nullptr);
  }
  // Nothing hides anything.
  const StateChange all{.settings = {state_setting("depth.func", DepthFunc::always)}};
  engine->execute({.what = all}, 0, nullptr);
  ABuffer out{scene.width, scene.height, {}};
  out.pixels.resize(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  Trace trace;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    trace.clear();
    engine->draw(std::span(scene.triangles).subspan(i, 1), static_cast<std::int64_t>(i), &trace);
    const std::optional<IdealTriangle> shape = ideal_triangle(config, scene.triangles[i]);
    if (!shape) continue;
    const IdealTriangle fine = in_parts(*shape);
    // Each pixel once, and in one order: those killed are missing in fog.
    auto depth = trace.depth.begin();
    auto texture = trace.texture.begin();
    auto second = trace.texture_second.begin();
    for (const FogRecord& fog : trace.fog) {
      const auto is_here = [&](const auto& record) { return record.x == fog.x && record.y == fog.y; };
      depth = std::find_if(depth, trace.depth.end(), is_here);
      texture = std::find_if(texture, trace.texture.end(), is_here);
      second = std::find_if(second, trace.texture_second.end(), is_here);
      const std::int64_t a = second != trace.texture_second.end() ? second->a : texture->a;
      out.pixels[static_cast<std::size_t>(fog.y * scene.width + fog.x)].push_back(
          {static_cast<std::int32_t>(i), depth->z, fog.r, fog.g, fog.b, a,
           coverage(config, fine, fog.x, fog.y)});
    }
  }
  return out;
}

bool sort_layers(const Config& config, std::vector<Layer>& layers) {
  const auto far = [&](const Layer& layer) { return farness(config, layer.z); };
  std::ranges::stable_sort(layers, std::ranges::greater{}, far);
  // From the nearest one to the first that is opaque.
  bool is_tied = false;
  for (std::size_t i = layers.size(); i-- > 1 && !is_tied;) {
    is_tied = far(layers[i]) == far(layers[i - 1]);
    if (is_opaque(config, layers[i])) break;
  }
  return is_tied;
}

std::array<std::uint8_t, 3> blended(const Config& config, std::span<const Layer> layers,
                                    const std::array<std::uint8_t, 3>& background) {
  const Quantizer<Quad> color(config.format(FormatId::fog_color));
  const Quantizer<Quad> alpha(config.format(FormatId::texture_alpha));
  const Quantizer<Quad> merged(config.format(FormatId::merge_color));
  std::array<std::uint8_t, 3> out = background;
  for (const Layer& layer : layers) {
    const Quad share = std::min(Quad(1), alpha.value(layer.a));
    const std::array own{layer.r, layer.g, layer.b};
    for (std::size_t c = 0; c < out.size(); ++c) {
      const Quad mixed = color.value(own[c]) * share + Quad(out[c]) * (Quad(1) - share);
      out[c] = static_cast<std::uint8_t>(merged.raw(merged(mixed)));
    }
  }
  return out;
}

}  // namespace bitspan::golden
