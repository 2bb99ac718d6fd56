// SPDX-License-Identifier: Apache-2.0
#include "report/visibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

#include "config/modes.hpp"
#include "golden/mip_chain.hpp"
#include "golden/quantize.hpp"
#include "golden/texel.hpp"
#include "report/heatmap.hpp"

namespace bitspan {

namespace {

bool is_opaque(const Texture& texture, const Config& config) {
  for (std::int64_t j = 0; j < texture.height; ++j) {
    for (std::int64_t i = 0; i < texture.width; ++i) {
      const golden::TexelCodes texel = golden::fetch_texel(texture, i, j);
      if (texel[3] != 255) return false;
      if (config.transparent &&
          std::equal(config.transparent->begin(), config.transparent->end(), texel.begin())) {
        return false;
      }
    }
  }
  return true;
}

// Of each texture: whether no texel of it, of its levels, or of its border kills a fragment.
std::vector<bool> opaque_textures(const Config& config, const Scene& scene) {
  bool border_kills = false;
  const std::vector<DrawState> states = all_states_of(config, scene.commands);
  const auto has_border = [](const TexelLookup& by) {
    return has_border_color(by.wrap_u) || has_border_color(by.wrap_v);
  };
  if (std::ranges::any_of(states, [&](const DrawState& state) {
        return has_border(first_lookup(state)) ||
               (has_second_texture(state) && has_border(second_lookup(state)));
      })) {
    border_kills = config.border[3] != 255 ||
                   (config.transparent && std::equal(config.transparent->begin(), config.transparent->end(),
                                                     config.border.begin()));
  }
  const golden::SceneLevels levels = golden::scene_levels(config, scene);
  std::vector<bool> out;
  for (std::size_t t = 0; t < scene.textures.size(); ++t) {
    bool opaque = !border_kills && is_opaque(scene.textures[t], config);
    if (!levels.empty()) {
      opaque = opaque &&
               std::ranges::all_of(levels[t], [&](const Texture& level) { return is_opaque(level, config); });
    }
    out.push_back(opaque);
  }
  return out;
}

// Whether an alpha of 1 at the vertices and in the texels is above 0 when it reaches the last register, in
// delta_f. Registers may be too narrow for it, and their overflow may give 0.
bool keeps_alpha(const Config& config) {
  using Q = golden::Quantizer<long double>;
  const auto offset = [](const StartOffset& o, const Format& kept) {
    return o.half_ulp ? std::ldexp(0.5L, -kept.fraction()) : static_cast<long double>(o.value);
  };
  const auto walked = [&](long double a, FormatId acc, FormatId out, const StartOffset& o) {
    return Q(config.format(out))(Q(config.format(acc)).sum(a, offset(o, config.format(out))));
  };
  long double shade = Q(config.format(FormatId::setup_shade))(1.0L);
  shade = walked(shade, FormatId::edge_shade_acc, FormatId::edge_shade, config.start_offset.edge_shade);
  shade = walked(shade, FormatId::span_shade_acc, FormatId::span_shade, config.start_offset.span_shade);
  const Q narrow(config.format(FormatId::texture_alpha));
  const long double texel = narrow(1.0L);
  const long double first = narrow.product(texel, shade);
  return first > 0 && narrow.product(first, texel) > 0;  // with a second texture, too
}

// Why the triangle that is seen is not the nearest one in a draw state; empty where it is.
std::string refusal_of(const DrawState& state, const std::vector<bool>& opaque) {
  const auto refuse = [](std::string_view key, std::string_view legal) {
    return fmt::format("{}: legal for oracles: {}", key, legal);
  };
  const PassingDistances passing = passing_distances(state.depth_func);
  if (!passing.nearer || passing.farther) return refuse("depth.func", "less, lequal");
  if (!state.depth_write) return refuse("depth.write", "true");
  if (state.depth_bias != 0) return refuse("depth.bias", "0");
  if (!state.color_write) return refuse("color.write", "true");
  if (masks_pixels(state)) return refuse("scissor, stipple", "the whole picture");
  if (state.stencil_test) return refuse("stencil.test", "false");
  if (state.translucency_pass != TranslucencyPass::all) return refuse("translucency.pass", "all");
  if (state.alpha_func != CompareFunc::always) return refuse("alpha.func", "always");
  if (state.chroma_test != ChromaTest::none) return refuse("chroma.test", "none");
  if (has_second_texture(state) && !opaque[static_cast<std::size_t>(state.texture1)]) {
    return refuse("texture1", "a texture that is opaque everywhere");
  }
  return "";
}

}  // namespace

std::string pixel_text(const PixelFinding& found) {
  switch (found.verdict) {
    case PixelVerdict::background:
      return "neither shows a triangle";
    case PixelVerdict::equal:
      return "equal";
    case PixelVerdict::tie:
      return found.why.empty() ? "a tie that the bounds predict" : "a tie: " + found.why;
    case PixelVerdict::edge:
      return found.why.empty() ? "at a shadow's edge" : found.why;
    case PixelVerdict::unexplained:
      return "unexplained: " + found.why;
    case PixelVerdict::left_out:
      return "left out: a triangle may be seen there whose fragments may be killed";
  }
  unreachable();
}

std::string visibility_text(const VisibilityReport& r) {
  std::string out = fmt::format("{} against {}: {} {} equal, {} ties {}, {} {}", r.oracle, r.engine, r.equal,
                                r.unit, r.ties, r.ties_as, r.unexplained,
                                r.is_truth ? "unexplained" : "wrong, as this algorithm may be");
  if (r.edges != 0) out += fmt::format("; {} {}", r.edges, r.edges_as);
  if (r.left_out != 0) out += fmt::format("; {} left out, {}", r.left_out, r.left_out_as);
  if (!r.counts.empty()) out += "; " + counts_text(r.counts);
  return out;
}

std::string counts_text(std::span<const OracleCount> counts) {
  std::string out;
  for (const OracleCount& count : counts) {
    out += fmt::format("{}{:.6g} {}", out.empty() ? "" : ", ", count.value, count.name);
  }
  return out;
}

void VisibilityReport::add(PixelFinding found) {
  pixels.push_back(found.verdict);
  switch (found.verdict) {
    case PixelVerdict::background:
      ++background;
      break;
    case PixelVerdict::equal:
      ++equal;
      break;
    case PixelVerdict::tie:
      ++ties;
      break;
    case PixelVerdict::edge:
      ++edges;
      break;
    case PixelVerdict::unexplained:
      if (++unexplained == 1) first = std::move(found.why);
      break;
    case PixelVerdict::left_out:
      ++left_out;
      break;
  }
}

void write_visibility_map(const std::string& path, const VisibilityReport& report) {
  std::vector<double> values;
  for (const PixelVerdict verdict : report.pixels) {
    switch (verdict) {
      case PixelVerdict::equal:
        values.push_back(0);
        break;
      case PixelVerdict::tie:
      case PixelVerdict::edge:
        values.push_back(1);
        break;
      case PixelVerdict::unexplained:
        values.push_back(2);
        break;
      case PixelVerdict::background:
      case PixelVerdict::left_out:
        values.push_back(std::numeric_limits<double>::quiet_NaN());
        break;
    }
  }
  HeatMapOptions options;
  options.title = report.is_truth ? "0 equal, 1 tie, 2 unexplained" : "0 equal, 1 tie, 2 wrong";
  options.high = 2;
  write_heat_map(path, report.width, report.height, values, options);
}

bool goes_by_given_depth(const Config& config, const Scene& scene) {
  return has_own_depth(config.depth_line) && std::ranges::any_of(scene.triangles, [](const Triangle& t) {
           return std::ranges::any_of(t.v, [](const Vertex& v) { return v.z >= 0; });
         });
}

std::optional<Scene> by_distance(const Config& config, const Scene& scene) {
  if (!goes_by_given_depth(config, scene)) return std::nullopt;
  Scene out = scene;
  for (Triangle& triangle : out.triangles) {
    for (Vertex& v : triangle.v) {
      if (v.z < 0) continue;
      // h / h_max = 1 - z = s_min (s_max / s - 1) / (s_max - s_min)
      const double share = (1 - v.z) * (scene.s_max - scene.s_min) / scene.s_min;
      v.s = std::clamp(scene.s_max / (share + 1), scene.s_min, scene.s_max);
      v.z = -1;
    }
  }
  return out;
}

double distance_rounding(const Config& config, const Scene& scene) {
  // Fewer than eight roundings of s_max / s, by which h grows with h_max s_min / (s_max - s_min).
  return 8 * 0x1p-53 * static_cast<double>(golden::h_max(config)) * scene.s_max / (scene.s_max - scene.s_min);
}

std::string visibility_refusal(const Config& config, const Scene& scene) {
  if (std::ranges::any_of(scene.triangles, &Triangle::is_line)) {
    return "the scene has lines, which have no surface; legal for oracles: triangles";
  }
  if (has_x_step(config)) {
    return "raster.edge_walk: a dda's coverage is not that of the exact test; legal for oracles: exact";
  }
  if (has_perspective_shades(config.shade_lines)) {
    // With these an alpha of 1 comes back from its division as 1, or nearly so.
    for (const FormatId id :
         {FormatId::shade_grad, FormatId::shade_step, FormatId::shade_acc, FormatId::shade_value}) {
      if (config.format(id) != *default_format(config.formats, id)) {
        return "formats." + std::string(key_of(id)) +
               ": an alpha of 1 may be 0 behind its division; legal for oracles: the default";
      }
    }
  }
  if (!keeps_alpha(config)) {
    return "formats.*.shade, formats.texture.alpha: an alpha of 1 becomes 0 on its way, so that every "
           "fragment is "
           "killed";
  }
  check_commands(config, scene);
  for (const DrawCommand& command : scene.commands) {
    if (!std::holds_alternative<StateChange>(command.what)) {
      return "the stream has a command that is no change of state: no oracle knows what it leaves of the "
             "picture";
    }
  }
  const std::vector<bool> opaque = opaque_textures(config, scene);
  for (const DrawState& state : all_states_of(config, scene.commands)) {
    if (std::string why = refusal_of(state, opaque); !why.empty()) return why;
  }
  return "";
}

std::vector<bool> vanishing_triangles(const Config& config, const Scene& scene,
                                      std::span<const Triangle> triangles) {
  const std::vector<bool> opaque = opaque_textures(config, scene);
  std::vector<bool> out;
  for (const Triangle& triangle : triangles) {
    bool vanishes = triangle.texture >= 0 && !opaque[static_cast<std::size_t>(triangle.texture)];
    for (const Vertex& v : triangle.v) vanishes = vanishes || v.c[3] != 1;
    out.push_back(vanishes);
  }
  return out;
}

std::vector<std::uint8_t> flat_picture(const Scene& scene, std::span<const Visible> picture) {
  std::vector<std::array<std::uint8_t, 3>> colors;
  for (const Triangle& t : scene.triangles) {
    const auto mean = [&](auto value) { return (value(t.v[0]) + value(t.v[1]) + value(t.v[2])) / 3; };
    golden::TexelCodes texel{255, 255, 255, 255};
    if (t.texture >= 0) {
      const Texture& texture = scene.textures[static_cast<std::size_t>(t.texture)];
      const auto place = [](double at, int size) {
        return static_cast<std::int64_t>(at - size * std::floor(at / size)) % size;
      };
      texel = golden::fetch_texel(texture, place(mean([](const Vertex& v) { return v.u; }), texture.width),
                                  place(mean([](const Vertex& v) { return v.v; }), texture.height));
    }
    std::array<std::uint8_t, 3>& color = colors.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const double shade = std::clamp(mean([i](const Vertex& v) { return v.c[i]; }), 0.0, 1.0);
      color[i] = static_cast<std::uint8_t>(std::lround(shade * texel[i]));
    }
  }
  std::vector<std::uint8_t> out;
  out.reserve(4 * picture.size());
  for (const Visible& seen : picture) {
    const auto& color =
        seen.triangle < 0 ? scene.background : colors[static_cast<std::size_t>(seen.triangle)];
    out.insert(out.end(), color.begin(), color.end());
    out.push_back(255);
  }
  return out;
}

Visibility::Visibility(const Config& config, const Scene& scene, std::vector<double> bounds)
    : config_(config), scene_(&scene), bounds_(std::move(bounds)) {
  if (bounds_.size() != scene.triangles.size())
    throw std::invalid_argument("Visibility: a bound per triangle");
  const std::vector<bool> vanishes = vanishing_triangles(config, scene, scene.triangles);
  const std::optional<Scene> own = by_distance(config, scene);
  const std::vector<Triangle>& triangles = own ? own->triangles : scene.triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto shape = ideal_triangle(config, triangles[i]);
    if (shape) (vanishes[i] ? vanishing_ : faces_).push_back({static_cast<std::int32_t>(i), *shape});
  }
}

std::vector<Visible> Visibility::picture(const Oracle& oracle, std::vector<OracleCount>* counts) const {
  return oracle.visible({config_, *scene_, faces_, counts});
}

std::vector<Visible> Visibility::picture_without_quadrics(const Oracle& oracle) const {
  std::vector<OracleFace> faces;
  auto quadric = scene_->quadrics.begin();
  for (const OracleFace& face : faces_) {
    const auto index = static_cast<std::size_t>(face.index);
    while (quadric != scene_->quadrics.end() && index >= quadric->first + quadric->count) ++quadric;
    if (quadric == scene_->quadrics.end() || index < quadric->first) faces.push_back(face);
  }
  return oracle.visible({config_, *scene_, faces, nullptr});
}

double Visibility::depth_of(const Visible& seen) const {
  if (seen.triangle < 0) return 0;
  return static_cast<double>(golden::depth_code(config_, *scene_, seen.q.value));
}

double Visibility::depth_at(double s) const {
  return static_cast<double>(golden::depth_code(config_, *scene_, 1 / static_cast<long double>(s)));
}

double Visibility::stored_h(std::uint32_t code) const {
  const double z = code;
  return is_complement_of_h(config_.depth_code) ? static_cast<double>(golden::h_max(config_)) - z : z;
}

std::vector<bool> Visibility::doubtful(std::span<const Visible> picture) const {
  std::vector<bool> out(picture.size());
  for (const OracleFace& face : vanishing_) {
    const double own = bounds_[static_cast<std::size_t>(face.index)];
    golden::for_each_covered(face.shape, config_.fill_rule, scene_->width, scene_->height,
                             [&](const golden::Areas& areas, std::int64_t x, std::int64_t y) {
                               const auto at = static_cast<std::size_t>(y * scene_->width + x);
                               const Visible& seen = picture[at];
                               const Visible here{face.index, golden::inverse_distance(face.shape, areas)};
                               const double other =
                                   seen.triangle < 0 ? 0 : bounds_[static_cast<std::size_t>(seen.triangle)];
                               if (depth_of(here) >= depth_of(seen) - (own + other)) out[at] = true;
                             });
  }
  return out;
}

double Visibility::bound_of(std::int32_t triangle) const {
  return triangle < 0 ? 0 : bounds_[static_cast<std::size_t>(triangle)];
}

std::optional<Visible> Visibility::shown(const Frame& frame, std::string_view engine, std::int64_t x,
                                         std::int64_t y, std::string& why) const {
  const auto at = static_cast<std::size_t>(y * frame.width + x);
  const std::int32_t drawn = frame.triangle[at];
  const double stored = stored_h(frame.depth[at]);
  if (drawn < 0) {
    if (stored == 0) return Visible{};
    why = fmt::format("{} shows no triangle, and stores h = {}", engine, stored);
    return std::nullopt;
  }
  const auto face = std::ranges::lower_bound(faces_, drawn, {}, &OracleFace::index);
  if (face == faces_.end() || face->index != drawn || !ideal_covers(config_, face->shape, x, y)) {
    why = fmt::format("{} shows triangle {}, which cannot be seen there", engine, drawn);
    return std::nullopt;
  }
  const golden::Areas areas = golden::areas_at(face->shape, golden::centre_of(face->shape, x, y));
  Visible out{drawn, golden::inverse_distance(face->shape, areas)};
  const double h = depth_of(out);
  if (std::abs(stored - h) <= bound_of(drawn)) return out;
  why = fmt::format("{} stores h = {} of triangle {}, which is at {:.10g}; the bound is {:.4g}", engine,
                    stored, drawn, h, bound_of(drawn));
  return std::nullopt;
}

PixelFinding Visibility::judge(const Oracle& oracle, const Visible& seen, const Frame& frame,
                               std::string_view engine, std::int64_t x, std::int64_t y) const {
  const auto unexplained = [&](const std::string& why) {
    return PixelFinding{PixelVerdict::unexplained, fmt::format("pixel ({}, {}): {}", x, y, why)};
  };
  std::string why;
  const std::optional<Visible> shown_there = shown(frame, engine, x, y, why);
  if (!shown_there) return unexplained(why);
  const Visible& drawn = *shown_there;
  const double seen_h = depth_of(seen);
  const double seen_bound = bound_of(seen.triangle);
  if (drawn.triangle < 0) {
    if (seen.triangle < 0) return {PixelVerdict::background};
    // The cleared buffer is as a surface at h = 0.
    if (seen_h <= seen_bound) return {PixelVerdict::tie};
    return unexplained(
        fmt::format("{} sees triangle {} at h = {:.10g}, and {} shows none; the bound is {:.4g}", oracle.name,
                    seen.triangle, seen_h, engine, seen_bound));
  }
  const double shown_h = depth_of(drawn);
  const double shown_bound = bound_of(drawn.triangle);
  if (seen.triangle < 0) {
    return unexplained(
        fmt::format("{} sees no triangle, and {} shows {}", oracle.name, engine, drawn.triangle));
  }
  if (seen.triangle == drawn.triangle) {
    if (seen.q == drawn.q) return {PixelVerdict::equal};
    return unexplained(fmt::format("{} sees triangle {} at h = {:.10g}, and it is at {:.10g}", oracle.name,
                                   drawn.triangle, seen_h, shown_h));
  }
  if (std::abs(seen_h - shown_h) <= seen_bound + shown_bound) return {PixelVerdict::tie};
  return unexplained(fmt::format(
      "{} sees triangle {} at h = {:.10g}, and {} shows {}, which is at {:.10g}; the bounds are {:.4g} "
      "and {:.4g}",
      oracle.name, seen.triangle, seen_h, engine, drawn.triangle, shown_h, seen_bound, shown_bound));
}

PixelFinding Visibility::at(const Oracle& oracle, std::span<const Visible> picture, const Frame& frame,
                            std::string_view engine, std::int64_t x, std::int64_t y) const {
  if (is_doubtful(picture, x, y)) return {PixelVerdict::left_out};
  return judge(oracle, picture[static_cast<std::size_t>(y * frame.width + x)], frame, engine, x, y);
}

bool Visibility::is_doubtful(std::span<const Visible> picture, std::int64_t x, std::int64_t y) const {
  return doubtful(picture)[static_cast<std::size_t>(y * scene_->width + x)];
}

VisibilityReport report_on(const Oracle& oracle, int width, int height, std::string_view engine) {
  VisibilityReport out;
  out.oracle = oracle.name;
  out.engine = engine;
  out.is_truth = oracle.is_truth;
  out.width = width;
  out.height = height;
  return out;
}

VisibilityReport Visibility::compare(const Oracle& oracle, std::span<const Visible> picture,
                                     const Frame& frame, std::string_view engine) const {
  return report_of(oracle, picture, frame, engine, [&](std::int64_t x, std::int64_t y) {
    return judge(oracle, picture[static_cast<std::size_t>(y * frame.width + x)], frame, engine, x, y);
  });
}

VisibilityReport Visibility::report_of(
    const Oracle& oracle, std::span<const Visible> picture, const Frame& frame, std::string_view engine,
    const std::function<PixelFinding(std::int64_t, std::int64_t)>& judge) const {
  VisibilityReport out = report_on(oracle, frame.width, frame.height, engine);
  if (picture.size() != frame.triangle.size()) {
    throw std::invalid_argument("Visibility: the engine and the oracle have pictures of two sizes");
  }
  const std::vector<bool> doubt = doubtful(picture);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const auto x = static_cast<std::int64_t>(i) % frame.width;
    const auto y = static_cast<std::int64_t>(i) / frame.width;
    out.add(doubt[i] ? PixelFinding{PixelVerdict::left_out} : judge(x, y));
  }
  return out;
}

}  // namespace bitspan
