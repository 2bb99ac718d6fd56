// SPDX-License-Identifier: Apache-2.0
// The table of lines: every value that setup interpolates over a triangle, with its registers at the
// vertices, along an edge and along a row. docs/numeric-spec.md says how each is formed.
//
// The first seven are fields of the records of their stages. The others are channels: they have records of
// their own, and only where they are in use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "config/config.hpp"
#include "config/modes.hpp"

namespace bitspan {

enum class LineId : std::uint8_t {
  h,
  fu,
  fv,
  r,
  g,
  b,
  a,
  fog,
  project_x,
  project_y,
  project_w,
  shade_r,
  shade_g,
  shade_b,
  shade_a,
  z,
  u2,
  v2,
  nx,
  ny,
  nz,
  light,
  lx,
  ly,
  lz,
  count
};
inline constexpr int line_count = static_cast<int>(LineId::count);
// The lines that every triangle has, and those beside them.
inline constexpr int fixed_lines = static_cast<int>(LineId::fog);
inline constexpr int channel_limit = line_count - fixed_lines;

// How a line goes on, along an edge or along a row.
struct LineWalk {
  FormatId step, acc;  // the slope; the register that adds it up
  FormatId kept;       // what the stage behind takes of acc
  // Added where acc starts; null: nothing is. Half an ulp of it is one of half_ulp_of; none: of the depth
  // code.
  StartOffset StartOffsets::*offset = nullptr;
  std::optional<FormatId> half_ulp_of = std::nullopt;
  std::optional<FormatId> difference = std::nullopt;  // a register between two ends and their slope
};

struct Line {
  LineId id;
  std::string_view name;
  FormatId vertex;
  LineWalk edge;
  FormatId gradient;  // of the triangle's plane
  LineWalk row;
  // A homogeneous line is formed as w (h + B) at a vertex, in the register `product`, and the consumer
  // divides it by this line's value, which is h + B for h. None: the line is linear.
  std::optional<LineId> divisor = std::nullopt;
  std::optional<FormatId> product = std::nullopt;
  // Of a homogeneous channel: span divides it by h + B, and row.kept is of the quotient. Else its consumer
  // does.
  bool span_divides = false;

  constexpr bool is_homogeneous() const { return divisor.has_value(); }
  // What is interpolated from: the product, or the vertex itself.
  constexpr FormatId walked() const { return is_homogeneous() ? *product : vertex; }
};

constexpr Line line_of(LineId id, Perspective perspective) {
  using F = FormatId;
  using S = StartOffsets;
  const auto shade = [&](std::string_view name) {
    return Line{.id = id,
                .name = name,
                .vertex = F::setup_shade,
                .edge = {F::edge_shade_step, F::edge_shade_acc, F::edge_shade, &S::edge_shade, F::edge_shade},
                .gradient = F::plane_shade_grad,
                .row = {F::span_shade_step, F::span_shade_acc, F::span_shade, &S::span_shade, F::span_shade}};
  };
  // u and v: by their numerators u (h + B), or by themselves.
  const auto texture = [&](std::string_view name) {
    Line line{.id = id,
              .name = name,
              .vertex = F::setup_uv,
              .edge = {F::edge_f_step, F::edge_f, F::edge_uv, &S::edge_f, F::edge_f, F::edge_f_diff},
              .gradient = F::plane_g_grad,
              .row = {F::span_f_step, F::span_f, F::span_uv, &S::span_f, F::span_f, F::span_f_diff},
              .product = F::plane_g};
    if (!has_linear_edges(perspective)) line.divisor = LineId::h;
    if (has_linear_texture(perspective)) {
      line.row = {F::span_uv_step, F::span_uv_acc, F::span_uv, &S::span_f, F::span_uv};
    }
    return line;
  };
  // A channel that is divided as u and v are, by its pixel.
  const auto divided = [](Line line) {
    line.divisor = LineId::h;
    line.span_divides = true;
    return line;
  };
  const auto perspective_shade = [&](std::string_view name) {
    return divided({.id = id,
                    .name = name,
                    .vertex = F::setup_shade,
                    .edge = {F::shade_step, F::shade_acc, F::shade_acc},
                    .gradient = F::shade_grad,
                    .row = {F::shade_step, F::shade_acc, F::shade_value},
                    .product = F::shade_acc});
  };
  const auto second_texture = [&](std::string_view name) {
    return divided({.id = id,
                    .name = name,
                    .vertex = F::setup_uv,
                    .edge = {F::edge_f_step, F::edge_f, F::edge_f},
                    .gradient = F::plane_g_grad,
                    .row = {F::span_f_step, F::span_f, F::span_uv},
                    .product = F::plane_g});
  };
  const auto depth = [&](std::string_view name) {
    return Line{.id = id,
                .name = name,
                .vertex = F::setup_h,
                .edge = {F::edge_h_step, F::edge_h_acc, F::edge_h, &S::edge_h, F::edge_h},
                .gradient = F::plane_h_grad,
                .row = {F::span_h_step, F::span_h, F::span_h, &S::span_h}};
  };
  // A channel that is linear. The register behind its accumulator rounds by itself.
  const auto channel = [&](std::string_view name, F vertex, F step, F acc, F gradient, F consumer) {
    return Line{.id = id,
                .name = name,
                .vertex = vertex,
                .edge = {step, acc, acc},
                .gradient = gradient,
                .row = {step, acc, consumer}};
  };
  const auto normal = [&](std::string_view name) {
    return channel(name, F::normal_vertex, F::normal_step, F::normal_acc, F::normal_grad, F::normal_value);
  };
  const auto relief = [&](std::string_view name) {
    return channel(name, F::relief_vertex, F::relief_step, F::relief_acc, F::relief_grad, F::relief_value);
  };
  // One that is homogeneous. Its products are walked in the accumulators' format.
  const auto homogeneous = [&](Line line, LineId divisor) {
    line.divisor = divisor;
    line.product = line.edge.acc;
    return line;
  };
  const auto project = [&](std::string_view name, LineId divisor) {
    return homogeneous(
        channel(name, F::project_vertex, F::project_step, F::project_acc, F::project_grad, F::project_value),
        divisor);
  };
  switch (id) {
    case LineId::h:
      return depth("h");
    case LineId::fu:
      return texture("fu");
    case LineId::fv:
      return texture("fv");
    case LineId::r:
      return shade("r");
    case LineId::g:
      return shade("g");
    case LineId::b:
      return shade("b");
    case LineId::a:
      return shade("a");
    case LineId::fog:
      return channel("fog", F::fog_vertex, F::fog_step, F::fog_acc, F::fog_grad, F::fog_factor);
    case LineId::project_x:
      return project("project_x", LineId::project_w);
    case LineId::project_y:
      return project("project_y", LineId::project_w);
    case LineId::project_w:
      return project("project_w", LineId::h);
    case LineId::shade_r:
      return perspective_shade("shade_r");
    case LineId::shade_g:
      return perspective_shade("shade_g");
    case LineId::shade_b:
      return perspective_shade("shade_b");
    case LineId::shade_a:
      return perspective_shade("shade_a");
    case LineId::z:
      return depth("z");
    case LineId::u2:
      return second_texture("u2");
    case LineId::v2:
      return second_texture("v2");
    case LineId::nx:
      return normal("nx");
    case LineId::ny:
      return normal("ny");
    case LineId::nz:
      return normal("nz");
    case LineId::light:
      return channel("light", F::light_vertex, F::light_step, F::light_acc, F::light_grad, F::light_value);
    case LineId::lx:
      return relief("lx");
    case LineId::ly:
      return relief("ly");
    case LineId::lz:
      return relief("lz");
    case LineId::count:
      break;
  }
  unreachable();
}

// The register of the colour and alpha factors that texture takes.
constexpr FormatId shade_factor(const Config& config) {
  return has_perspective_shades(config.shade_lines) ? FormatId::shade_value : FormatId::span_shade;
}

// The line of a channel by its number in the records.
constexpr LineId channel_line(std::int64_t channel) { return static_cast<LineId>(fixed_lines + channel); }
// Whether the configuration has the channel, in a scene that asks for it.
constexpr bool has_channel(const Config& config, LineId line) {
  switch (line) {
    case LineId::h:
    case LineId::fu:
    case LineId::fv:
    case LineId::r:
    case LineId::g:
    case LineId::b:
    case LineId::a:
    case LineId::count:
      return false;
    case LineId::fog:
      return has_vertex_fog(config.fog);
    case LineId::project_x:
    case LineId::project_y:
    case LineId::project_w:
      return has_project(config.project);
    case LineId::shade_r:
    case LineId::shade_g:
    case LineId::shade_b:
    case LineId::shade_a:
      return has_perspective_shades(config.shade_lines);
    case LineId::z:
      return has_own_depth(config.depth_line);
    case LineId::u2:
    case LineId::v2:
      return has_second_coordinates(config.second_coordinates);
    case LineId::nx:
    case LineId::ny:
    case LineId::nz:
      return lights_pixels(config.light);
    case LineId::light:
      return lights_vertices(config.light);
    case LineId::lx:
    case LineId::ly:
    case LineId::lz:
      return has_relief(config);
  }
  unreachable();
}

// The numbers of the channels that a configuration has, in their order.
class ChannelList {
 public:
  constexpr explicit ChannelList(const Config& config) {
    for (int c = 0; c < channel_limit; ++c) {
      if (has_channel(config, channel_line(c))) channels_[static_cast<std::size_t>(size_++)] = c;
    }
  }
  constexpr const int* begin() const { return channels_.data(); }
  constexpr const int* end() const { return channels_.data() + size_; }
  constexpr std::size_t size() const { return size_; }

 private:
  std::array<int, channel_limit> channels_{};
  std::size_t size_ = 0;
};

}  // namespace bitspan
