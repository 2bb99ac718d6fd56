// SPDX-License-Identifier: Apache-2.0
#include "study/cost.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <variant>

#include "config/grid.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "config/reciprocal.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {
namespace {

using F = FormatId;

bool always(const Config&) { return true; }
bool plane_rows(const Config& c) { return has_plane_rows(c.perspective); }
bool line_slope(const Config& c) { return has_line_slope(c.line_walk); }
bool horizontal(const Config& c) { return !plane_rows(c); }
bool affine(const Config& c) { return has_linear_edges(c.perspective); }
bool delta_f(const Config& c) { return has_pixel_reciprocal(c.perspective); }
bool hyperbolic(const Config& c) { return has_pixel_quotients(c.perspective); }
bool perspective_ends(const Config& c) { return delta_f(c) || hyperbolic(c); }
bool dda(const Config& c) { return horizontal(c) && has_x_step(c); }
// Rows start from the triangle's plane; or else from their ends.
bool by_plane(const Config& c) { return has_setup_plane(c); }
bool row_ends(const Config& c) { return horizontal(c) && !by_plane(c); }
bool edge_unit(const Config& c) {
  return horizontal(c) && shares_reciprocal(c.edge_slope) && (row_ends(c) || has_x_step(c));
}
bool plane_unit(const Config& c) { return by_plane(c) && shares_reciprocal(c.edge_slope); }
// Both take the same unit, of edges and of areas.
bool triangle_unit(const Config& c) { return edge_unit(c) || plane_unit(c); }
bool row_unit(const Config& c) {
  return plane_rows(c) || (row_ends(c) && shares_reciprocal(form_of(c.row_slope)));
}
bool linear_depth(const Config& c) { return is_linear_in_distance(c.depth_code); }
bool linear_fog(const Config& c) { return is_linear_in_distance(c.fog); }
bool any_fog(const Config& c) { return has_fog(c.fog); }
bool own_s(const Config& c) { return has_lod_zones(c) && !takes_true_distance(c.lod); }
bool zones(const Config& c) { return has_lod_zones(c); }
bool any_distance(const Config& c) { return has_distance(c); }
bool true_distance(const Config& c) { return has_true_distance(c); }
bool fog_by_log(const Config& c) { return takes_distance(c.fog) && !takes_true_distance(c.fog); }
bool neighbours(const Config& c) { return has_lod_gradients(c) && has_neighbours(c.lod); }
bool gradients(const Config& c) { return has_lod_gradients(c); }
bool levels(const Config& c) { return has_lod(c); }
bool blends_by_equation(const Config& c) { return has_blend_equation(c.rtl.blend); }
bool two_levels(const Config& c) { return mixes_levels(c.mip); }
// The users at a pixel take the reciprocal of the same h + B, so they share one unit.
bool pixel_unit(const Config& c) {
  return delta_f(c) || linear_depth(c) || linear_fog(c) || has_s(c) || (gradients(c) && !neighbours(c));
}
bool bilinear(const Config& c) {
  switch (c.filter) {
    case TextureFilter::nearest:
      return false;
    case TextureFilter::bilinear:
      return true;
  }
  unreachable();
}
bool nearest(const Config& c) {
  switch (c.filter) {
    case TextureFilter::nearest:
      return true;
    case TextureFilter::bilinear:
      return false;
  }
  unreachable();
}

bool two_nearest(const Config& c) { return two_levels(c) && nearest(c); }
bool two_bilinear(const Config& c) { return two_levels(c) && bilinear(c); }
bool divided_ends(const Config& c) { return row_ends(c) && perspective_ends(c); }
bool delta_f_ends(const Config& c) { return row_ends(c) && delta_f(c); }
bool hyperbolic_ends(const Config& c) { return row_ends(c) && hyperbolic(c); }
bool row_gradients(const Config& c) { return has_setup_gradients(c) && horizontal(c); }
bool projects(const Config& c) { return has_project(c.project); }
bool lights(const Config& c) { return has_light(c.light); }
bool lights_points(const Config& c) { return has_light_points(c); }
bool lights_lunar(const Config& c) { return has_lunar(c); }
bool lights_fall(const Config& c) { return has_light_fall(c); }
bool lights_shadow(const Config& c) { return has_light_shadow(c); }
// L differs from pixel to pixel.
bool lights_turn(const Config& c) { return has_light_points(c) || has_relief(c); }
// Brightness falls along another vector than L: to the viewer, or to a light that a texel's field has
// elsewhere.
bool lights_away(const Config& c) {
  return has_light_fall(c) && (falls_to_viewer(c.light_fall_to) || has_relief(c));
}
bool lights_divide(const Config& c) { return has_lunar(c) || has_light_fall(c); }
bool packed_depth(const Config& c) { return has_dz(c.depth_code); }

constexpr std::string_view kAlways = "always";
constexpr std::string_view kHorizontal = "all modes but const_depth_rows";
constexpr std::string_view kRowEnds = "all modes but const_depth_rows, slope.row = divide, reciprocal";
constexpr std::string_view kByPlane = "slope.row = plane";
constexpr std::string_view kDda = "edge_walk = dda, all modes but const_depth_rows";
constexpr std::string_view kPlane = "const_depth_rows";
constexpr std::string_view kLines = "line.walk = dda";
constexpr std::string_view kZones = "lod.mode = zone_s, zone_d";
constexpr std::string_view kDistance =
    "lod.mode = zone_d, or fog.mode = distance, log, or light.at = pixel with light.source = point";
constexpr std::string_view kS =
    "lod.mode = zone_s, zone_d, or fog.mode = distance, log, or light.at = pixel with light.source = point";
constexpr std::string_view kTrueDistance = "lod.mode = zone_d, or fog.mode = distance";
constexpr std::string_view kGradients =
    "lod.mode = gradient, finite, or depth.code = float_dz, all modes but const_depth_rows";
constexpr std::string_view kTwoNearest = "texture.mip = linear, texture.filter = nearest";
constexpr std::string_view kTwoBilinear = "texture.mip = linear, texture.filter = bilinear";
constexpr std::string_view kPixelUnit =
    "delta_f, or depth.code = linear, or fog.mode = linear, distance, log, or lod.mode = zone_s, zone_d, "
    "gradient, or light.at = pixel with light.source = point";
constexpr std::string_view kChannel = "channel in use";
constexpr std::string_view kChannelEnds =
    "channel in use, all modes but const_depth_rows, slope.row = divide, reciprocal";
constexpr std::string_view kChannelPlanes = "channel in use, const_depth_rows or slope.row = plane";
constexpr std::string_view kChannelPlaneRows = "channel in use, const_depth_rows";
constexpr std::string_view kProject = "project.unit = reciprocal";
constexpr std::string_view kLight = "light.at = face, vertex, pixel";
constexpr std::string_view kLightPoint = "light.at = face, vertex, pixel with light.source = point";
constexpr std::string_view kLightTurns =
    "light.at = face, vertex, pixel with light.source = point, or light.normal = map";
constexpr std::string_view kLightLunar = "light.at = face, vertex, pixel with light.law = lunar";
constexpr std::string_view kLightFall = "light.at = face, vertex, pixel with light.fall = first, second";
constexpr std::string_view kLightAway =
    "light.at = face, vertex, pixel with light.fall = first, second and light.fall_to = viewer or "
    "light.normal = map";
constexpr std::string_view kLightShadow = "light.at = pixel with light.shadow = map";
constexpr std::string_view kLightDivides =
    "light.at = face, vertex, pixel with light.law = lunar or light.fall = first, second";
constexpr std::string_view kEnds = "delta_f, hyperbolic";
constexpr std::string_view kDividedEnds = "delta_f, hyperbolic, slope.row = divide, reciprocal";

template <F id>
int word(const Config& c) {
  return c.format(id).word;
}
int coordinate_word(const Config& c) { return c.coordinate_format().word; }
int depth_word(const Config& c) { return c.depth_bits; }
int dz_word(const Config&) { return dz_bits; }
int phase_word(const Config& c) { return c.format(F::plane_k).fraction(); }
int edge_output(const Config& c) { return c.edge_reciprocal.output.word; }
int row_output(const Config& c) { return c.row_reciprocal.output.word; }
int pixel_output(const Config& c) { return c.pixel_reciprocal.output.word; }

template <F id>
RegisterRule rule(std::string_view stage, int times, std::string_view condition,
                  bool (*used)(const Config&)) {
  return {stage, key_of(id), times, condition, used, word<id>};
}

// The registers of a channel, of which every triangle and row in the pipeline has its own.
template <int channel>
void add_channel(std::vector<RegisterRule>& rules) {
  static constexpr LineId id = channel_line(channel);
  constexpr bitspan::Line line = line_of(id, Perspective{});
  const auto used = [](const Config& c) { return has_channel(c, id); };
  const auto at_ends = [](const Config& c) { return has_channel(c, id) && row_ends(c); };
  const auto on_plane = [](const Config& c) { return has_channel(c, id) && !row_ends(c); };
  const auto in_plane_rows = [](const Config& c) { return has_channel(c, id) && plane_rows(c); };
  rules.push_back(rule<line.vertex>("setup.channel", 3, kChannel, used));
  if constexpr (line.is_homogeneous()) {
    rules.push_back(rule<line.walked()>("setup.channel", 3, kChannel, used));
  }
  rules.push_back(rule<line.edge.step>("setup.channel", 3, kChannelEnds, at_ends));
  rules.push_back(rule<line.gradient>("setup.channel", 2, kChannelPlanes, on_plane));
  rules.push_back(rule<line.edge.acc>("edge_walk.channel", 2, kChannelEnds, at_ends));
  if constexpr (line.edge.kept != line.edge.acc) {
    rules.push_back(rule<line.edge.kept>("edge_walk.channel", 2, kChannelEnds, at_ends));
  }
  rules.push_back(rule<line.row.step>("span_setup.channel", 1, kChannel, used));
  rules.push_back(rule<line.row.step>("span_setup.channel", 1, kChannelPlaneRows, in_plane_rows));
  rules.push_back(rule<line.row.acc>("span.channel", 1, kChannel, used));
  if constexpr (line.span_divides) {
    rules.push_back(rule<line.row.kept>("span.channel", 1, kChannel, used));
  }
}

std::vector<RegisterRule> make_rules() {
  std::vector<RegisterRule> rules{
      // s_min' and s_max'
      rule<F::setup_s>("constants", 2, kAlways, always),
      rule<F::setup_b>("constants", 1, kAlways, always),
      rule<F::depth_c1>("constants", 1, "depth.code = linear", linear_depth),
      rule<F::depth_c0>("constants", 1, "depth.code = linear", linear_depth),
      rule<F::distance_a>("constants", 1, kS, [](const Config& c) { return has_s(c); }),
      rule<F::lod_k>("constants", max_mip_level, kZones, zones),
      // B_p and A_p
      rule<F::setup_b>("constants", 1, kProject, projects),
      rule<F::distance_a>("constants", 1, kProject, projects),
      rule<F::fog_scale>("constants", 1, "fog.mode = linear", linear_fog),
      // The light's direction or place, its shares, and 1 / F.
      rule<F::light_direction>("constants", 3, kLight, lights),
      rule<F::light_value>("constants", 3, kLight, lights),
      rule<F::light_position>("constants", 3, kLightPoint, lights_points),
      rule<F::light_scale>("constants", 1, kLightPoint, lights_points),
      rule<F::light_lunar>("constants", 1, kLightLunar, lights_lunar),
      rule<F::light_scale>("constants", 1, kLightFall, lights_fall),
      rule<F::light_distance>("constants", 1, kLightFall, lights_fall),

      // Three vertices wait for one another. s is not needed after h is formed.
      {"setup", "coordinate", 6, kAlways, always, coordinate_word},
      rule<F::setup_s>("setup", 1, kAlways, always),
      rule<F::setup_h>("setup", 3, kAlways, always),
      rule<F::setup_uv>("setup", 6, kAlways, always),
      rule<F::setup_shade>("setup", 12, kAlways, always),

      // Three edges' slopes are held while the triangle is walked. The rest passes through.
      {"setup.edge", "reciprocal.edge.output", 1, "slope.edge = reciprocal, all modes but const_depth_rows",
       triangle_unit, edge_output},
      rule<F::edge_x_step>("setup.edge", 3, kDda, dda),
      rule<F::edge_h_step>("setup.edge", 3, kRowEnds, row_ends),
      rule<F::edge_f_diff>("setup.edge", 2, kRowEnds, row_ends),
      rule<F::edge_f_step>("setup.edge", 6, kRowEnds, row_ends),
      rule<F::edge_shade_step>("setup.edge", 12, kRowEnds, row_ends),

      // plane_walk has these anyway.
      rule<F::plane_g>("setup.gradient", 6, kGradients, row_gradients),
      rule<F::plane_h_grad>("setup.gradient", 2, kGradients, row_gradients),
      rule<F::plane_g_grad>("setup.gradient", 4, kGradients, row_gradients),

      // The numerators at three vertices, and two gradients of each quantity.
      rule<F::edge_uv>("setup.plane", 2, "delta_f, slope.row = plane",
                       [](const Config& c) { return by_plane(c) && delta_f(c); }),
      rule<F::plane_g>("setup.plane", 6, kByPlane, by_plane),
      rule<F::plane_h_grad>("setup.plane", 2, kByPlane, by_plane),
      rule<F::plane_g_grad>("setup.plane", 4, kByPlane, by_plane),
      rule<F::plane_shade_grad>("setup.plane", 8, kByPlane, by_plane),

      // The row has two ends.
      rule<F::edge_x_acc>("edge_walk", 2, kDda, dda),
      rule<F::edge_x>("edge_walk", 2, kHorizontal, horizontal),
      rule<F::edge_h_acc>("edge_walk", 2, kRowEnds, row_ends),
      rule<F::edge_h>("edge_walk", 2, kRowEnds, row_ends),
      rule<F::edge_f>("edge_walk", 4, kRowEnds, row_ends),
      {"edge_walk", "reciprocal.pixel.output", 1, kDividedEnds, divided_ends, pixel_output},
      rule<F::edge_uv>("edge_walk", 4, kRowEnds, row_ends),
      rule<F::edge_shade_acc>("edge_walk", 8, kRowEnds, row_ends),
      rule<F::edge_shade>("edge_walk", 8, kRowEnds, row_ends),

      // gu and gv stand at three vertices. Each has two gradients, and each has two steps per row.
      rule<F::plane_g>("plane_walk", 6, kPlane, plane_rows),
      rule<F::plane_h_grad>("plane_walk", 2, kPlane, plane_rows),
      rule<F::plane_g_grad>("plane_walk", 4, kPlane, plane_rows),
      rule<F::plane_shade_grad>("plane_walk", 8, kPlane, plane_rows),
      rule<F::plane_k>("plane_walk", 1, kPlane, plane_rows),
      rule<F::plane_k>("line_walk", 1, kLines, line_slope),
      rule<F::span_f>("plane_walk", 2, kPlane, plane_rows),
      rule<F::span_f_step>("plane_walk", 4, kPlane, plane_rows),

      {"span_setup", "reciprocal.row.output", 1, "slope.row = reciprocal, or const_depth_rows", row_unit,
       row_output},
      rule<F::span_h_step>("span_setup", 1, kHorizontal, horizontal),
      rule<F::span_f_diff>("span_setup", 2, "delta_f, slope.row = divide, reciprocal", delta_f_ends),
      rule<F::span_f_diff>("span_setup", 4, "hyperbolic, slope.row = divide, reciprocal", hyperbolic_ends),
      rule<F::span_f_step>("span_setup", 2, kEnds, perspective_ends),
      rule<F::span_uv_step>("span_setup", 2, "affine", affine),
      rule<F::span_uv_step>("span_setup", 4, kPlane, plane_rows),
      rule<F::span_shade_step>("span_setup", 4, kHorizontal, horizontal),
      rule<F::span_shade_step>("span_setup", 8, kPlane, plane_rows),

      // span_setup loads the accumulators.
      rule<F::span_h>("span", 1, kAlways, always),
      rule<F::span_f>("span", 2, kEnds, perspective_ends),
      rule<F::span_uv_acc>("span", 2, "affine, const_depth_rows",
                           [](const Config& c) { return affine(c) || plane_rows(c); }),
      rule<F::span_shade_acc>("span", 4, kAlways, always),
      {"span", "phase", 1, kPlane, plane_rows, phase_word},
      {"span", "reciprocal.pixel.output", 1, kPixelUnit, pixel_unit, pixel_output},
      rule<F::span_uv>("span", 2, kAlways, always),
      rule<F::span_shade>("span", 4, kAlways, always),

      {"depth", "depth.z", 1, kAlways, always, depth_word},
      {"depth", "dz", 1, "depth.code = float_dz", packed_depth, dz_word},

      rule<F::distance_s>("distance", 1, kDistance, any_distance),
      rule<F::distance_d>("distance", 1, kTrueDistance, true_distance),
      rule<F::distance_s>("lod", 1, "lod.mode = zone_s", own_s),
      {"lod", "reciprocal.pixel.output", 2, "lod.mode = finite", neighbours, pixel_output},
      rule<F::lod_slope>("lod", 4, "lod.mode = gradient, finite", gradients),
      rule<F::lod_lambda>("lod", 1, "texture.mip = nearest, linear", levels),
      rule<F::lod_frac>("lod", 1, "texture.mip = linear", two_levels),

      // Three colours and alpha pass: the texel, V1..V4, V5, V6 and V of the filter, and the fragment's own.
      rule<F::texture_frac>("texture", 2, "texture.filter = bilinear", bilinear),
      rule<F::texture_mix>("texture", 3, "texture.filter = nearest", nearest),
      rule<F::texture_mix>("texture", 9, "texture.filter = bilinear", bilinear),
      // The second level has a filter of its own; then both are mixed.
      rule<F::texture_frac>("texture", 2, kTwoBilinear, two_bilinear),
      rule<F::texture_mix>("texture", 6, kTwoNearest, two_nearest),
      rule<F::texture_mix>("texture", 12, kTwoBilinear, two_bilinear),
      rule<F::texture_color>("texture", 3, kAlways, always),
      rule<F::texture_alpha>("texture", 2, "texture.filter = nearest", nearest),
      rule<F::texture_alpha>("texture", 8, "texture.filter = bilinear", bilinear),
      rule<F::texture_alpha>("texture", 2, kTwoNearest, two_nearest),
      rule<F::texture_alpha>("texture", 8, kTwoBilinear, two_bilinear),

      // The second texture unit takes s and t of a fragment.
      rule<F::project_value>("project", 3, kProject, projects),
      {"project", "reciprocal.pixel.output", 1, kProject, projects, pixel_output},
      rule<F::span_uv>("project", 2, kProject, projects),
      rule<F::project_ratio>("project", 1, kProject, projects),
      rule<F::project_h>("project", 1, kProject, projects),
      {"project", "depth.z", 1, kProject, projects, depth_word},

      // One unit, for vertices or for pixels.
      rule<F::light_root>("light", 1, kLight, lights),
      rule<F::light_normal>("light", 3, kLight, lights),
      rule<F::light_position>("light", 3, kLightPoint, lights_points),
      rule<F::light_root>("light", 1, kLightTurns, lights_turn),
      rule<F::light_direction>("light", 3, kLightTurns, lights_turn),
      rule<F::light_root>("light", 1, kLightAway, lights_away),
      rule<F::light_direction>("light", 3, kLightAway, lights_away),
      rule<F::light_root>("light", 1, kLightLunar, lights_lunar),
      rule<F::light_root>("light", 1, kLightFall, lights_fall),
      rule<F::light_cosine>("light", 2, kLight, lights),
      rule<F::light_inverse>("light", 1, kLightDivides, lights_divide),
      rule<F::light_lunar>("light", 1, kLightLunar, lights_lunar),
      rule<F::light_cosine>("light", 1, kLightLunar, lights_lunar),
      rule<F::light_position>("light", 1, kLightFall, lights_fall),
      rule<F::light_distance>("light", 2, kLightFall, lights_fall),
      rule<F::light_fall>("light", 1, kLightFall, lights_fall),
      rule<F::light_value>("light", 1, kLightFall, lights_fall),
      rule<F::light_value>("light", 1, kLightShadow, lights_shadow),
      rule<F::light_specular>("light", 1, kLight, lights),
      rule<F::light_value>("light", 1, kLight, lights),
      rule<F::texture_color>("light", 3, kLight, lights),

      rule<F::fog_factor>("fog", 1, "fog.mode = linear, table, distance, log, vertex", any_fog),
      rule<F::fog_color>("fog", 3, kAlways, always),
      rule<F::merge_color>("merge", 3, kAlways, always),
      rule<F::merge_color>("merge", 1, "rtl.blend = equation", blends_by_equation),
  };
  [&]<int... channel>(std::integer_sequence<int, channel...>) { (add_channel<channel>(rules), ...); }
  (std::make_integer_sequence<int, channel_limit>{});
  return rules;
}

// The reciprocal units that stand in the pipeline, by the stage that has them.
struct Unit {
  std::string stage, name;
  const Reciprocal* r;
};

std::vector<Unit> units(const Config& c) {
  std::vector<Unit> list;
  if (triangle_unit(c)) list.push_back({"setup.edge", "reciprocal.edge", &c.edge_reciprocal});
  if (divided_ends(c)) list.push_back({"edge_walk", "reciprocal.pixel", &c.pixel_reciprocal});
  if (row_unit(c)) list.push_back({"span_setup", "reciprocal.row", &c.row_reciprocal});
  if (pixel_unit(c)) list.push_back({"span", "reciprocal.pixel", &c.pixel_reciprocal});
  // That of the pixel to the right, and that of the pixel below.
  for (int axis = 0; neighbours(c) && axis < 2; ++axis) {
    list.push_back({"lod", "reciprocal.pixel", &c.pixel_reciprocal});
  }
  if (projects(c)) list.push_back({"project", "reciprocal.pixel", &c.pixel_reciprocal});
  return list;
}

constexpr Grid kCode{8, 0, false};  // texels, frame buffer, fog colour

class Products {
 public:
  explicit Products(const Config& config) : c_(config) {}

  std::vector<Multiplier> take() && {
    setup();
    if (plane_rows(c_)) {
      plane_walk();
      plane_span_setup();
    } else {
      setup_edge();
      if (by_plane(c_)) setup_plane();
      edge_walk();
      by_plane(c_) ? triangle_span_setup() : span_setup();
    }
    if (row_gradients(c_)) {
      add("setup.gradient", "u (h + B)", at(F::setup_uv), depth_sum(c_, F::setup_h), 2);
      add("setup.gradient", "nx(h), ny(h)", at(F::setup_h) - at(F::setup_h), between_coordinates(), 4);
      add("setup.gradient", "nx(gu), ny(gu)", at(F::plane_g) - at(F::plane_g), between_coordinates(), 8);
    }
    for (const int channel : ChannelList(c_)) add_channel(line_of(channel_line(channel), c_.perspective));
    pixel();
    return std::move(list_);
  }

 private:
  Grid at(F id) const { return grid_of(c_.format(id)); }
  Grid coordinate() const { return grid_of(c_.coordinate_format()); }
  Grid between_coordinates() const { return coordinate() - coordinate(); }
  // Returns the grid of y + 1/2 - y1, from an edge's start to a row's centre. It is not negative.
  Grid rows_down() const { return {c_.coordinate_bits, std::max(c_.subpixel_bits, 1), false}; }
  // Returns the grid of a pixel's centre minus a vertex.
  Grid from_vertex() const { return {c_.coordinate_bits, std::max(c_.subpixel_bits, 1), true}; }

  void add(std::string stage, std::string product, Grid a, Grid b, int times) {
    list_.push_back({std::move(stage), std::move(product), a.bits(), b.bits(), times});
  }

  void inside(const Unit& unit) {
    for (const auto& [text, a, b] : parts_of(*unit.r).products) {
      list_.push_back({unit.stage, unit.name + ": " + std::string(text), a, b, 1});
    }
  }

  void setup() {
    add("setup", "area", between_coordinates(), between_coordinates(), 2);
    add("setup", "B (s_max' - s')", at(F::setup_b), at(F::setup_s), 1);
  }

  void setup_edge() {
    const Grid h = at(F::setup_h), uv = at(F::setup_uv), shade = at(F::setup_shade);
    if (row_ends(c_) && !affine(c_)) {
      add("setup.edge", "(u2 - u1)(h2 + B)", uv - uv, depth_sum(c_, F::setup_h), 2);
    }
    if (triangle_unit(c_)) inside({"setup.edge", "reciprocal.edge", &c_.edge_reciprocal});
    if (!edge_unit(c_)) return;
    const Grid m = grid_of(c_.edge_reciprocal.output);
    if (dda(c_)) add("setup.edge", "(x2 - x1) m", between_coordinates(), m, 1);
    if (by_plane(c_)) return;
    add("setup.edge", "(h2 - h1) m", h - h, m, 1);
    add("setup.edge", "fu_diff m", at(F::edge_f_diff), m, 2);
    add("setup.edge", "(r2 - r1) m", shade - shade, m, 4);
  }

  void setup_plane() {
    const Grid h = at(F::setup_h), uv = at(F::setup_uv), shade = at(F::setup_shade), g = at(F::plane_g);
    const Grid d = between_coordinates();
    if (delta_f(c_)) add("setup.plane", "(u - u1)(h + B)", uv - at(F::edge_uv), depth_sum(c_, F::setup_h), 2);
    if (hyperbolic(c_)) add("setup.plane", "u (h + B)", uv, depth_sum(c_, F::setup_h), 2);
    // nx has two products, and so has ny.
    add("setup.plane", "nx(h), ny(h)", h - h, d, 4);
    add("setup.plane", "nx(fu), ny(fu)", g - g, d, 8);
    add("setup.plane", "nx(r), ny(r)", shade - shade, d, 16);
    if (!plane_unit(c_)) return;
    const Grid m = grid_of(c_.edge_reciprocal.output);
    const auto rise = [&](Grid w) { return (w - w) * d - (w - w) * d; };
    add("setup.plane", "nx(h) m, ny(h) m", rise(h), m, 2);
    add("setup.plane", "nx(fu) m, ny(fu) m", rise(g), m, 4);
    add("setup.plane", "nx(r) m, ny(r) m", rise(shade), m, 8);
  }

  void edge_walk() {
    if (dda(c_)) {
      add("edge_walk", "x_step t", at(F::edge_x_step), rows_down(), 1);
    } else {
      add("edge_walk", "(x2 - x1) t", between_coordinates(), rows_down(), 1);
    }
    if (by_plane(c_)) return;
    add("edge_walk", "h_step t0", at(F::edge_h_step), rows_down(), 1);
    add("edge_walk", "fu_step t0", at(F::edge_f_step), rows_down(), 2);
    add("edge_walk", "r_step t0", at(F::edge_shade_step), rows_down(), 4);
    if (!perspective_ends(c_)) return;
    inside({"edge_walk", "reciprocal.pixel", &c_.pixel_reciprocal});
    add("edge_walk", "fu m", at(F::edge_f), grid_of(c_.pixel_reciprocal.output), 2);
  }

  void span_setup() {
    const Grid h = at(F::edge_h), uv = at(F::edge_uv), shade = at(F::edge_shade), f = at(F::span_f_diff);
    const Grid x = at(F::edge_x);
    if (delta_f(c_)) add("span_setup", "(u_r - u_l)(h_r + B)", uv - uv, depth_sum(c_, F::edge_h), 2);
    if (hyperbolic(c_)) add("span_setup", "u (h + B)", uv, depth_sum(c_, F::edge_h), 4);
    if (row_unit(c_)) {
      inside({"span_setup", "reciprocal.row", &c_.row_reciprocal});
      const Grid m = grid_of(c_.row_reciprocal.output);
      add("span_setup", "(h_r - h_l) m", h - h, m, 1);
      if (delta_f(c_)) add("span_setup", "fu_diff m", f, m, 2);
      if (hyperbolic(c_)) add("span_setup", "(gr - gl) m", f - f, m, 2);
      if (affine(c_)) add("span_setup", "(u_r - u_l) m", uv - uv, m, 2);
      add("span_setup", "(r_r - r_l) m", shade - shade, m, 4);
    }
    // p = x_first + 1/2 - x_l
    const Grid p = Grid{pixel_index_bits(c_) - 1, 1, false} - x;
    add("span_setup", "h_step p", at(F::span_h_step), p, 1);
    add("span_setup", "fu_step p", at(affine(c_) ? F::span_uv_step : F::span_f_step), p, 2);
    add("span_setup", "r_step p", at(F::span_shade_step), p, 4);
  }

  void triangle_span_setup() {
    add("span_setup", "h_x X, h_y Y", at(F::plane_h_grad), from_vertex(), 2);
    add("span_setup", "fu_x X, fu_y Y", at(F::plane_g_grad), from_vertex(), 4);
    add("span_setup", "r_x X, r_y Y", at(F::plane_shade_grad), from_vertex(), 8);
  }

  void add_channel(const bitspan::Line& line) {
    const Grid w = at(line.walked()), end = at(line.edge.kept);
    if (line.is_homogeneous()) {
      add("setup.channel", "w (h + B)", at(line.vertex), depth_sum(c_, F::setup_h), 1);
    }
    if (!row_ends(c_)) {
      const Grid d = between_coordinates();
      add("setup.channel", "nx(w), ny(w)", w - w, d, 4);
      if (plane_unit(c_)) {
        add("setup.channel", "nx(w) m, ny(w) m", (w - w) * d - (w - w) * d,
            grid_of(c_.edge_reciprocal.output), 2);
      }
      add("span_setup.channel", "w_x X, w_y Y", at(line.gradient), from_vertex(), 2);
      return;
    }
    if (edge_unit(c_)) {
      add("setup.channel", "(w2 - w1) m", w - w, grid_of(c_.edge_reciprocal.output), 1);
    }
    add("edge_walk.channel", "w_step t0", at(line.edge.step), rows_down(), 1);
    if (row_unit(c_)) {
      add("span_setup.channel", "(w_r - w_l) m", end - end, grid_of(c_.row_reciprocal.output), 1);
    }
    add("span_setup.channel", "w_step p", at(line.row.step),
        Grid{pixel_index_bits(c_) - 1, 1, false} - at(F::edge_x), 1);
  }

  void plane_walk() {
    const Grid h = at(F::setup_h), shade = at(F::setup_shade), g = at(F::plane_g);
    const Grid k = at(F::plane_k), pixel = {c_.coordinate_bits, 0, false};
    const Grid d = between_coordinates();
    add("plane_walk", "u (h + B)", at(F::setup_uv), depth_sum(c_, F::setup_h), 2);
    // nx has two products, and so has ny.
    add("plane_walk", "nx(h), ny(h)", h - h, d, 4);
    add("plane_walk", "nx(gu), ny(gu)", g - g, d, 8);
    add("plane_walk", "nx(r), ny(r)", shade - shade, d, 16);
    // The row's ideal line has the fraction of k.
    add("plane_walk", "k (m_first - m0)", k, pixel, 1);
    const Grid line{c_.coordinate_bits + 1, std::max(from_vertex().fraction, k.fraction), true};
    const bool ideal = is_on_ideal_line(c_.numerator);
    add("plane_walk", "h_M (Mc - M0)", at(F::plane_h_grad), from_vertex(), 1);
    add("plane_walk", "h_N (Nl - N0)", at(F::plane_h_grad), line, 1);
    add("plane_walk", "gu_M (Mc - M0)", at(F::plane_g_grad), from_vertex(), 2);
    if (ideal) {
      add("plane_walk", "gu_N (Nl - N0)", at(F::plane_g_grad), line, 2);
      add("plane_walk", "k gu_N", k, at(F::plane_g_grad), 2);
    } else {
      add("plane_walk", "gu_N (Np - N0)", at(F::plane_g_grad), from_vertex(), 2);
    }
    add("plane_walk", "r_M (Mc - M0), r_N (Np - N0)", at(F::plane_shade_grad), from_vertex(), 8);
  }

  void plane_span_setup() {
    inside({"span_setup", "reciprocal.row", &c_.row_reciprocal});
    const Grid m = grid_of(c_.row_reciprocal.output);
    add("span_setup", "gu m", at(F::span_f), m, 2);
    add("span_setup", "gu_step0 m, gu_step1 m", at(F::span_f_step), m, 4);
  }

  void pixel() {
    const Grid m = grid_of(c_.pixel_reciprocal.output);
    const Grid mix = at(F::texture_mix), alpha = at(F::texture_alpha), frac = at(F::texture_frac);
    const Grid shade = at(shade_factor(c_)), color = at(F::texture_color);
    if (pixel_unit(c_)) inside({"span", "reciprocal.pixel", &c_.pixel_reciprocal});
    if (delta_f(c_)) add("span", "fu m", at(F::span_f), m, 2);
    for (const int channel : ChannelList(c_)) {
      const bitspan::Line line = line_of(channel_line(channel), c_.perspective);
      if (line.span_divides && delta_f(c_)) add("span.channel", "w m", at(line.row.acc), m, 1);
    }
    if (has_subspans(c_)) {
      const Grid uv = at(F::span_uv);
      add("span", "(u_b - u_a) j", uv - uv, Grid{c_.subspan_bits, 0, false}, 2);
    }
    if (linear_depth(c_)) add("depth", "c1 m", at(F::depth_c1), m, 1);
    if (any_distance(c_)) add("distance", "A' m", at(F::distance_a), m, 1);
    if (true_distance(c_)) add("distance", "s G", at(F::distance_s), at(F::distance_g), 1);
    if (own_s(c_)) add("lod", "A' m", at(F::distance_a), m, 1);
    if (zones(c_)) {
      const F by = own_s(c_) ? F::distance_s : F::distance_d;
      add("lod", own_s(c_) ? "(s - S_z) k_z" : "(d - S_z) k_z", as_signed(at(by)), at(F::lod_k), 1);
    }
    for (int axis = 0; neighbours(c_) && axis < 2; ++axis) {
      inside({"lod", "reciprocal.pixel", &c_.pixel_reciprocal});
    }
    if (gradients(c_)) {
      const Grid product = at(F::span_uv) * at(F::plane_h_grad);
      add("lod", "u h_x, u h_y", at(F::span_uv), at(F::plane_h_grad), 4);
      add("lod", "(gu_x - u h_x) m", at(F::plane_g_grad) - product, m, 4);
    }
    if (bilinear(c_)) {
      // a (1 - E) + b E = a + (b - a) E, so V5, V6 and V have one product each.
      add("texture", "(V4 - V1) Ex, (V3 - V2) Ex", kCode - kCode, frac, 6);
      add("texture", "(V6 - V5) Ey", mix - mix, frac, 3);
      add("texture", "the same for alpha", alpha - alpha, frac, 3);
    }
    if (two_levels(c_)) {
      if (bilinear(c_)) {
        add("texture", "(V4 - V1) Ex, (V3 - V2) Ex of the second level", kCode - kCode, frac, 6);
        add("texture", "(V6 - V5) Ey of the second level", mix - mix, frac, 3);
        add("texture", "the same for its alpha", alpha - alpha, frac, 3);
      }
      add("texture", "(V_l+1 - V_l) f", mix - mix, at(F::lod_frac), 3);
      add("texture", "the same for alpha of both", alpha - alpha, at(F::lod_frac), 1);
    }
    add("texture", "V shade", mix, shade, 3);
    add("texture", "V_a shade a", alpha, shade, 1);
    if (projects(c_)) {
      inside({"project", "reciprocal.pixel", &c_.pixel_reciprocal});
      add("project", "X m, Y m", at(F::project_value), m, 2);
      add("project", "(h + B) m", depth_sum(c_, F::span_h), m, 1);
      add("project", "A_p ratio", at(F::distance_a), at(F::project_ratio), 1);
    }
    if (lights(c_)) light();
    if (linear_fog(c_)) add("fog", "fog_scale m", at(F::fog_scale), m, 1);
    if (fog_by_log(c_)) {
      const Grid place{1, c_.format(F::distance_s).word - 1, false};
      add("fog", "(f_i+1 - f_i) t", at(F::fog_factor) - at(F::fog_factor), place, 1);
    }
    if (any_fog(c_)) add("fog", "(r - VT_r) factor", color - kCode, at(F::fog_factor), 3);
    if (blends_by_equation(c_)) {
      // 1 minus a code's share, or minus alpha.
      const Grid factor = Grid{1, 8, true} - aligned(alpha, 0);
      add("merge", "src Fs", at(F::fog_color), factor, 3);
      add("merge", "AS Fs, dst Fd, DA Fd", kCode, factor, 5);
    } else {
      add("merge", "(r - dst_r) a", at(F::fog_color) - kCode, alpha, 3);
    }
  }

  // The reciprocal square root of a length.
  void root_of(const std::string& of) {
    const RootUnit& root = c_.light_root;
    const Grid n{2, root.operand_bits, false}, inside{2, root.internal_bits, false};
    Grid y{1, root.table_bits, false};
    for (int step = 0; step < root.steps; ++step) {
      const std::string name = "root of " + of + ": ";
      add("light", name + "n y", n, y, 1);
      add("light", name + "n y y", inside, y, 1);
      add("light", name + "y (3 - n y y)", y, inside, 1);
      y = {1, root.internal_bits, false};
    }
  }
  // X / |X|; of: X.
  void unit_vector(const std::string& of, Grid x) {
    add("light", of + "." + of, x, x, 3);
    root_of(of);
    add("light", of + " m", x, at(F::light_root), 3);
  }
  // 1 / T
  void divided(const std::string& of) {
    root_of(of);
    add("light", of + ": m m", at(F::light_root), at(F::light_root), 1);
  }
  void light() {
    unit_vector("N", at(F::normal_value));
    if (lights_points(c_)) {
      const Grid s = at(lights_pixels(c_.light) ? F::distance_s : F::setup_s);
      add("light", "s k", s, at(F::light_scale), 1);
      add("light", "x s k, y s k", from_vertex(), s * at(F::light_scale), 2);
      unit_vector("L", at(F::light_position) - at(F::light_position));
    }
    // In a map's field both vectors go through the same units, unless brightness falls along the one in the
    // view.
    const bool to_viewer = falls_to_viewer(c_.light_fall_to);
    if (has_relief(c_) && (!lights_points(c_) || (lights_fall(c_) && !to_viewer))) {
      unit_vector("L - (u, v)", at(F::relief_value) - at(F::span_uv));
    }
    add("light", "N.L", at(F::light_normal), at(F::light_direction), 3);
    add("light", "c Nz", at(F::light_cosine), at(F::light_normal), 1);
    if (lights_lunar(c_)) {
      add("light", "k Nz", at(F::light_lunar), at(F::light_normal), 1);
      divided("1 + k Nz");
      add("light", "c Inv", at(F::light_cosine), at(F::light_inverse), 1);
    }
    if (lights_fall(c_)) {
      const Grid place = at(F::light_position);
      if (to_viewer) unit_vector("P", place);
      add("light", "D.Unit(D)", to_viewer ? place : place - place, at(F::light_direction), 3);
      add("light", "d w", place, at(F::light_scale), 1);
      if (falls_by_square(c_.light_fall))
        add("light", "d d", at(F::light_distance), at(F::light_distance), 1);
      divided("d + K");
      add("light", "f U", at(F::light_fall), at(F::light_value), 1);
    }
    if (lights_shadow(c_)) add("light", "U share", at(F::light_value), at(F::texture_alpha), 1);
    const int places = std::max(c_.format(F::light_cosine).fraction() - c_.light_index_bits, 1);
    add("light", "(t_j+1 - t_j) x", at(F::light_specular) - at(F::light_specular), Grid{0, places, false}, 1);
    add("light", "kd c", at(F::light_value), at(F::light_cosine), 1);
    add("light", "ks spec", at(F::light_value), at(F::light_specular), 1);
    add("light", "r V", at(F::texture_color), at(F::light_value), 3);
  }

  const Config& c_;
  std::vector<Multiplier> list_;
};

// Returns the draw states that triangles of the scene are drawn with, or the last state where there is none.
std::vector<DrawState> states_drawn_with(const Config& config, const Scene& scene) {
  std::vector<DrawState> out;
  DrawState state = first_state(config);
  std::size_t since = 0;  // the first triangle of the state
  for (const DrawCommand& command : scene.commands) {
    const auto* change = std::get_if<StateChange>(&command.what);
    if (change == nullptr) continue;
    if (command.before > since) out.push_back(state);
    since = command.before;
    state = changed_state(state, *change, config);
  }
  if (scene.triangles.size() > since || out.empty()) out.push_back(state);
  return out;
}

constexpr int kByte = 8;

std::int64_t data_bits(int line_bytes, int sets, int ways) {
  return std::int64_t{kByte} * line_bytes * sets * ways;
}
std::int64_t data_bits(const BufferCache& cache) {
  return has_cache(cache.mode) ? data_bits(cache.line_bytes, cache.sets, cache.ways) : 0;
}

}  // namespace

const std::vector<RegisterRule>& register_rules() {
  static const std::vector<RegisterRule> rules = make_rules();
  return rules;
}

std::vector<RegisterPlace> register_places(const Config& config) {
  std::vector<RegisterPlace> places;
  for (const RegisterRule& r : register_rules()) {
    if (r.used(config))
      places.push_back({std::string(r.stage), std::string(r.name), r.word(config), r.times});
  }
  for (const auto& u : units(config)) {
    for (const auto& [name, bits, times] : parts_of(*u.r).registers) {
      places.push_back({u.stage, u.name + "." + std::string(name), bits, times});
    }
  }
  return places;
}

std::vector<Multiplier> multipliers(const Config& config) { return Products(config).take(); }

double register_bits(const Config& config) {
  std::int64_t bits = 0;
  for (const RegisterPlace& p : register_places(config)) bits += std::int64_t{p.word} * p.times;
  return static_cast<double>(bits);
}

double product_bits(const Config& config) {
  std::int64_t bits = 0;
  for (const Multiplier& m : multipliers(config)) bits += std::int64_t{m.a} * m.b * m.times;
  return static_cast<double>(bits);
}

double table_bits(const Config& config) {
  std::int64_t bits = 0;
  for (const auto& u : units(config)) bits += parts_of(*u.r).table_bits;
  bits += fog_entries(config) * config.format(F::fog_factor).word;
  if (has_light(config.light)) {
    // A table each of N, L, 1 + k Nz, d + K and what leads away.
    const std::int64_t roots = 1 + (lights_turn(config) ? 1 : 0) + (has_lunar(config) ? 1 : 0) +
                               (has_light_fall(config) ? 1 : 0) + (lights_away(config) ? 1 : 0);
    bits += roots * (std::int64_t{2} << config.light_root.index_bits) * config.light_root.table_bits;
    bits += ((std::int64_t{1} << config.light_index_bits) + 1) * config.format(F::light_specular).word;
  }
  if (true_distance(config)) {
    bits += (std::int64_t{1} << config.fog_zone_bits) * config.format(F::distance_g).word;
  }
  return static_cast<double>(bits);
}

void add_costs(const Config& config, Metrics& metrics) {
  metrics["cost.register_bits"] = register_bits(config);
  metrics["cost.product_bits"] = product_bits(config);
  metrics["cost.table_bits"] = table_bits(config);
}

void add_memory(const Config& config, std::span<const Scene> scenes, Metrics& metrics) {
  std::int64_t depth = 0, stencil = 0, color = 0;
  int units = 1;
  for (const Scene& scene : scenes) {
    int color_word = 0, stencil_word = 0;
    for (const DrawState& state : states_drawn_with(config, scene)) {
      const auto channels = target_bits(state.target_format);
      color_word = std::max(color_word, std::accumulate(channels.begin(), channels.end(), 0));
      if (state.stencil_test) stencil_word = kByte;
      if (has_second_texture(state)) units = 2;
    }
    const std::int64_t pixels = std::int64_t{scene.width} * scene.height;
    depth = std::max(depth, pixels * config.depth_bits);
    stencil = std::max(stencil, pixels * stencil_word);
    color = std::max(color, pixels * color_word);
  }
  const MemoryTiming& m = config.memory;
  const std::int64_t caches = data_bits(m.cache_line_bytes, m.cache_sets, m.cache_ways) +
                              data_bits(m.depth_cache) + data_bits(m.color_cache);
  metrics["memory.depth_bits"] = static_cast<double>(depth);
  metrics["memory.stencil_bits"] = static_cast<double>(stencil);
  metrics["memory.color_bits"] = static_cast<double>(color);
  metrics["memory.cache_bits"] = static_cast<double>(caches);
  metrics["memory.texels_per_pixel"] = (bilinear(config) ? 4 : 1) * (two_levels(config) ? 2 : 1) * units;
}

void add_timing(const Config& config, Metrics& metrics) {
  if (!has_rtl(config)) return;
  const RtlTiming timing = rtl_timing(config);
  metrics["timing.pixel_unit"] = timing.pixel_unit;
  metrics["timing.row_unit"] = timing.row.unit;
  metrics["timing.span"] = timing.span;
}

}  // namespace bitspan
