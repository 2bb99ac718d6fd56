#include "tests/config/support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "config/names.hpp"

namespace bitspan {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string text_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text.append(line).append("\n");
  return text;
}

std::string parse_error_of(const std::string& text) {
  return error_of([&text] { (void)parse_config(text, "file.toml"); });
}

namespace {

class Pick {
 public:
  explicit Pick(std::mt19937_64& random) : random_(random) {}
  int integer(int lowest, int highest) {
    return std::uniform_int_distribution<int>(lowest, highest)(random_);
  }
  bool coin() { return integer(0, 1) == 1; }
  template <class E>
  E name() {
    return static_cast<E>(integer(0, static_cast<int>(enum_names<E>.size()) - 1));
  }
  Format format() {
    Format f;
    f.is_signed = coin();
    f.word = integer(2, 30);
    f.integer = integer(1, f.word);
    f.rounding = name<Rounding>();
    f.overflow = name<Overflow>();
    if (!f.is_signed && f.overflow == Overflow::wrap_sm) f.overflow = Overflow::wrap;
    f.overflow_expected = coin();
    return f;
  }
  Reciprocal reciprocal() {
    Reciprocal r;
    r.kind = name<ReciprocalKind>();
    r.normalize = coin();
    r.operand_bits = integer(13, 20);
    r.index_bits = integer(1, 12);
    r.table_bits = integer(2, 40);
    r.internal_bits = integer(2, 40);
    r.steps = integer(0, 4);
    r.bits_per_cycle = integer(1, 8);
    r.pipelined = coin();
    r.output = format();
    r.output.is_signed = false;
    r.output.integer = 1;
    r.output.word = integer(2, 25);
    if (r.output.overflow == Overflow::wrap_sm) r.output.overflow = Overflow::sat;
    return r;
  }
  StartOffset offset(const Format& accumulator) {
    StartOffset o;
    o.half_ulp = integer(0, 3) == 0;
    if (!o.half_ulp && coin()) o.value = std::ldexp(integer(-3, 3), -accumulator.fraction() - 1);
    return o;
  }

 private:
  std::mt19937_64& random_;
};

}  // namespace

Config random_config(std::mt19937_64& random) {
  using F = FormatId;
  Pick pick(random);
  Config c;
  c.name = "random";
  c.subpixel_bits = pick.integer(0, 12);
  c.coordinate_bits = pick.integer(2, 24);
  c.fill_rule = pick.name<FillRule>();
  c.edge_walk = pick.name<EdgeWalk>();
  c.dda_update = pick.name<DdaUpdate>();
  c.perspective = pick.name<Perspective>();
  c.numerator = pick.name<Numerator>();
  c.edge_slope = pick.name<SlopeForm>();
  c.row_slope = pick.name<SlopeForm>();
  c.edge_reciprocal = pick.reciprocal();
  c.row_reciprocal = pick.reciprocal();
  c.pixel_reciprocal = pick.reciprocal();
  c.pixel_reciprocal.pipelined = true;
  c.depth_bits = pick.integer(8, 32);
  c.depth_code = pick.name<DepthCode>();
  c.depth_rounding = pick.name<Rounding>();
  c.depth_overflow = static_cast<Overflow>(pick.integer(0, 3));
  c.filter = pick.name<TextureFilter>();
  c.wrap = pick.name<TextureWrap>();
  if (pick.coin()) {
    c.transparent.emplace();
    for (std::uint8_t& code : *c.transparent) code = static_cast<std::uint8_t>(pick.integer(0, 255));
  }
  c.fog = pick.name<FogMode>();
  c.fog_depth_bits = pick.integer(1, 8);
  c.fog_zone_bits = pick.integer(0, 4);
  for (Format& f : c.formats) f = pick.format();
  c.format(F::merge_color) = {8, 8, false, pick.name<Rounding>(), Overflow::sat, false};
  c.format(F::texture_frac) = {pick.integer(1, 20), 0, false, Rounding::trn, Overflow::sat, false};
  c.format(F::texture_alpha) = {10, 2, pick.coin(), Rounding::rnd, Overflow::sat, pick.coin()};
  c.format(F::fog_factor) = {10, 2, pick.coin(), Rounding::rnd, Overflow::sat, pick.coin()};
  c.format(F::plane_k) = {pick.integer(3, 22), 2, true, Rounding::rnd, Overflow::sat, false};
  c.format(F::edge_x).integer = c.format(F::edge_x).word - 1;
  c.start_offset.edge_x = pick.offset(c.format(F::edge_x_acc));
  c.start_offset.edge_h = pick.offset(c.format(F::edge_h_acc));
  c.start_offset.edge_f = pick.offset(c.format(F::edge_f));
  c.start_offset.edge_shade = pick.offset(c.format(F::edge_shade_acc));
  c.start_offset.span_h = pick.offset(c.format(F::span_h));
  const bool linear_uv =
      c.perspective == Perspective::affine || c.perspective == Perspective::const_depth_rows;
  c.start_offset.span_f = pick.offset(c.format(linear_uv ? F::span_uv_acc : F::span_f));
  c.start_offset.span_shade = pick.offset(c.format(F::span_shade_acc));
  for (StageTiming& t : c.timing) t = {pick.integer(1, 1000), pick.integer(1, 1000), pick.integer(1, 65536)};
  c.memory = {pick.integer(1, 10000), 1 << pick.integer(0, 5), 1 << pick.integer(5, 12),
              1 << pick.integer(0, 16), pick.integer(1, 64)};
  return c;
}

Scene random_scene(std::mt19937_64& random, const SceneLimits& limits) {
  const auto real = [&random](double lowest, double highest) {
    return std::uniform_real_distribution<double>(lowest, highest)(random);
  };
  Scene scene;
  scene.name = "random";
  scene.s_min = real(0.5, 2);
  scene.s_max = scene.s_min * limits.s_ratio;
  scene.fog = Fog{{200, 210, 220}, scene.s_max / 3};
  for (int i = 0; i < limits.triangles; ++i) {
    Triangle t;
    for (Vertex& v : t.v) {
      v.x = real(-limits.xy, limits.xy);
      v.y = real(-limits.xy, limits.xy);
      v.s = std::clamp(scene.s_min * std::pow(limits.s_ratio, real(0, 1)), scene.s_min, scene.s_max);
      v.u = real(-limits.uv, limits.uv);
      v.v = real(-limits.uv, limits.uv);
      for (double& c : v.c) c = real(0, 1);
    }
    scene.triangles.push_back(t);
  }
  return scene;
}

}  // namespace bitspan
