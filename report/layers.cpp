// SPDX-License-Identifier: Apache-2.0
#include "report/layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace bitspan {
namespace {

// The pass that a change of state begins; none where it begins none.
std::optional<TranslucencyPass> pass_of(const StateChange& change) {
  const std::size_t index = *find_state_register("translucency.pass");
  const auto found = std::ranges::find(change.settings, index, &StateSetting::index);
  if (found == change.settings.end()) return std::nullopt;
  return static_cast<TranslucencyPass>(found->value);
}

}  // namespace

std::optional<Scene> layered_picture_of(const Scene& scene) {
  Scene picture = scene;
  picture.commands.clear();
  std::size_t passes = 0;
  std::optional<std::size_t> end;  // of the first pass
  bool resolved = false;           // in front of the pass that begins
  for (const DrawCommand& command : scene.commands) {
    if (const auto* target = std::get_if<Target>(&command.what)) {
      if (target->k != 0) return std::nullopt;
    } else if (std::holds_alternative<Resolve>(command.what)) {
      if (!end) end = command.before;
      resolved = true;
    } else if (const auto* change = std::get_if<StateChange>(&command.what)) {
      const auto pass = pass_of(*change);
      if (!pass && passes == 0) {
        if (command.before != 0) return std::nullopt;
        picture.commands.push_back(command);
      }
      if (!pass) continue;
      if (passes == 0 ? *pass != TranslucencyPass::opaque || command.before != 0
                      : *pass != TranslucencyPass::candidate || !resolved) {
        return std::nullopt;
      }
      resolved = false;
      ++passes;
    } else {
      return std::nullopt;
    }
  }
  if (passes < 2 || !end || *end == 0) return std::nullopt;
  picture.triangles.resize(*end);
  return picture;
}

std::string layer_refusal(const Config& config, const Scene& picture) {
  if (std::ranges::any_of(picture.triangles, &Triangle::is_line)) {
    return "the scene has lines, which have no surface; legal for the layers of an oracle: triangles";
  }
  DrawState state = all_states_of(config, picture.commands).back();
  const auto held = state_values(state), first = state_values(first_state(config));
  // What merges otherwise than over what lies behind, and what lets a fragment leave something out.
  for (const StateRegister& r : state_registers()) {
    const std::string_view unit = r.key.substr(0, r.key.find('.'));
    const bool is_asked = unit == "blend" || unit == "logic" || unit == "target" || unit == "color" ||
                          r.key == "depth.write" || r.key == "stencil.test";
    const auto at = static_cast<std::size_t>(&r - state_registers().data());
    if (is_asked && held[at] != first[at]) {
      return fmt::format("{}: legal for the layers of an oracle: what it holds at first", r.key);
    }
  }
  return "";
}

std::vector<PixelFinding> layer_findings(const Config& config, const Scene& picture, golden::ABuffer& lists,
                                         const Frame& frame, std::string_view engine) {
  std::vector<PixelFinding> out;
  for (std::size_t i = 0; i < lists.pixels.size(); ++i) {
    std::vector<golden::Layer>& layers = lists.pixels[i];
    const bool is_tied = golden::sort_layers(config, layers);
    const auto expected = golden::blended(config, layers, picture.background);
    const auto shown = std::span(frame.color).subspan(4 * i, 3);
    if (is_tied) {
      out.push_back({PixelVerdict::tie, "two layers have one depth code"});
    } else if (std::ranges::equal(shown, expected)) {
      out.push_back({layers.empty() ? PixelVerdict::background : PixelVerdict::equal});
    } else {
      const auto width = static_cast<std::size_t>(picture.width);
      out.push_back({PixelVerdict::unexplained,
                     fmt::format("pixel ({}, {}): {} layers make {}, and {} shows {}", i % width, i / width,
                                 layers.size(), fmt::join(expected, " "), engine, fmt::join(shown, " "))});
    }
  }
  return out;
}

VisibilityReport layer_report(const Oracle& oracle, const Frame& frame, std::string_view engine,
                              std::vector<PixelFinding> findings) {
  VisibilityReport out = report_on(oracle, frame.width, frame.height, engine);
  out.ties_as = "of layers with one depth code";
  for (PixelFinding& found : findings) out.add(std::move(found));
  return out;
}

std::vector<std::string> layers_text(const Config& config, const std::vector<golden::Layer>& layers) {
  std::vector<std::string> out;
  const auto value = [&](std::int64_t raw, FormatId id) {
    return std::ldexp(static_cast<double>(raw), -config.format(id).fraction());
  };
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
    out.push_back(
        fmt::format("layer {}: triangle {}, z {}, alpha {:.4g}, rgb {:.4g} {:.4g} {:.4g}, covers {} of 16",
                    out.size(), layer->triangle, layer->z, value(layer->a, FormatId::texture_alpha),
                    value(layer->r, FormatId::fog_color), value(layer->g, FormatId::fog_color),
                    value(layer->b, FormatId::fog_color), std::popcount(layer->coverage)));
  }
  return out;
}

}  // namespace bitspan
