// SPDX-License-Identifier: Apache-2.0
// light, and the reciprocal square root: values worked by hand, the definition, and golden against the model.
// docs/numeric-spec.md, "light" and "Reciprocal square root".
#include "model/stages/light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "engine/drawn_scene.hpp"
#include "engine/range.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/root.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

using F = FormatId;
using model::Exact;

Config config_of(LightAt at, LightSource source = LightSource::parallel) {
  Config c = shipped_config("depth16");
  c.light = at;
  c.light_source = source;
  return c;
}

// ---------------------------------------------------------------- the reciprocal square root

// 1 / sqrt(d 2^-fraction) by the text of the specification, in integers of its own: y and n in units of
// 2^-32.
struct Defined {
  std::int64_t y = 0;  // in 2^-bits
  int bits = 0, e = 0;
};
Defined defined_root(const RootUnit& u, std::int64_t d, int fraction) {
  using Wide = __int128;
  Defined out;
  // 4^e <= d 2^-fraction
  const auto at_least = [&](int e) {
    const int shift = fraction + 2 * e;
    return shift <= 0 || (shift < 62 && (std::int64_t{1} << shift) <= d);
  };
  out.e = -fraction;
  while (at_least(out.e + 1)) ++out.e;
  // n = floor(d 2^-fraction 4^-e 2^operand_bits)
  const int up = u.operand_bits - fraction - 2 * out.e;
  const std::int64_t n = up >= 0 ? d << up : d >> -up;
  const std::int64_t one = std::int64_t{1} << u.operand_bits;
  const int p = n >= 2 * one ? 1 : 0;
  const std::int64_t j = (n - (one << p)) / (one << p >> u.index_bits);
  // The largest t with (2 t - 1)^2 2^p (1 + (j + 1/2) 2^-q) <= 4 4^T.
  const Wide x = Wide((std::int64_t{2} << u.index_bits) + 2 * j + 1) << p;  // in 2^-(q + 1)
  std::int64_t t = 0;
  for (std::int64_t bit = std::int64_t{1} << u.table_bits; bit > 0; bit /= 2) {
    const Wide odd = 2 * (t + bit) - 1;
    if (odd * odd * x <= Wide(4) << (2 * u.table_bits + u.index_bits + 1)) t += bit;
  }
  out.y = t;
  out.bits = u.table_bits;
  for (int i = 0; i < u.steps; ++i) {
    const Wide a = Wide(n) * out.y * (Wide(1) << u.internal_bits) >> (u.operand_bits + out.bits);
    const Wide c = a * out.y >> out.bits;
    const Wide rest = (Wide(3) << u.internal_bits) - c;
    out.y = static_cast<std::int64_t>(Wide(out.y) * rest >> (out.bits + 1));
    out.bits = u.internal_bits;
  }
  return out;
}

std::vector<RootUnit> root_units() {
  return {{},
          {20, 6, 10, 24, 0},
          {20, 6, 10, 24, 1},
          {12, 3, 5, 12, 1},
          {9, 1, 4, 7, 2},
          {4, 2, 3, 3, 1},
          {2, 1, 1, 1, 0},
          {32, 12, 24, 32, 1},
          {16, 8, 20, 12, 3}};
}

TEST(ReciprocalRoot, IsTheDefinitionForEveryOperandOfTwelveBits) {
  for (const RootUnit& unit : root_units()) {
    Config c = config_of(LightAt::pixel);
    c.light_root = unit;
    for (const Rounding rounding : {Rounding::rnd, Rounding::trn, Rounding::rnd_conv}) {
      c.format(F::light_root).rounding = rounding;
      const model::ReciprocalRoot root(c);
      const golden::InverseRootUnit<golden::Quad> by_golden(c);
      for (const int fraction : {0, 1, 11, 24}) {
        for (std::int64_t d = 1; d < 4096; ++d) {
          const Defined defined = defined_root(unit, d, fraction);
          const model::Register r = model::make_register(c, F::light_root);
          const std::int64_t m = model::quantize(Exact{defined.y, defined.bits}, r, model::NoObserve{});
          const model::Root found = reciprocal_root(root, {d, fraction}, model::NoObserve{});
          ASSERT_EQ(found.m, m) << d << " " << fraction << " " << unit.steps;
          ASSERT_EQ(found.e, defined.e) << d << " " << fraction;
          const auto golden = by_golden(golden::Quad(d) * golden::pow2<golden::Quad>(-fraction));
          ASSERT_EQ(golden.e, defined.e) << d << " " << fraction;
          ASSERT_EQ(golden::Quantizer<golden::Quad>(c.format(F::light_root)).raw(golden.m), m) << d;
        }
      }
    }
  }
}

TEST(ReciprocalRoot, TheDefaultsHaveTwentyBits) {
  const model::ReciprocalRoot root(config_of(LightAt::pixel));
  Random random(5);
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto d = static_cast<std::int64_t>(random.log_uniform(1, 0x1p60));
    const model::Root found = reciprocal_root(root, {d, 36}, model::NoObserve{});
    const double exact = 1 / std::sqrt(std::ldexp(static_cast<double>(d), -36));
    const double value = std::ldexp(static_cast<double>(found.m), -root.output.fraction - found.e);
    worst = std::max(worst, std::abs(value / exact - 1));
  }
  EXPECT_LT(worst, 0x1.8p-20);  // half an ulp of light.root, of at least 1/2, and the operand's last place
  EXPECT_GT(worst, 0x1p-22);
}

// ---------------------------------------------------------------- worked by hand

struct Lit {
  LightRecord record;
  Config config;
  double value(std::int64_t raw, F id) const { return decoded(raw, config.format(id)); }
  double brightness() const { return value(record.value, F::light_value); }
  double cosine() const { return value(record.cosine, F::light_cosine); }
  double mirrored() const { return value(record.mirrored, F::light_cosine); }
};
// A white pixel of the middle of a picture, with that normal; s: of a light that stands at a point.
Lit lit(const Light& light, const std::array<double, 3>& normal, double s = 1,
        LightFall fall = LightFall::second, LightFallTo to = LightFallTo::light) {
  Lit out;
  out.config = config_of(LightAt::pixel, LightSource::point);
  out.config.light_law = LightLaw::lunar;
  out.config.light_fall = fall;
  out.config.light_fall_to = to;
  Scene scene = worked_scene();
  scene.width = 65;
  scene.height = 49;
  scene.light = light;
  const model::Constants constants = model::make_constants(out.config, scene);
  const model::LightStage stage = model::prepare_light(out.config, constants, scene);
  EXPECT_TRUE(stage.is_on);
  model::LightChannels channels;
  for (std::size_t i = 0; i < 3; ++i) {
    channels.normal[i] =
        static_cast<std::int64_t>(std::ldexp(normal[i], out.config.format(F::normal_value).fraction()));
  }
  const FragmentRecord fragment{.triangle = 3, .x = 32, .y = 24};
  const DistanceRecord distance{
      .s = static_cast<std::int64_t>(std::ldexp(s / 2, out.config.format(F::distance_s).fraction()))};
  const std::int64_t white = std::int64_t{255} << out.config.format(F::texture_color).fraction();
  model::light(stage, fragment, distance, channels, {.r = white, .g = white / 2, .b = 0, .a = 7}, out.record);
  return out;
}
Light toward(double x, double y, double z, double ambient = 0, double specular = 0, int exponent = 32) {
  return {.place = {x, y, z}, .ambient = ambient, .specular = specular, .exponent = exponent};
}

TEST(Light, FollowsTheCosine) {
  const Lit straight = lit(toward(0, 0, -1), {0, 0, -1});
  EXPECT_EQ(straight.record.triangle, 3);
  EXPECT_EQ(straight.record.x, 32);
  EXPECT_EQ(straight.record.y, 24);
  EXPECT_EQ(straight.cosine(), 1);
  EXPECT_EQ(straight.mirrored(), 1);
  EXPECT_EQ(straight.brightness(), 1);
  EXPECT_EQ(straight.value(straight.record.r, F::texture_color), 255);
  EXPECT_EQ(straight.value(straight.record.g, F::texture_color), 127.5);
  EXPECT_EQ(straight.record.b, 0);
  // 60 degrees, and the lengths do not count.
  const Lit aslant = lit(toward(std::sqrt(3.0) * 100, 0, -100), {0, 0, -0.25});
  EXPECT_NEAR(aslant.cosine(), 0.5, 1e-5);
  EXPECT_NEAR(aslant.brightness(), 0.5, 1e-4);
  EXPECT_NEAR(aslant.mirrored(), 0.5, 1e-5);  // mirrored at the normal, as far on the other side
  // 3 : 4 : 12, of length 13.
  const Lit other = lit(toward(3, 4, -12), {0.75, 1, -0});
  EXPECT_NEAR(other.cosine(), (3 * 0.6 + 4 * 0.8) / 13, 1e-5);
}

TEST(Light, EndsAtTheTerminator) {
  EXPECT_EQ(lit(toward(0, 0, 1, 0.25, 0.5), {0, 0, -1}).brightness(), 0.25);
  EXPECT_EQ(lit(toward(1, 0, 0, 0.25, 0.5), {0, 0, -1}).brightness(), 0.25);
  EXPECT_GT(lit(toward(1, 0, -0.01, 0.25, 0.5), {0, 0, -1}).brightness(), 0.25);
  // Without a normal there is ambient light alone, with a brightness that the register holds.
  EXPECT_EQ(lit(toward(0, 0, -1, 0.25), {0, 0, 0}).brightness(), 0.25);
}

TEST(Light, TheHighlightIsAPowerOfACosine) {
  // g = cos of 36.87 degrees is 0.8; mirrored by a normal toward the viewer.
  const auto specular = [](int exponent) {
    const Lit l = lit(toward(0.6, 0, -0.8, 0, 1, exponent), {0, 0, -1});
    EXPECT_NEAR(l.mirrored(), 0.8, 1e-5);
    return l.brightness();
  };
  EXPECT_NEAR(specular(1), 0.8, 1e-4);
  EXPECT_NEAR(specular(8), std::pow(0.8, 8), 1e-4);
  EXPECT_NEAR(specular(200), std::pow(0.8, 200), 1e-4);
  // Ambient, cosine and highlight share 1: 0.25 + 0.25 * 0.8 + 0.5 * 0.8^2.
  const Lit all = lit(toward(0.6, 0, -0.8, 0.25, 0.5, 2), {0, 0, -1});
  EXPECT_NEAR(all.brightness(), 0.25 + 0.2 + 0.32, 2e-4);
  // Mirrored away from the viewer: none.
  const Lit away = lit(toward(0.8, 0, 0.6, 0, 1, 1), {1, 0, 0});
  EXPECT_NEAR(away.cosine(), 0.8, 1e-5);
  EXPECT_NEAR(away.mirrored(), 0.6, 1e-5);
  const Lit gone = lit(toward(0.8, 0, -0.6, 0, 1, 1), {1, 0, 0});
  EXPECT_NEAR(gone.mirrored(), -0.6, 1e-5);
  EXPECT_EQ(gone.brightness(), 0);
}

TEST(Light, StandsAtAPoint) {
  // In the middle of the picture at s = 1; the light beside the viewer, 45 degrees from there.
  Light light = toward(1, 0, 0);
  light.is_point = true;
  const Lit beside = lit(light, {0, 0, -1}, 1);
  EXPECT_NEAR(beside.cosine(), std::sqrt(0.5), 1e-5);
  EXPECT_NEAR(beside.value(beside.record.lx, F::light_direction), std::sqrt(0.5), 1e-5);
  EXPECT_NEAR(beside.value(beside.record.lz, F::light_direction), -std::sqrt(0.5), 1e-5);
  // Twice as far the angle is smaller.
  EXPECT_NEAR(lit(light, {0, 0, -1}, 2).cosine(), 2 / std::sqrt(5.0), 1e-5);
  // Where it stands there is no direction.
  light.place = {0, 0, 2};
  EXPECT_EQ(lit(light, {0, 0, -1}, 2).brightness(), 0);
}

TEST(Light, TheLunarLawDividesByTheViewersCosine) {
  const auto brightness = [](double k, const std::array<double, 3>& normal) {
    Light light = toward(0.6, 0, -0.8, 0.25);
    light.lunar = k;
    return lit(light, normal).brightness();
  };
  // What faces the viewer is darker, and what is seen at a grazing angle is as by Lambert.
  EXPECT_EQ(brightness(0, {0, 0, -1}), lit(toward(0.6, 0, -0.8, 0.25), {0, 0, -1}).brightness());
  EXPECT_NEAR(brightness(1, {0, 0, -1}), 0.25 + 0.75 * 0.8 / 2, 2e-5);
  EXPECT_NEAR(brightness(3, {0, 0, -1}), 0.25 + 0.75 * 0.8 / 4, 2e-5);
  EXPECT_NEAR(brightness(3, {0.6, 0, -0.8}), 0.25 + 0.75 / (1 + 3 * 0.8), 2e-5);
  EXPECT_NEAR(brightness(3, {1, 0, 0}), 0.25 + 0.75 * 0.6, 2e-5);
  EXPECT_NEAR(brightness(16, {1, 0, 0.25}), 0.25 + 0.75 * (0.6 - 0.2) / std::sqrt(1.0625), 2e-5);
  EXPECT_EQ(brightness(3, {0, 0, 1}), 0.25);
}

TEST(Light, FallsWithTheDistance) {
  // At the viewer, and what it lights is twice the reach away.
  Light light = toward(0, 0, 0, 0.125);
  light.is_point = true;
  light.reach = 1;
  const auto near = [](const Lit& l, double fall) {
    EXPECT_NEAR(l.brightness(), 0.125 + 0.875 * fall, 2e-5);
  };
  near(lit(light, {0, 0, -1}, 2), 0.25);
  near(lit(light, {0, 0, -1}, 2, LightFall::first), 0.5);
  near(lit(light, {0, 0, -1}, 1), 1);
  light.offset = 1;
  near(lit(light, {0, 0, -1}, 2), 0.2);
  near(lit(light, {0, 0, -1}, 2, LightFall::first), 1 / 3.0);
  // Beside the viewer: the distances to both differ, by a factor of the square root of 2.
  light = toward(2, 0, 0, 0.125);
  light.is_point = true;
  light.reach = 1;
  const double cosine = std::sqrt(0.5);
  near(lit(light, {0, 0, -1}, 2), cosine / 8);
  near(lit(light, {0, 0, -1}, 2, LightFall::second, LightFallTo::viewer), cosine / 4);
  near(lit(light, {0, 0, -1}, 2, LightFall::first), cosine / std::sqrt(8.0));
  // Far lights have no distance; the viewer has.
  light = toward(0, 0, -1, 0.125);
  light.reach = 1;
  near(lit(light, {0, 0, -1}, 2), 1);
  near(lit(light, {0, 0, -1}, 2, LightFall::second, LightFallTo::viewer), 0.25);
  // Nearer than the reach it is as bright as the registers hold.
  light.reach = 1.9;
  near(lit(light, {0, 0, -1}, 1.9, LightFall::second, LightFallTo::viewer), 1);
  light.reach = 2;
  const Lit bright = lit(light, {0, 0, -1}, 0.25, LightFall::second, LightFallTo::viewer);
  EXPECT_EQ(bright.brightness(), 2 - 0x1p-15);
}

// The stage in a draw state in which it takes the second unit's texels.
model::LightStage stage_with(TextureOp op, const Config& c, const Scene& scene) {
  model::LightStage stage = model::prepare_light(c, model::make_constants(c, scene), scene);
  DrawState state = first_state(c);
  state.texture1 = 0;
  state.texture1_op = op;
  model::set_light(stage, state);
  EXPECT_TRUE(model::takes_texel(stage));
  return stage;
}

// A texel of a map, and where the light stands in its field; the fragment is at 5, 7.
LightRecord over_map(const std::array<int, 3>& texel, const std::array<double, 3>& place,
                     const Light& light) {
  Config c = config_of(LightAt::pixel, LightSource::point);
  c.light_normal = LightNormal::map;
  c.light_law = LightLaw::lunar;
  Scene scene = worked_scene();
  scene.light = light;
  const model::LightStage stage = stage_with(TextureOp::relief, c, scene);
  EXPECT_TRUE(stage.has_map);
  const auto raw = [&](double x, F id) {
    return static_cast<std::int64_t>(std::ldexp(x, c.format(id).fraction()));
  };
  model::LightChannels channels;
  channels.normal = {raw(0, F::normal_value), 0, raw(1, F::normal_value)};  // away from the viewer: not read
  for (std::size_t i = 0; i < 3; ++i) channels.place[i] = raw(place[i], F::relief_value);
  channels.at = {raw(5, F::span_uv), raw(7, F::span_uv)};
  TextureRecord texture;
  texture.texel_r = raw(texel[0], F::texture_mix);
  texture.texel_g = raw(texel[1], F::texture_mix);
  texture.texel_b = raw(texel[2], F::texture_mix);
  LightRecord out;
  model::light(stage, {}, {}, channels, texture, out);
  return out;
}

TEST(Light, ReliefIsLitInTheMapsField) {
  const Config c = config_of(LightAt::pixel);
  const auto cosine = [&](const std::array<int, 3>& texel, const std::array<double, 3>& place) {
    Light light = toward(0, 0, -1, 0.125, 0.5);
    light.lunar = 3;
    const LightRecord r = over_map(texel, place, light);
    EXPECT_EQ(r.mirrored, 0);
    EXPECT_EQ(r.specular, 0);
    const double found = decoded(r.cosine, c.format(F::light_cosine));
    EXPECT_NEAR(decoded(r.value, c.format(F::light_value)), 0.125 + 0.375 * std::max(found, 0.0), 1e-4);
    return found;
  };
  // Flat, with the light straight above, at 45 degrees along u, and below.
  const double flat = 127.5 / std::hypot(127.5, 0.5, 0.5);
  EXPECT_NEAR(cosine({128, 128, 255}, {5, 7, 40}), flat, 1e-5);
  EXPECT_NEAR(cosine({128, 128, 255}, {45, 7, 40}), std::sqrt(0.5), 0.004);
  EXPECT_LT(cosine({128, 128, 255}, {5, 7, -40}), -0.99);
  // A slope that faces along u, and one along v.
  EXPECT_NEAR(cosine({255, 128, 128}, {1005, 7, 0}), 1, 1e-4);
  EXPECT_NEAR(cosine({0, 128, 128}, {1005, 7, 0}), -1, 1e-4);
  EXPECT_NEAR(cosine({128, 255, 128}, {5, 1007, 0}), 1, 1e-4);
  EXPECT_NEAR(cosine({128, 0, 128}, {5, -993, 0}), 1, 1e-4);
  // 3 : 4 : 12 of both.
  EXPECT_NEAR(cosine({157, 166, 244}, {5 + 30, 7 + 40, 120}),
              (3 * 59 + 4 * 77 + 12 * 233) / (13 * std::hypot(59, 77, 233)), 1e-5);
}

// The brightness of a pixel whose normal is toward the viewer, where the shadow map's texel has that red.
double in_shadow(double red, const Light& light, LightFall fall = LightFall::none) {
  Config c = config_of(LightAt::pixel, LightSource::point);
  c.light_shadow = LightShadow::map;
  c.light_fall = fall;
  Scene scene = worked_scene();
  scene.light = light;
  const model::LightStage stage = stage_with(TextureOp::shadow, c, scene);
  EXPECT_TRUE(stage.has_shadow);
  const auto raw = [&](double x, F id) {
    return static_cast<std::int64_t>(std::ldexp(x, c.format(id).fraction()));
  };
  model::LightChannels channels;
  channels.normal = {0, 0, raw(-1, F::normal_value)};
  TextureRecord texture;
  texture.texel_r = raw(red, F::texture_mix);
  texture.texel_g = texture.texel_b = raw(255, F::texture_mix);
  LightRecord out;
  model::light(stage, {.x = scene.width / 2, .y = scene.height / 2}, {.s = raw(1, F::distance_s)}, channels,
               texture, out);
  return decoded(out.value, c.format(F::light_value));
}

TEST(Light, AShadowLeavesTheAmbientLight) {
  const Light light = toward(0, 0, -1, 0.125, 0.25);
  EXPECT_EQ(in_shadow(0, light), 0.125);
  EXPECT_NEAR(in_shadow(255, light), 1, 1e-4);
  // A filter's share of a map's texels: the light's two terms, 7/8 of the brightness, by it.
  EXPECT_NEAR(in_shadow(51, light), 0.125 + 0.875 / 5, 1e-3);
  EXPECT_NEAR(in_shadow(127.5, light), 0.125 + 0.875 / 2, 1e-3);
  // Where the distance takes a half, the shadow takes of what is left.
  Light lamp{.is_point = true, .place = {0, 0, -1}, .ambient = 0.125, .specular = 0.25};
  lamp.reach = worked_scene().s_max;
  const double near = in_shadow(255, lamp, LightFall::first);
  EXPECT_GT(near, 0.2);
  EXPECT_NEAR(in_shadow(51, lamp, LightFall::first), 0.125 + (near - 0.125) / 5, 1e-3);
}

TEST(Light, NeedsTheConfigurationsLeave) {
  Scene scene = random_scene(3, {});
  const Light lights[] = {{.is_point = true, .place = {0, 0, 1}}, {.lunar = 1}, {.reach = scene.s_max}};
  for (const Light& light : lights) {
    scene.light = light;
    for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
      const Config c = config_of(at);
      EXPECT_THROW(make_model(c)->begin(scene), InputError);
      EXPECT_THROW(make_golden(c)->begin(scene), InputError);
    }
    EXPECT_NO_THROW(make_model(config_of(LightAt::none))->begin(scene));
  }
}

// ---------------------------------------------------------------- golden, model and ideal

Scene random_lit(std::uint64_t seed, const LightTaken& takes) {
  RandomOptions options;
  options.width = 64;
  options.height = 48;
  options.triangles = 24;
  options.size_max = 60;
  options.depth_ratio_max = 8;
  options.texture_size_max = 16;
  options.fog_probability = 0;
  Scene scene = random_scene(seed, options);
  Random random(seed + 1000);
  draw_light(random, scene, takes);
  return scene;
}

struct Drawn {
  Trace trace;
  Frame frame;
};
Drawn drawn(Engine& engine, const Scene& scene) {
  Drawn out;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &out.trace);
  out.frame = engine.frame();
  return out;
}

TEST(Light, GoldenIsTheModel) {
  int records = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
      for (const LightSource source : {LightSource::parallel, LightSource::point}) {
        Config c = config_of(at, source);
        c.perspective = all_perspectives[seed % std::size(all_perspectives)];
        if (seed % 2 == 0) c.light_law = LightLaw::lunar;
        if (at == LightAt::pixel && seed % 3 != 0) c.light_normal = LightNormal::map;
        if (at == LightAt::pixel && seed % 3 != 1) c.light_shadow = LightShadow::map;
        if (has_points(source)) {
          c.light_fall = std::array{LightFall::none, LightFall::first, LightFall::second}[seed % 3];
          c.light_fall_to = seed % 4 < 2 ? LightFallTo::light : LightFallTo::viewer;
        }
        const Scene scene = random_lit(seed, light_taken(c));
        const Drawn by_model = drawn(*make_model(c), scene), by_golden = drawn(*make_golden(c, true), scene);
        ASSERT_TRUE(std::ranges::equal(by_model.trace.setup_channel, by_golden.trace.setup_channel))
            << seed << " " << to_string(at) << " " << to_string(source);
        ASSERT_TRUE(std::ranges::equal(by_model.trace.light, by_golden.trace.light))
            << seed << " " << to_string(at) << " " << to_string(source);
        ASSERT_TRUE(std::ranges::equal(by_model.trace.fog, by_golden.trace.fog)) << seed;
        ASSERT_EQ(by_model.frame.color, by_golden.frame.color) << seed;
        ASSERT_EQ(by_model.trace.light.size(), by_model.trace.fog.size());
        records += static_cast<int>(by_model.trace.light.size());
      }
    }
  }
  EXPECT_GT(records, 50'000);
}

// The brightness of a pixel, and its neighbours of other triangles left out.
TEST(Light, TheDefaultsAreWithinACodeOfTheTruth) {
  std::int64_t all = 0, far = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
      for (const LightSource source : {LightSource::parallel, LightSource::point}) {
        const Config c = config_of(at, source);
        const Scene scene = random_lit(seed, light_taken(c));
        const Drawn by_model = drawn(*make_model(c), scene);
        for (const LightRecord& r : by_model.trace.light) {
          const Triangle& t = scene.triangles[static_cast<std::size_t>(r.triangle)];
          // Interpolation of a small triangle's far ends is what the bounds tell of.
          const auto shape = ideal_triangle(c, t);
          if (golden::magnitude(static_cast<double>(golden::areas_at(*shape, {}).whole)) < 2 * 32 * 32 * 64)
            continue;
          const double ideal = ideal_at(c, scene, *shape, r.x, r.y).light.value;
          const double error = 255 * (decoded(r.value, c.format(F::light_value)) - ideal);
          ++all;
          if (std::abs(error) > 1) ++far;
        }
      }
    }
  }
  EXPECT_GT(all, 20'000);
  EXPECT_LE(1000 * far, all) << far << " of " << all;
}

TEST(Light, IsOffInAViewWithoutOne) {
  Scene scene = random_lit(4, {});
  const Drawn off = drawn(*make_model(config_of(LightAt::none)), scene);
  scene.light.reset();
  for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
    const Drawn without = drawn(*make_model(config_of(at)), scene);
    EXPECT_TRUE(without.trace.light.empty());
    EXPECT_TRUE(without.trace.fragment_channel.empty());
    EXPECT_EQ(without.frame.color, off.frame.color);
    EXPECT_TRUE(std::ranges::equal(without.trace.fog, off.trace.fog));
  }
}

TEST(Light, AFaceHasItsFirstVertex) {
  Scene scene = worked_scene();
  scene.light = toward(0, 0, -1, 0);
  Triangle t = triangle(vertex(60, 40, 1.5), vertex(4, 4, 1.25), vertex(60, 4, 2));
  t.v[0].nz = -1;  // lit; the others have no normal
  scene.triangles = {t};
  const auto values = [&](LightAt at) {
    std::vector<std::int64_t> out;
    for (const LightRecord& r : drawn(*make_model(config_of(at)), scene).trace.light) out.push_back(r.value);
    EXPECT_GT(out.size(), 500U);
    return out;
  };
  const Config c = config_of(LightAt::face);
  for (const std::int64_t value : values(LightAt::face)) {
    ASSERT_EQ(decoded(value, c.format(F::light_value)), 1);
  }
  const auto [low, high] = std::ranges::minmax(values(LightAt::vertex));
  EXPECT_LT(decoded(low, c.format(F::light_value)), 0.1);
  EXPECT_GT(decoded(high, c.format(F::light_value)), 0.9);
  // A turn of the triangle is another first vertex.
  std::ranges::rotate(scene.triangles[0].v, scene.triangles[0].v.begin() + 1);
  for (const std::int64_t value : values(LightAt::face)) ASSERT_EQ(value, 0);
}

// Each key, and each register, has a say in the records of some mode, and golden follows.
TEST(Light, EveryKeyMovesSomething) {
  Scene with_all = random_lit(8, {.point = true, .map = true, .shadow = true});
  with_all.light->lunar = 1.75;
  with_all.light->reach = with_all.s_max;
  with_all.light->offset = 0.25;
  const std::array scenes{random_lit(7, {}), with_all};
  std::vector<std::string> still;
  std::size_t tried = 0;
  const auto try_key = [&](const std::string& name, auto change, RowSlope rows = RowSlope::reciprocal) {
    ++tried;
    for (const LightAt at : {LightAt::pixel, LightAt::vertex}) {
      for (const bool points : {true, false}) {
        Config c = config_of(at, points ? LightSource::point : LightSource::parallel);
        c.row_slope = rows;
        if (points && at == LightAt::pixel) {
          c.light_normal = LightNormal::map;
          c.light_shadow = LightShadow::map;
        }
        if (points) {
          c.light_law = LightLaw::lunar;
          c.light_fall = LightFall::second;
        }
        const Scene& scene = scenes[points ? 1 : 0];
        const Drawn before = drawn(*make_model(c), scene);
        change(c);
        const Drawn after = drawn(*make_model(c), scene);
        const bool same = std::ranges::equal(before.trace.light, after.trace.light) &&
                          std::ranges::equal(before.trace.setup_channel, after.trace.setup_channel);
        if (same) continue;
        const Drawn by_golden = drawn(*make_golden(c, true), scene);
        EXPECT_TRUE(std::ranges::equal(by_golden.trace.light, after.trace.light)) << name;
        return;
      }
    }
    still.push_back(name);
  };
  const auto coarser = [](F id) { return [id](Config& c) { c.format(id).word -= 7; }; };
  for (const F id :
       {F::normal_vertex,   F::normal_step,  F::normal_acc,     F::normal_value,  F::relief_vertex,
        F::relief_step,     F::relief_acc,   F::relief_value,   F::light_vertex,  F::light_step,
        F::light_acc,       F::light_scale,  F::light_position, F::light_root,    F::light_normal,
        F::light_direction, F::light_cosine, F::light_specular, F::light_inverse, F::light_lunar,
        F::light_distance,  F::light_fall,   F::light_value}) {
    try_key(std::string(key_of(id)), coarser(id));
  }
  for (const F id : {F::normal_grad, F::relief_grad, F::light_grad}) {
    try_key(std::string(key_of(id)), coarser(id), RowSlope::plane);
  }
  try_key("light.index_bits", [](Config& c) { c.light_index_bits = 3; });
  try_key("light.root.operand_bits", [](Config& c) { c.light_root.operand_bits = 8; });
  try_key("light.root.index_bits", [](Config& c) { c.light_root.index_bits = 2; });
  try_key("light.root.table_bits", [](Config& c) { c.light_root.table_bits = 3; });
  try_key("light.root.internal_bits", [](Config& c) { c.light_root.internal_bits = 8; });
  try_key("light.root.steps", [](Config& c) { c.light_root.steps = 0; });
  EXPECT_TRUE(still.empty()) << still.front();
  try_key("light.fall", [](Config& c) {
    if (falls(c.light_fall)) c.light_fall = LightFall::first;
  });
  try_key("light.fall_to", [](Config& c) { c.light_fall_to = LightFallTo::viewer; });
  try_key("light.normal", [](Config& c) { c.light_normal = LightNormal::channel; });
  try_key("light.shadow", [](Config& c) { c.light_shadow = LightShadow::none; });
  EXPECT_EQ(tried, 36U);
}

TEST(Light, KeysMustFit) {
  Config c = config_of(LightAt::pixel);
  EXPECT_FALSE(first_violation(c));
  c.light_root.index_bits = c.light_root.operand_bits = 5;
  ASSERT_TRUE(first_violation(c));
  EXPECT_EQ(first_violation(c)->key, "light.root.index_bits");
  c.light = LightAt::none;
  EXPECT_FALSE(first_violation(c));
  c = config_of(LightAt::vertex);
  c.light_normal = LightNormal::map;
  ASSERT_TRUE(first_violation(c));
  EXPECT_EQ(first_violation(c)->key, "light.normal");
  c = config_of(LightAt::vertex);
  c.light_shadow = LightShadow::map;
  ASSERT_TRUE(first_violation(c));
  EXPECT_EQ(first_violation(c)->key, "light.shadow");
  c = config_of(LightAt::pixel);
  c.light_fall = LightFall::first;
  ASSERT_TRUE(first_violation(c));
  EXPECT_EQ(first_violation(c)->key, "light.fall");
  c = config_of(LightAt::pixel, LightSource::point);
  c.format(F::light_position) = {64, 8, true, Rounding::rnd, Overflow::sat, false};
  ASSERT_TRUE(first_violation(c));
  EXPECT_EQ(first_violation(c)->key, "formats.light.direction");
}

}  // namespace
}  // namespace bitspan
