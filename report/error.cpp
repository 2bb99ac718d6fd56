// SPDX-License-Identifier: Apache-2.0
#include "report/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "config/lines.hpp"
#include "config/modes.hpp"
#include "report/metrics.hpp"

namespace bitspan {
namespace {

// The list reads as a table.
// clang-format off

// X(row, stage, quantity, unit, format): format: of the register of a Config c; none of depth and colour codes, which are integers.
#define BITSPAN_ERROR_ROWS(X) \
  X(setup_h,         "setup",     "h",         "depth code",  FormatId::setup_h)         \
  X(setup_u,         "setup",     "u",         "texel",       FormatId::setup_uv)        \
  X(setup_v,         "setup",     "v",         "texel",       FormatId::setup_uv)        \
  X(edge_x,          "edge_walk", "x",         "pixel",       FormatId::edge_x)          \
  X(edge_h,          "edge_walk", "h",         "depth code",  FormatId::edge_h)          \
  X(edge_u,          "edge_walk", "u",         "texel",       FormatId::edge_uv)         \
  X(edge_v,          "edge_walk", "v",         "texel",       FormatId::edge_uv)         \
  X(span_h,          "span",      "h",         "depth code",  FormatId::span_h)          \
  X(span_u,          "span",      "u",         "texel",       FormatId::span_uv)         \
  X(span_v,          "span",      "v",         "texel",       FormatId::span_uv)         \
  X(span_shade,      "span",      "shade",     "1",           shade_factor(c))           \
  X(depth_z,         "depth",     "z",         "depth code",  codes)                     \
  X(project_s,       "project",   "s",         "texel",       FormatId::span_uv)         \
  X(project_t,       "project",   "t",         "texel",       FormatId::span_uv)         \
  X(project_z,       "project",   "z",         "depth code",  codes)                     \
  X(texture_color,   "texture",   "colour",    "colour code", FormatId::texture_color)   \
  X(light_normal,    "light",     "normal",    "1",           FormatId::light_normal)    \
  X(light_direction, "light",     "direction", "1",           FormatId::light_direction) \
  X(light_cosine,    "light",     "cosine",    "1",           FormatId::light_cosine)    \
  X(light_specular,  "light",     "specular",  "1",           FormatId::light_specular)  \
  X(light_value,     "light",     "value",     "1",           FormatId::light_value)     \
  X(light_color,     "light",     "colour",    "colour code", FormatId::texture_color)   \
  X(fog_factor,      "fog",       "factor",    "1",           FormatId::fog_factor)      \
  X(fog_color,       "fog",       "colour",    "colour code", FormatId::fog_color)       \
  X(picture_color,   "picture",   "colour",    "colour code", codes)                     \
  X(picture_depth,   "picture",   "depth",     "depth code",  codes)                     \
  X(picture_u,       "picture",   "u",         "texel",       FormatId::span_uv)         \
  X(picture_v,       "picture",   "v",         "texel",       FormatId::span_uv)

// clang-format on

enum Row {
#define BITSPAN_ERROR_ROW(row, ...) row_##row,
  BITSPAN_ERROR_ROWS(BITSPAN_ERROR_ROW)
#undef BITSPAN_ERROR_ROW
      row_count
};

constexpr auto quantities = std::to_array<FieldQuantity>({
#define BITSPAN_ERROR_ROW(row, stage, quantity, unit, format) {stage, quantity, unit},
    BITSPAN_ERROR_ROWS(BITSPAN_ERROR_ROW)
#undef BITSPAN_ERROR_ROW
});

std::array<std::optional<FormatId>, row_count> quantity_formats(const Config& c) {
  constexpr std::nullopt_t codes = std::nullopt;
  return {
#define BITSPAN_ERROR_ROW(row, stage, quantity, unit, format) format,
      BITSPAN_ERROR_ROWS(BITSPAN_ERROR_ROW)
#undef BITSPAN_ERROR_ROW
  };
}

void add_tallies(const std::vector<PictureTally>& from, std::vector<PictureTally>& to) {
  const auto metrics = picture_metrics();
  to.resize(std::max(to.size(), from.size()));
  for (std::size_t i = 0; i < from.size(); ++i) {
    const bool sum = metrics[i].over_scenes == OverScenes::sum;
    to[i].counted = sum ? to[i].counted + from[i].counted : std::max(to[i].counted, from[i].counted);
    to[i].base += from[i].base;
  }
}

double ulp(const Format& format) { return std::ldexp(1.0, -format.fraction()); }

// Returns the quantity of that name ("h", "u", "v", "r", "g", "b", "a") at a point of the surface.
std::optional<double> surface_value(std::string_view name, const IdealPoint& p) {
  if (name.size() != 1) {
    return std::nullopt;
  }
  switch (name.front()) {
    case 'h':
      return p.h;
    case 'u':
      return p.u;
    case 'v':
      return p.v;
    default:
      break;
  }
  const auto channel = std::string_view("rgba").find(name);
  return channel == std::string_view::npos ? std::nullopt : std::optional(p.shade[channel]);
}

// The code of a projection in front of the bias, held to the codes that there are.
double held_code(const Config& config, const IdealProjection& at) {
  return std::clamp(at.z, 0.0, std::ldexp(1.0, config.depth_bits) - 1);
}

// Returns the quantity of that field of the record `project`; none behind the projector.
std::optional<double> projected_value(std::string_view name, const Config& config, const Scene& scene,
                                      const IdealPoint& point) {
  const auto at = ideal_projection(config, scene, point);
  if (!at) return std::nullopt;
  if (name == "s") return at->s;
  if (name == "t") return at->t;
  if (name == "h") return at->h;
  if (name == "z") return held_code(config, *at);
  if (name != "ratio") return std::nullopt;
  int exponent = 0;  // s_max <= 2^exponent
  if (std::frexp(scene.projector->s_max, &exponent) == 0.5) --exponent;
  return std::ldexp(1 / at->w, exponent);
}

// Returns the quantity of that field of the record `light`; the parts of it are formed per pixel alone.
std::optional<double> light_value(std::string_view name, const Config& config, const IdealFragment& f) {
  if (name == "value") return f.light.value;
  if (!lights_pixels(config.light)) return std::nullopt;
  if (name == "cosine") return f.light.cosine;
  if (name == "mirrored") return f.light.mirrored;
  if (name == "specular") return f.light.specular;
  if (name.size() != 2) return std::nullopt;
  const std::size_t axis = std::string_view("xyz").find(name[1]);
  if (axis == std::string_view::npos) return std::nullopt;
  if (name[0] == 'n') return f.light.normal[axis];
  return name[0] == 'l' ? std::optional(f.light.direction[axis]) : std::nullopt;
}

// Whether a command of the scene sets a register to a value that `differs` holds for.
template <class Differs>
bool sets(const Scene& scene, std::string_view key, Differs differs) {
  if (scene.commands.empty()) return false;  // ideal_value() asks for each record
  const std::size_t index = *find_state_register(key);
  return std::ranges::any_of(scene.commands, [&](const DrawCommand& command) {
    const auto* change = std::get_if<StateChange>(&command.what);
    return change != nullptr && std::ranges::any_of(change->settings, [&](const StateSetting& setting) {
             return setting.index == index && differs(setting.value);
           });
  });
}

// The closed form has the first texture unit alone, which looks texels up as the configuration says. Return
// whether a draw state does otherwise.
bool combines_textures(const Scene& scene) {
  return sets(scene, "texture1", [](std::int64_t value) { return value >= 0; });
}
bool adds_other_bias(const Config& config, const Scene& scene) {
  return sets(scene, "texture.lod.bias", [&](std::int64_t value) { return value != config.lod_bias; });
}
bool looks_up_otherwise(const Config& config, const Scene& scene) {
  const auto other = [](auto name) {
    return [name](std::int64_t value) { return value != static_cast<std::int64_t>(name); };
  };
  return sets(scene, "texture.filter", other(config.filter)) ||
         sets(scene, "texture.wrap.u", other(config.wrap)) ||
         sets(scene, "texture.wrap.v", other(config.wrap)) ||
         (has_lod(config) &&
          (sets(scene, "texture.magnify", other(MagnifyFilter::same)) ||
           sets(scene, "texture.level.least", other(0)) ||
           sets(scene, "texture.level.greatest", other(max_mip_level)) || adds_other_bias(config, scene)));
}
bool looks_up_otherwise(const Config& config, const StateRecord& r) {
  const auto differs = [](std::int64_t value, auto name) { return value != static_cast<std::int64_t>(name); };
  return differs(r.texture_filter, config.filter) || differs(r.texture_wrap_u, config.wrap) ||
         differs(r.texture_wrap_v, config.wrap) ||
         (has_lod(config) &&
          (differs(r.texture_magnify, MagnifyFilter::same) || differs(r.texture_level_least, 0) ||
           differs(r.texture_level_greatest, max_mip_level) || differs(r.texture_lod_bias, config.lod_bias)));
}

}  // namespace

std::optional<double> ideal_value(RecordType type, std::string_view field,
                                  std::span<const std::int64_t> record, const Config& config,
                                  const Scene& scene, const Triangle& triangle) {
  const auto value = [&](std::string_view name) {
    return record[static_cast<std::size_t>(field_index(type, name))];
  };
  const auto t = ideal_triangle(config, triangle);
  if (!t) {
    return std::nullopt;
  }
  if (type == RecordType::setup) {
    const int n = field.back() - '0';
    if (field.size() != 2 || n < 0 || n > 2) {
      return std::nullopt;
    }
    const IdealPoint p = ideal_at_vertex(config, scene, *t, n);
    if (field.front() == 'x' || field.front() == 'y') {
      return field.front() == 'x' ? p.x : p.y;
    }
    return surface_value(field.substr(0, 1), p);
  }
  if (type == RecordType::row) {
    if (!field.starts_with("l_") && !field.starts_with("r_")) {
      return std::nullopt;
    }
    const auto edge = static_cast<int>(value(field.front() == 'l' ? "l_edge" : "r_edge"));
    const IdealPoint p = ideal_on_edge(config, scene, *t, edge, value("y"));
    if (field.substr(2) == "x") return p.x;
    if (has_setup_plane(config)) return std::nullopt;  // ends have a position alone
    return surface_value(field.substr(2), p);
  }
  if (type < RecordType::fragment) {
    return std::nullopt;
  }
  const IdealFragment f = ideal_at(config, scene, *t, value("x"), value("y"));
  if (type == RecordType::fragment) {
    return surface_value(field, f.point);
  }
  if (type == RecordType::project) return projected_value(field, config, scene, f.point);
  if (field == "z") {
    return ideal_stored_code(config, f, 0);
  }
  if (type == RecordType::lod) {
    return field == "lambda" && t->texture >= 0 && !adds_other_bias(config, scene) ? std::optional(f.lambda)
                                                                                   : std::nullopt;
  }
  const auto channel = std::string_view("rgb").find(field);
  const bool is_channel = field.size() == 1 && channel != std::string_view::npos;
  if (type == RecordType::light && !is_channel) return light_value(field, config, f);
  const bool is_color = type == RecordType::texture || type == RecordType::light ||
                        (type == RecordType::fog && field != "factor");
  if (is_color && looks_up_otherwise(config, scene)) return std::nullopt;
  if (type == RecordType::texture && !f.killed) {
    const auto texel =
        field.starts_with("texel_") ? std::string_view("rgba").find(field.substr(6)) : std::string_view::npos;
    if (texel != std::string_view::npos) {
      return f.texel[texel];
    }
    if (field == "a") {
      return f.alpha;
    }
    return is_channel ? std::optional(f.color[channel]) : std::nullopt;
  }
  if (type == RecordType::light && !f.killed) {
    return combines_textures(scene) ? std::nullopt : std::optional(f.lit[channel]);
  }
  if (type == RecordType::fog && !f.killed) {
    if (field == "factor") {
      return f.fog_factor;
    }
    return is_channel && !combines_textures(scene) ? std::optional(f.fogged[channel]) : std::nullopt;
  }
  return std::nullopt;  // what merge stores depends on what was there before
}

void ErrorStat::add(double measured, double ideal) {
  const double error = measured - ideal;
  const double size = std::fabs(error);
  ++count;
  sum += error;
  magnitude += size;
  squares += error * error;
  power += ideal * ideal;
  max = std::max(max, size);
  // The exponent and leading fraction bits of the double give the bin, from 2^lowest_octave on.
  constexpr std::int64_t first = std::int64_t{1023 + lowest_octave} << bins_per_octave_log2;
  const std::int64_t bin =
      static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(size) >> (52 - bins_per_octave_log2)) - first;
  ++bins[static_cast<std::size_t>(std::clamp<std::int64_t>(bin, 0, bin_count - 1))];
}

void ErrorStat::add(const ErrorStat& other) {
  count += other.count;
  sum += other.sum;
  magnitude += other.magnitude;
  squares += other.squares;
  power += other.power;
  max = std::max(max, other.max);
  for (std::size_t i = 0; i < bins.size(); ++i) bins[i] += other.bins[i];
}

double ErrorStat::quantile(double share) const {
  const double wanted = share * static_cast<double>(count);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    below += bins[i];
    if (static_cast<double>(below) >= wanted) {
      if (i == 0) return 0;
      constexpr std::size_t per_octave = std::size_t{1} << bins_per_octave_log2;
      const double fraction = 1 + static_cast<double>(i % per_octave + 1) / static_cast<double>(per_octave);
      return std::min(max, std::ldexp(fraction, lowest_octave + static_cast<int>(i / per_octave)));
    }
  }
  return max;
}

double ErrorStat::sqnr_db() const {
  return squares == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(power / squares);
}

void ErrorReport::add(const ErrorReport& other) {
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].stat.add(other.rows[i].stat);
  covered += other.covered;
  missed += other.missed;
  surplus += other.surplus;
  doubled += other.doubled;
  add_tallies(other.picture, picture);
}

namespace {

// The channels of a fragment, by its place in the trace.
std::span<const FragmentChannelRecord> channels_of(const Trace& trace, std::size_t fragment) {
  const std::size_t in_use = trace.fragment_channel.size() / trace.fragment.size();
  return std::span(trace.fragment_channel).subspan(fragment * in_use, in_use);
}

}  // namespace

std::span<const FieldQuantity> field_quantities() { return quantities; }

ErrorMeter::ErrorMeter(const Config& config, const Scene& scene) : config_(config), scene_(&scene) {
  const auto formats = quantity_formats(config);
  for (std::size_t i = 0; i < row_count; ++i) {
    const FieldQuantity& q = quantities[i];
    report_.rows.push_back({std::string(q.stage),
                            std::string(q.quantity),
                            std::string(q.unit),
                            formats[i] ? ulp(config.format(*formats[i])) : 1,
                            {}});
  }
}

// Compares each pixel of the triangle's box with the fill rule.
void ErrorMeter::coverage(const Truth& truth, std::size_t triangle,
                          std::span<const FragmentRecord> fragments) {
  const auto [y0, y1] = truth.rows(triangle);
  std::int64_t x0 = scene_->width;
  std::int64_t x1 = 0;
  for (std::int64_t y = y0; y < y1; ++y) {
    const Truth::Pixels row = truth.covered(triangle, y);
    if (row.first >= row.end) continue;
    x0 = std::min(x0, row.first);
    x1 = std::max(x1, row.end);
  }
  const auto wide = static_cast<std::size_t>(std::max<std::int64_t>(0, x1 - x0));
  hits_.assign(wide * static_cast<std::size_t>(y1 - y0), 0);
  std::uint64_t inside = 0;
  for (const FragmentRecord& f : fragments) {
    if (f.covered == 0) continue;
    const Truth::Pixels row = truth.covered(triangle, f.y);
    if (f.x < x0 || f.x >= x1 || f.y < y0 || f.y >= y1) {
      ++report_.surplus;
      continue;
    }
    std::uint8_t& hit = hits_[static_cast<std::size_t>(f.y - y0) * wide + static_cast<std::size_t>(f.x - x0)];
    report_.doubled += hit;
    const bool covered = f.x >= row.first && f.x < row.end;
    report_.surplus += static_cast<std::uint64_t>(hit == 0 && !covered);
    inside += static_cast<std::uint64_t>(hit == 0 && covered);
    hit = 1;
  }
  std::uint64_t all = 0;
  for (std::int64_t y = y0; y < y1; ++y) {
    const Truth::Pixels row = truth.covered(triangle, y);
    all += static_cast<std::uint64_t>(std::max<std::int64_t>(0, row.end - row.first));
  }
  report_.covered += all;
  report_.missed += all - inside;
}

void ErrorMeter::add(std::span<const Triangle> triangles, std::int64_t first_index, const Trace& trace) {
  if (levels_ == nullptr)
    levels_ = std::make_shared<golden::SceneLevels>(golden::scene_levels(config_, *scene_));
  add(Truth(config_, *scene_, triangles, levels_), first_index, trace);
}

void ErrorMeter::add(const Truth& truth, std::int64_t first_index, const Trace& trace) {
  const auto note = [&](int row, std::int64_t raw, double ideal) {
    ErrorRow& r = report_.rows[static_cast<std::size_t>(row)];
    r.stat.add(static_cast<double>(raw) * r.ulp, ideal);
  };
  const bool fogged = scene_->fog.has_value() && has_fog(config_.fog);

  std::size_t state = 0;
  std::size_t setup = 0;
  std::size_t row = 0;
  std::size_t fragment = 0;
  std::size_t depth = 0;
  std::size_t project = 0;
  std::size_t texture = 0;
  std::size_t light = 0;
  std::size_t fog = 0;
  // Records stand in the order of the triangles, so there is one cursor per type.
  for (std::size_t n = 0; n < truth.size(); ++n) {
    const std::int64_t index = first_index + static_cast<std::int64_t>(n);
    if (!truth.triangle(n)) {
      // Without an area nothing has a record, but for a line, which the closed form does not take.
      const auto pass = [&](std::size_t& at, const auto& records) {
        while (at < records.size() && records[at].triangle == index) ++at;
      };
      pass(setup, trace.setup);
      pass(fragment, trace.fragment);
      pass(depth, trace.depth);
      pass(texture, trace.texture);
      pass(fog, trace.fog);
      continue;
    }
    for (; setup < trace.setup.size() && trace.setup[setup].triangle == index; ++setup) {
      const SetupRecord& r = trace.setup[setup];
      const std::array<std::array<std::int64_t, 3>, 3> huv{
          {{r.h0, r.u0, r.v0}, {r.h1, r.u1, r.v1}, {r.h2, r.u2, r.v2}}};
      for (int i = 0; i < 3; ++i) {
        const IdealPoint& p = truth.vertex(n, i);
        const auto& raw = huv[static_cast<std::size_t>(i)];
        note(row_setup_h, raw[0], p.h);
        note(row_setup_u, raw[1], p.u);
        note(row_setup_v, raw[2], p.v);
      }
    }
    for (; row < trace.row.size() && trace.row[row].triangle == index; ++row) {
      const RowRecord& r = trace.row[row];
      const auto end = [&](std::int64_t edge, std::int64_t x, std::int64_t h, std::int64_t u,
                           std::int64_t v) {
        const IdealPoint p = truth.on_edge(n, static_cast<int>(edge), r.y);
        note(row_edge_x, x, p.x);
        if (has_setup_plane(config_)) return;  // ends have a position alone
        note(row_edge_h, h, p.h);
        note(row_edge_u, u, p.u);
        note(row_edge_v, v, p.v);
      };
      end(r.l_edge, r.l_x, r.l_h, r.l_u, r.l_v);
      end(r.r_edge, r.r_x, r.r_h, r.r_u, r.r_v);
    }
    const std::size_t begin = fragment;
    for (; fragment < trace.fragment.size() && trace.fragment[fragment].triangle == index; ++fragment) {
      const FragmentRecord& r = trace.fragment[fragment];
      if (r.covered == 0) {
        continue;
      }
      const IdealPoint p = truth.at(n, r.x, r.y).point;
      note(row_span_h, r.h, p.h);
      note(row_span_u, r.u, p.u);
      note(row_span_v, r.v, p.v);
      std::array<std::int64_t, 4> shade{r.r, r.g, r.b, r.a};
      if (has_perspective_shades(config_.shade_lines)) {
        for (const FragmentChannelRecord& channel : channels_of(trace, fragment)) {
          const auto c = channel.channel - (static_cast<std::int64_t>(LineId::shade_r) - fixed_lines);
          if (c >= 0 && c < 4) shade[static_cast<std::size_t>(c)] = channel.w;
        }
      }
      for (std::size_t i = 0; i < 4; ++i) note(row_span_shade, shade[i], p.shade[i]);
    }
    coverage(truth, n, std::span(trace.fragment).subspan(begin, fragment - begin));
    for (; state < trace.state.size() && trace.state[state].triangle <= index; ++state) {
      depth_bias_ = trace.state[state].depth_bias;
      combines_ = trace.state[state].texture1 >= 0;
      looks_up_otherwise_ = looks_up_otherwise(config_, trace.state[state]);
    }
    for (; depth < trace.depth.size() && trace.depth[depth].triangle == index; ++depth) {
      const DepthRecord& r = trace.depth[depth];
      note(row_depth_z, r.z, ideal_stored_code(config_, truth.at(n, r.x, r.y), depth_bias_));
    }
    for (; project < trace.project.size() && trace.project[project].triangle == index; ++project) {
      const ProjectRecord& r = trace.project[project];
      if (r.inside == 0) continue;  // nothing is looked up there
      const auto at = ideal_projection(config_, *scene_, truth.at(n, r.x, r.y).point);
      if (!at) continue;
      note(row_project_s, r.s, at->s);
      note(row_project_t, r.t, at->t);
      note(row_project_z, r.z, held_code(config_, *at));
    }
    for (; texture < trace.texture.size() && trace.texture[texture].triangle == index; ++texture) {
      const TextureRecord& r = trace.texture[texture];
      const IdealFragment f = truth.at(n, r.x, r.y);
      if (r.killed != 0 || f.killed || looks_up_otherwise_) {
        continue;
      }
      const std::array<std::int64_t, 3> rgb{r.r, r.g, r.b};
      for (std::size_t i = 0; i < 3; ++i) note(row_texture_color, rgb[i], f.color[i]);
    }
    for (; light < trace.light.size() && trace.light[light].triangle == index; ++light) {
      const LightRecord& r = trace.light[light];
      const IdealFragment f = truth.at(n, r.x, r.y);
      if (f.killed) continue;
      note(row_light_value, r.value, f.light.value);
      if (lights_pixels(config_.light)) {
        const std::array<std::int64_t, 3> normal{r.nx, r.ny, r.nz};
        const std::array<std::int64_t, 3> direction{r.lx, r.ly, r.lz};
        for (std::size_t i = 0; i < 3; ++i) note(row_light_normal, normal[i], f.light.normal[i]);
        for (std::size_t i = 0; i < 3; ++i) note(row_light_direction, direction[i], f.light.direction[i]);
        note(row_light_cosine, r.cosine, f.light.cosine);
        note(row_light_specular, r.specular, f.light.specular);
      }
      if (combines_ || looks_up_otherwise_) continue;
      const std::array<std::int64_t, 3> rgb{r.r, r.g, r.b};
      for (std::size_t i = 0; i < 3; ++i) note(row_light_color, rgb[i], f.lit[i]);
    }
    for (; fog < trace.fog.size() && trace.fog[fog].triangle == index; ++fog) {
      const FogRecord& r = trace.fog[fog];
      const IdealFragment f = truth.at(n, r.x, r.y);
      if (!fogged || f.killed) {
        continue;
      }
      note(row_fog_factor, r.factor, f.fog_factor);
      const std::array<std::int64_t, 3> rgb{r.r, r.g, r.b};
      const bool differs = combines_ || looks_up_otherwise_;
      for (std::size_t i = 0; !differs && i < 3; ++i) note(row_fog_color, rgb[i], f.fogged[i]);
    }
  }
}

void ErrorMeter::add_pictures(const Frame& engine, const Frame& ideal) {
  const std::vector<DrawState> states = all_states_of(config_, scene_->commands);
  const auto weighs = [&](const DrawState& s) {
    return weighs_texels(s.texture_filter) || (has_lod(config_) && weighs_texels(first_magnified(s).filter));
  };
  const PicturePair pair(
      engine, ideal, *scene_,
      std::ranges::any_of(states, weighs) ? TextureFilter::bilinear : TextureFilter::nearest);
  std::vector<PictureTally> tallies;
  for (const PictureMetric& metric : picture_metrics()) tallies.push_back(metric.tally(pair));
  add_tallies(tallies, report_.picture);
  for (std::size_t i = 0; i < pair.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      stat(row_picture_color).add(engine.color[4 * i + c], ideal.color[4 * i + c]);
    }
    if (engine.triangle[i] < 0 || engine.triangle[i] != ideal.triangle[i]) continue;
    stat(row_picture_depth).add(engine.depth[i], ideal.depth[i]);
    stat(row_picture_u).add(engine.u[i], ideal.u[i]);
    stat(row_picture_v).add(engine.v[i], ideal.v[i]);
  }
}

PictureErrors picture_errors(const Frame& engine, const Frame& ideal) {
  const std::size_t pixels = engine.depth.size();
  const std::vector<double> none(pixels, std::numeric_limits<double>::quiet_NaN());
  PictureErrors out{none, none};
  for (std::size_t i = 0; i < pixels; ++i) {
    if (engine.triangle[i] < 0 || engine.triangle[i] != ideal.triangle[i]) continue;
    out.depth[i] = std::fabs(static_cast<double>(engine.depth[i]) - static_cast<double>(ideal.depth[i]));
    out.texture[i] = std::hypot(engine.u[i] - ideal.u[i], engine.v[i] - ideal.v[i]);
  }
  return out;
}

std::string psnr_text(double psnr_db) {
  return std::isinf(psnr_db) ? "infinite (equal)" : fmt::format("{:.2f} dB", psnr_db);
}

}  // namespace bitspan
