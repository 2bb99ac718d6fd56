#include "report/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

namespace bitspan {
namespace {

enum Row {
  row_setup_h,
  row_setup_u,
  row_setup_v,
  row_edge_x,
  row_edge_h,
  row_edge_u,
  row_edge_v,
  row_span_h,
  row_span_u,
  row_span_v,
  row_span_shade,
  row_depth_z,
  row_texture_color,
  row_fog_factor,
  row_fog_color,
  row_merge_color,
  row_frame_depth,
  row_frame_u,
  row_frame_v,
  row_count
};

constexpr std::array<std::array<const char*, 3>, row_count> row_names{{
    {"setup", "h", "depth code"},
    {"setup", "u", "texel"},
    {"setup", "v", "texel"},
    {"edge_walk", "x", "pixel"},
    {"edge_walk", "h", "depth code"},
    {"edge_walk", "u", "texel"},
    {"edge_walk", "v", "texel"},
    {"span", "h", "depth code"},
    {"span", "u", "texel"},
    {"span", "v", "texel"},
    {"span", "shade", "1"},
    {"depth", "z", "depth code"},
    {"texture", "colour", "colour code"},
    {"fog", "factor", "1"},
    {"fog", "colour", "colour code"},
    {"picture", "colour", "colour code"},
    {"picture", "depth", "depth code"},
    {"picture", "u", "texel"},
    {"picture", "v", "texel"},
}};

double ulp(const Format& format) { return std::ldexp(1.0, -format.fraction()); }

// The one of "h", "u", "v", "r", "g", "b", "a" at a point of the surface.
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
    return field.substr(2) == "x" ? std::optional(p.x) : surface_value(field.substr(2), p);
  }
  if (type < RecordType::fragment) {
    return std::nullopt;
  }
  const IdealFragment f = ideal_at(config, scene, *t, value("x"), value("y"));
  if (type == RecordType::fragment) {
    return surface_value(field, f.point);
  }
  if (field == "z") {
    return f.z;
  }
  const auto channel = std::string_view("rgb").find(field);
  const bool is_channel = field.size() == 1 && channel != std::string_view::npos;
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
  if (type == RecordType::fog && !f.killed) {
    if (field == "factor") {
      return f.fog_factor;
    }
    return is_channel ? std::optional(f.fogged[channel]) : std::nullopt;
  }
  return std::nullopt;  // what merge stores depends on what was there before
}

ErrorMeter::ErrorMeter(const Config& config, const Scene& scene) : config_(config), scene_(&scene) {
  for (const auto& name : row_names) {
    report_.rows.push_back({name[0], name[1], name[2], {}});
  }
}

// Each pixel of the triangle's box against the fill rule.
void ErrorMeter::coverage(const IdealTriangle& t, const Trace& trace, std::size_t begin, std::size_t end) {
  const int k = config_.subpixel_bits;
  const auto box = [&](std::int64_t a, std::int64_t b, std::int64_t c, int size) {
    return std::pair{std::clamp<std::int64_t>((std::min({a, b, c}) >> k) - 1, 0, size),
                     std::clamp<std::int64_t>((std::max({a, b, c}) >> k) + 2, 0, size)};
  };
  const auto [x0, x1] = box(t.v[0].x, t.v[1].x, t.v[2].x, scene_->width);
  const auto [y0, y1] = box(t.v[0].y, t.v[1].y, t.v[2].y, scene_->height);
  const auto wide = static_cast<std::size_t>(x1 - x0);
  hits_.assign(wide * static_cast<std::size_t>(y1 - y0), 0);
  for (std::size_t i = begin; i < end; ++i) {
    const FragmentRecord& f = trace.fragment[i];
    if (f.covered == 0) {
      continue;
    }
    if (f.x < x0 || f.x >= x1 || f.y < y0 || f.y >= y1) {
      ++report_.surplus;
      continue;
    }
    std::uint8_t& hit = hits_[static_cast<std::size_t>(f.y - y0) * wide + static_cast<std::size_t>(f.x - x0)];
    report_.doubled += hit;
    hit = 1;
  }
  for (std::int64_t y = y0; y < y1; ++y) {
    for (std::int64_t x = x0; x < x1; ++x) {
      const bool inside = ideal_covers(config_, t, x, y);
      const bool hit = hits_[static_cast<std::size_t>(y - y0) * wide + static_cast<std::size_t>(x - x0)] != 0;
      report_.covered += static_cast<std::uint64_t>(inside);
      report_.missed += static_cast<std::uint64_t>(inside && !hit);
      report_.surplus += static_cast<std::uint64_t>(!inside && hit);
    }
  }
}

void ErrorMeter::add(std::span<const Triangle> triangles, std::int64_t first_index, const Trace& trace) {
  const double setup_h = ulp(config_.format(FormatId::setup_h));
  const double setup_uv = ulp(config_.format(FormatId::setup_uv));
  const double edge_x = ulp(config_.format(FormatId::edge_x));
  const double edge_h = ulp(config_.format(FormatId::edge_h));
  const double edge_uv = ulp(config_.format(FormatId::edge_uv));
  const double span_h = ulp(config_.format(FormatId::span_h));
  const double span_uv = ulp(config_.format(FormatId::span_uv));
  const double span_shade = ulp(config_.format(FormatId::span_shade));
  const double texture_color = ulp(config_.format(FormatId::texture_color));
  const double fog_factor = ulp(config_.format(FormatId::fog_factor));
  const double fog_color = ulp(config_.format(FormatId::fog_color));
  const bool fogged = scene_->fog.has_value() && config_.fog != FogMode::none;

  std::size_t setup = 0;
  std::size_t row = 0;
  std::size_t fragment = 0;
  std::size_t depth = 0;
  std::size_t texture = 0;
  std::size_t fog = 0;
  // Records stand in the order of the triangles: one cursor a type.
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const std::int64_t index = first_index + static_cast<std::int64_t>(n);
    const auto ideal = ideal_triangle(config_, triangles[n]);
    if (!ideal) {
      continue;
    }
    const IdealTriangle& t = *ideal;
    for (; setup < trace.setup.size() && trace.setup[setup].triangle == index; ++setup) {
      const SetupRecord& r = trace.setup[setup];
      const std::array<std::array<std::int64_t, 3>, 3> huv{
          {{r.h0, r.u0, r.v0}, {r.h1, r.u1, r.v1}, {r.h2, r.u2, r.v2}}};
      for (int i = 0; i < 3; ++i) {
        const IdealPoint p = ideal_at_vertex(config_, *scene_, t, i);
        const auto& raw = huv[static_cast<std::size_t>(i)];
        stat(row_setup_h).add(static_cast<double>(raw[0]) * setup_h - p.h);
        stat(row_setup_u).add(static_cast<double>(raw[1]) * setup_uv - p.u);
        stat(row_setup_v).add(static_cast<double>(raw[2]) * setup_uv - p.v);
      }
    }
    for (; row < trace.row.size() && trace.row[row].triangle == index; ++row) {
      const RowRecord& r = trace.row[row];
      const auto end = [&](std::int64_t edge, std::int64_t x, std::int64_t h, std::int64_t u,
                           std::int64_t v) {
        const IdealPoint p = ideal_on_edge(config_, *scene_, t, static_cast<int>(edge), r.y);
        stat(row_edge_x).add(static_cast<double>(x) * edge_x - p.x);
        stat(row_edge_h).add(static_cast<double>(h) * edge_h - p.h);
        stat(row_edge_u).add(static_cast<double>(u) * edge_uv - p.u);
        stat(row_edge_v).add(static_cast<double>(v) * edge_uv - p.v);
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
      const IdealPoint p =
          ideal_point(config_, *scene_, t, static_cast<double>(r.x) + 0.5, static_cast<double>(r.y) + 0.5);
      stat(row_span_h).add(static_cast<double>(r.h) * span_h - p.h);
      stat(row_span_u).add(static_cast<double>(r.u) * span_uv - p.u);
      stat(row_span_v).add(static_cast<double>(r.v) * span_uv - p.v);
      const std::array<std::int64_t, 4> shade{r.r, r.g, r.b, r.a};
      for (std::size_t i = 0; i < 4; ++i) {
        stat(row_span_shade).add(static_cast<double>(shade[i]) * span_shade - p.shade[i]);
      }
    }
    coverage(t, trace, begin, fragment);
    for (; depth < trace.depth.size() && trace.depth[depth].triangle == index; ++depth) {
      const DepthRecord& r = trace.depth[depth];
      stat(row_depth_z).add(static_cast<double>(r.z) - ideal_at(config_, *scene_, t, r.x, r.y).z);
    }
    for (; texture < trace.texture.size() && trace.texture[texture].triangle == index; ++texture) {
      const TextureRecord& r = trace.texture[texture];
      const IdealFragment f = ideal_at(config_, *scene_, t, r.x, r.y);
      if (r.killed != 0 || f.killed) {
        continue;
      }
      const std::array<std::int64_t, 3> rgb{r.r, r.g, r.b};
      for (std::size_t i = 0; i < 3; ++i) {
        stat(row_texture_color).add(static_cast<double>(rgb[i]) * texture_color - f.color[i]);
      }
    }
    for (; fog < trace.fog.size() && trace.fog[fog].triangle == index; ++fog) {
      const FogRecord& r = trace.fog[fog];
      const IdealFragment f = ideal_at(config_, *scene_, t, r.x, r.y);
      if (!fogged || f.killed) {
        continue;
      }
      stat(row_fog_factor).add(static_cast<double>(r.factor) * fog_factor - f.fog_factor);
      const std::array<std::int64_t, 3> rgb{r.r, r.g, r.b};
      for (std::size_t i = 0; i < 3; ++i) {
        stat(row_fog_color).add(static_cast<double>(rgb[i]) * fog_color - f.fogged[i]);
      }
    }
  }
}

void ErrorMeter::add_pictures(const Frame& engine, const Frame& ideal) {
  report_.has_picture = true;
  const std::size_t pixels = std::min(engine.depth.size(), ideal.depth.size());
  report_.pixels += pixels;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int d = static_cast<int>(engine.color[4 * i + c]) - static_cast<int>(ideal.color[4 * i + c]);
      stat(row_merge_color).add(d);
      report_.color_max = std::max(report_.color_max, std::abs(d));
    }
    if (engine.triangle[i] < 0 && ideal.triangle[i] < 0) {
      continue;
    }
    ++report_.drawn;
    if (engine.triangle[i] != ideal.triangle[i]) {
      ++report_.wrong_order;
      continue;
    }
    stat(row_frame_depth).add(static_cast<double>(engine.depth[i]) - static_cast<double>(ideal.depth[i]));
    stat(row_frame_u).add(engine.u[i] - ideal.u[i]);
    stat(row_frame_v).add(engine.v[i] - ideal.v[i]);
  }
  const ErrorStat& color = stat(row_merge_color);
  report_.psnr_db = color.squares == 0
                        ? std::numeric_limits<double>::infinity()
                        : 10 * std::log10(255.0 * 255.0 * static_cast<double>(color.count) / color.squares);
}

std::string psnr_text(double psnr_db) {
  return std::isinf(psnr_db) ? "infinite (equal)" : fmt::format("{:.2f} dB", psnr_db);
}

}  // namespace bitspan
