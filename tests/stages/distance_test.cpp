// SPDX-License-Identifier: Apache-2.0
#include "model/stages/distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "golden/distance.hpp"
#include "golden/engine_golden.hpp"
#include "golden/fog.hpp"
#include "golden/lod.hpp"
#include "model/engine_model.hpp"
#include "model/stages/fog.hpp"
#include "model/stages/lod.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

// W = H = 24, one zone: in its middle r^2 = 144; with F = 16, G = 20/16.
struct Worked {
  explicit Worked(FogMode fog = FogMode::distance) : config(plain_config()), scene(worked_scene()) {
    scene.width = scene.height = 24;
    scene.focal = 16;
    scene.fog = Fog{{200, 100, 0}, 2};
    config.fog = fog;
    config.fog_zone_bits = 0;
  }
  // By the model, and by golden, which must say the same.
  DistanceRecord at(double h, std::int64_t x = 12, std::int64_t y = 12) const {
    const FragmentRecord f = fragment(h, x, y);
    DistanceRecord out;
    model::distance(model::prepare_distance(config, model::make_constants(config, scene), scene), f, out);
    std::vector<DistanceRecord> same;
    const FragmentRecord* one = &f;
    golden::make_distance({golden::Width::quad, true}, config, golden::make_constants(config, scene), scene)(
        {&one, 1}, same);
    EXPECT_EQ(same, std::vector{out});
    EXPECT_EQ(out.x, x);
    EXPECT_EQ(out.y, y);
    EXPECT_EQ(out.triangle, 3);
    return out;
  }
  FogRecord fogged(const DistanceRecord& distance) const {
    const FragmentRecord f = fragment(0, 12, 12);
    const TextureRecord t;
    FogRecord out;
    model::fog(model::prepare_fog(config, model::make_constants(config, scene), scene), f, distance, t, out);
    std::vector<FogRecord> same;
    const FragmentRecord* fragments = &f;
    const TextureRecord* textures = &t;
    const DistanceRecord* distances = &distance;
    golden::make_fog({golden::Width::quad, true}, config, golden::make_constants(config, scene), scene)(
        {&fragments, 1}, {&textures, 1}, {&distances, 1}, {}, same);
    EXPECT_EQ(same, std::vector{out});
    return out;
  }
  FragmentRecord fragment(double h, std::int64_t x, std::int64_t y) const {
    FragmentRecord f;
    f.triangle = 3;
    f.x = x;
    f.y = y;
    f.h = encoded(h, config.format(FormatId::span_h));
    return f;
  }
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  // Of an entry at D.
  double entry(double d) const {
    const double ulp = std::ldexp(1.0, -config.format(FormatId::fog_factor).fraction());
    return std::floor(std::exp(-d / scene.fog->distance) / ulp + 0.5) * ulp;
  }
  double factor(const FogRecord& r) const { return value(r.factor, FormatId::fog_factor); }
  Config config;
  Scene scene;
};

TEST(Distance, IsSTimesTheZonesFactor) {
  const Worked worked;
  const DistanceRecord r = worked.at(21845);
  EXPECT_EQ(worked.value(r.s, FormatId::distance_s), 0.75);
  EXPECT_EQ(worked.value(r.d, FormatId::distance_d), 0.9375);
  EXPECT_EQ(r.zone, 0);
  EXPECT_NE(r.recip_m, 0);
  EXPECT_EQ(worked.value(worked.at(0).d, FormatId::distance_d), 1.25);
  EXPECT_EQ(worked.value(worked.at(65535).d, FormatId::distance_d), 0.625);
  // Zones uniform in r.
  Worked by_r;
  by_r.config.fog_zone = FogZone::r;
  by_r.scene.width = 64;
  by_r.scene.height = 48;
  by_r.scene.focal = 15;  // r = 20: G = 5/3
  const auto nearest = [&](double x, FormatId id) {
    const int fraction = by_r.config.format(id).fraction();
    return std::ldexp(std::floor(std::ldexp(x, fraction) + 0.5), -fraction);
  };
  EXPECT_EQ(by_r.value(by_r.at(0).d, FormatId::distance_d),
            nearest(nearest(5.0 / 3, FormatId::distance_g), FormatId::distance_d));
}

TEST(Distance, WithoutTheTrueOneThereIsSAlone) {
  const Worked worked(FogMode::log);
  const DistanceRecord r = worked.at(21845, 0, 0);
  EXPECT_EQ(worked.value(r.s, FormatId::distance_s), 0.75);
  EXPECT_EQ(r.zone, 0);
  EXPECT_EQ(r.d, 0);
  EXPECT_TRUE(has_distance(worked.config));
  EXPECT_FALSE(has_true_distance(worked.config));
}

// Zone k of r holds the pixels with k <= 2^j r / r_max < k + 1, compared as squares.
TEST(Distance, ZonesHaveEqualWidthsInR2OrInR) {
  for (const auto& [width, height] : {std::pair(64, 48), {1, 1}, {7, 300}, {101, 100}}) {
    for (int bits = 0; bits <= 8; bits += 2) {
      Scene scene = worked_scene();
      scene.width = width;
      scene.height = height;
      for (const FogZone by : {FogZone::r2, FogZone::r}) {
        Config c = plain_config();
        c.fog_zone_bits = bits;
        c.fog_zone = by;
        const model::ScreenZones zones = model::screen_zones(c, scene);
        const golden::Zoning<double> same(c, scene);
        const std::int64_t n = std::int64_t{1} << bits;
        const std::int64_t all = std::int64_t{width} * width + std::int64_t{height} * height;
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            const std::int64_t dx = 2 * x + 1 - width, dy = 2 * y + 1 - height;
            const std::int64_t r2 = dx * dx + dy * dy;
            const std::int64_t k = model::zone_of(zones, x, y);
            ASSERT_EQ(k, same(x, y)) << x << "," << y;
            ASSERT_TRUE(k >= 0 && k < n);
            if (by == FogZone::r) {
              ASSERT_LE(k * k * all, n * n * r2);
              ASSERT_TRUE(k == n - 1 || (k + 1) * (k + 1) * all > n * n * r2);
            } else {
              ASSERT_LE(k * all, n * r2);
              ASSERT_TRUE(k == n - 1 || (k + 1) * all > n * r2);
            }
            // The RTL compares r2 with the start of each zone.
            ASSERT_GE(r2, model::zone_start(zones, k));
            ASSERT_TRUE(k == n - 1 || r2 < model::zone_start(zones, k + 1));
          }
        }
      }
    }
  }
}

// The square of each rounded root is as near as the format allows, in 128 bits; F is an integer here.
TEST(Distance, FactorsAreRoundedExactly) {
  Random random(11);
  std::size_t exact = 0;
  for (int i = 0; i < 2000; ++i) {
    Config c = plain_config();
    c.fog_zone_bits = static_cast<int>(random.integer(0, 3));
    c.fog_zone = random.chance(0.5) ? FogZone::r2 : FogZone::r;
    Format& g = c.format(FormatId::distance_g);
    const int fraction = static_cast<int>(random.integer(0, 16));
    g = {fraction + 8, 8, false, Rounding::trn, Overflow::sat, false};
    Scene scene = worked_scene();
    scene.width = random.chance(0.2) ? 24 : static_cast<int>(random.integer(1, 400));
    scene.height = random.chance(0.2) ? scene.width : static_cast<int>(random.integer(1, 400));
    scene.focal = random.chance(0.2) ? 16 : static_cast<double>(random.integer(10, 900));
    const auto floors = model::zone_factors(c, scene);
    ASSERT_EQ(floors, golden::zone_factors(c, scene)) << i;
    for (int zone = 0; zone < 1 << c.fog_zone_bits; ++zone) {
      // G^2 = (F^2 2^k + m (W^2 + H^2)) / (F^2 2^k), where m 2^-k is the middle's share.
      const model::Exact middle = model::middle_of(model::screen_zones(c, scene), zone);
      const auto f2 = static_cast<__int128>(scene.focal * scene.focal) << middle.fraction;
      const __int128 n = f2 + middle.raw * (std::int64_t{scene.width} * scene.width +
                                            std::int64_t{scene.height} * scene.height);
      const auto root = static_cast<__int128>(floors[static_cast<std::size_t>(zone)]);
      ASSERT_LE(root * root * f2, n << 2 * fraction);
      ASSERT_GT((root + 1) * (root + 1) * f2, n << 2 * fraction);
      exact += root * root * f2 == n << 2 * fraction ? 1 : 0;
    }
    for (int mode = 0; mode < rounding_modes; ++mode) {
      g.rounding = static_cast<Rounding>(mode);
      ASSERT_EQ(model::zone_factors(c, scene), golden::zone_factors(c, scene)) << i << " mode " << mode;
    }
  }
  EXPECT_GT(exact, 0U);
}

TEST(Distance, OddFocalLengthsAreTakenOrRefused) {
  Config c = plain_config();
  Scene scene = worked_scene();
  // The widest formats that are legal.
  for (const int integer : {1, 16, 32}) {
    c.format(FormatId::distance_g) = {32, integer, false, Rounding::rnd, Overflow::sat, false};
    ASSERT_FALSE(first_violation(c).has_value()) << first_violation(c)->text;
    for (const double focal : {1e300, 0x1.123456789abcdp-9, 0x1.fffffffffffffp3}) {
      scene.focal = focal;
      EXPECT_EQ(model::zone_factors(c, scene), golden::zone_factors(c, scene)) << focal;
    }
  }
  for (const double focal : {0.0, -1.0, 1e-5, std::numeric_limits<double>::infinity(), std::nan("")}) {
    scene.focal = focal;
    EXPECT_THROW(model::zone_factors(c, scene), InputError) << focal;
    EXPECT_THROW(golden::zone_factors(c, scene), InputError) << focal;
  }
}

// G = 5/4, so that the table reaches to D = 2 2^E: entry i stands at (i + 1/2) / 32 2^E, and E = 1.
TEST(Distance, FogIsExponentialInD) {
  const Worked worked;
  const FogRecord r = worked.fogged(worked.at(21845));
  EXPECT_EQ(r.index, 30);  // d = 0.9375
  EXPECT_EQ(worked.factor(r), worked.entry(30.5 / 16));
  EXPECT_EQ(r.recip_m, 0);
  DistanceRecord far;
  far.d = encoded(3, worked.config.format(FormatId::distance_d));
  EXPECT_EQ(worked.fogged(far).index, 63);
  EXPECT_EQ(worked.fogged({}).index, 0);
}

// 64 entries over 16 octaves: they stand at 1, 5/4, 3/2, 7/4 times powers of two, and the factor is linear
// between.
TEST(Distance, FogByTheLogarithmIsLinearBetweenEntries) {
  const Worked worked(FogMode::log);
  const auto by_s = [&](double s) {
    DistanceRecord d;
    d.s = encoded(s, worked.config.format(FormatId::distance_s));
    return worked.fogged(d);
  };
  EXPECT_EQ(by_s(0.5).index, 60);
  EXPECT_EQ(worked.factor(by_s(0.5)), worked.entry(1));
  EXPECT_EQ(by_s(0.75).index, 62);
  EXPECT_EQ(worked.factor(by_s(0.75)), worked.entry(1.5));
  // Halfway from 3/4 to 7/8.
  const double middle = (worked.entry(1.5) + worked.entry(1.75)) / 2;
  const double ulp = std::ldexp(1.0, -worked.config.format(FormatId::fog_factor).fraction());
  EXPECT_EQ(worked.factor(by_s(0.8125)), std::floor(middle / ulp + 0.5) * ulp);
  EXPECT_EQ(by_s(1).index, 63);
  EXPECT_EQ(worked.factor(by_s(1)), worked.entry(2));
  EXPECT_EQ(worked.factor(by_s(1.5)), worked.entry(2));
  EXPECT_EQ(by_s(0).index, 0);
  EXPECT_EQ(worked.factor(by_s(0)), worked.entry(0x1p-15));
}

TEST(Distance, LodTakesDByZones) {
  Worked worked(FogMode::none);
  worked.config.mip = MipMode::linear;
  worked.config.lod = LodMode::zone_d;
  worked.config.lod_first = 16384;  // S_i = 1/4, 1/2, 1
  const DistanceRecord distance = worked.at(21845);
  const FragmentRecord f = worked.fragment(21845, 12, 12);
  LodRecord out;
  model::lod(model::prepare_lod(worked.config, model::make_constants(worked.config, worked.scene)), f,
             nullptr, distance, 8, out);
  EXPECT_EQ(worked.value(out.lambda, FormatId::lod_lambda), 1.875);  // 1 + (0.9375 - 0.5) / 0.5
  EXPECT_EQ(out.s, 0);
  EXPECT_EQ(out.recip_m, 0);
  std::vector<LodRecord> same;
  const FragmentRecord* one = &f;
  golden::make_lod({golden::Width::quad, true}, worked.config,
                   golden::make_constants(worked.config, worked.scene))({&one, 1}, {}, {&distance, 1}, 8,
                                                                        first_state(worked.config), same);
  EXPECT_EQ(same, std::vector{out});
}

// The difference to the neighbour, where q falls by h_x: (gu + gu_x) / (q + h_x) - u.
TEST(Distance, FiniteIsTheDifferenceToTheNextPixel) {
  Config c = plain_config();
  c.mip = MipMode::linear;
  c.lod = LodMode::finite;
  const Scene scene = worked_scene();
  GradientRecord g;
  g.h_x = encoded(-65535.0 / 2, c.format(FormatId::plane_h_grad));
  g.gu_x = encoded(65535, c.format(FormatId::plane_g_grad));
  g.h_y = encoded(-70000, c.format(FormatId::plane_h_grad));  // beyond the horizon
  FragmentRecord f;                                           // h = 0: q = 65535
  f.u = encoded(6, c.format(FormatId::span_uv));
  const auto leveled = [&](const FragmentRecord& fragment) {
    LodRecord out;
    model::lod(model::prepare_lod(c, model::make_constants(c, scene)), fragment, &g, {}, 8, out);
    std::vector<LodRecord> same;
    const FragmentRecord* one = &fragment;
    golden::make_lod({golden::Width::quad, true}, c, golden::make_constants(c, scene))({&one, 1}, g, {}, 8,
                                                                                       first_state(c), same);
    EXPECT_EQ(same, std::vector{out});
    return out;
  };
  const LodRecord r = leveled(f);
  // gu = 6 q: (6 q + q) / (q / 2) - 6 = 8.
  EXPECT_NEAR(decoded(r.u_x, c.format(FormatId::lod_slope)), 8, 1e-3);
  EXPECT_NE(r.recip_m, 0);
  // A reciprocal of one ulp of the sum's grid: the register saturates.
  EXPECT_EQ(r.u_y, (std::int64_t{1} << (c.format(FormatId::lod_slope).word - 1)) - 1);
  // Without perspective it is the gradient.
  g.h_x = g.h_y = 0;
  EXPECT_NEAR(decoded(leveled(f).u_x, c.format(FormatId::lod_slope)), 1, 1e-6);
}

// F2's zones: how far a factor in a zone is from that in its middle, over the pixels of 640 x 480 at F = 500
// and S/DT up to 3.2.
TEST(Distance, ZonesInRHaveTheLargerWorstError) {
  Config c = plain_config();
  Scene scene = worked_scene();
  scene.width = 640;
  scene.height = 480;
  scene.focal = 500;
  std::array<double, 2> worst{}, mean{};
  for (const FogZone by : {FogZone::r2, FogZone::r}) {
    c.fog_zone = by;
    const model::ScreenZones zones = model::screen_zones(c, scene);
    double sum = 0, most = 0;
    std::size_t count = 0;
    for (int y = 0; y < 240; y += 2) {
      for (int x = 0; x < 320; x += 2) {
        const double dx = x + 0.5 - 320, dy = y + 0.5 - 240;
        const model::Exact middle = model::middle_of(zones, model::zone_of(zones, x, y));
        const double share = std::ldexp(static_cast<double>(middle.raw), -middle.fraction);
        const double own = std::sqrt(1 + (dx * dx + dy * dy) / 250000);
        const double zone = std::sqrt(1 + share * (640.0 * 640 + 480.0 * 480) / 250000);
        for (int t = 1; t <= 16; ++t, ++count) {
          const double error = std::abs(std::exp(-0.2 * t * own) - std::exp(-0.2 * t * zone));
          sum += error;
          most = std::max(most, error);
        }
      }
    }
    worst[static_cast<std::size_t>(by)] = most;
    mean[static_cast<std::size_t>(by)] = sum / static_cast<double>(count);
  }
  EXPECT_NEAR(worst[0], 0.0036, 0.00005);
  EXPECT_NEAR(worst[1], 0.0044, 0.00005);
  EXPECT_NEAR(mean[0], mean[1], 0.02 * mean[0]);
}

// d lies between s times G at both ends of the pixel's zone, and so does the true distance: docs/bounds.md.
TEST(Distance, IsWithinItsBoundOfTheTrueDistance) {
  std::size_t checked = 0;
  for (Config c : shipped_configs()) {
    c.fog = FogMode::distance;
    c.fog_depth_bits = 6;
    for (const FogZone by : {FogZone::r2, FogZone::r}) {
      c.fog_zone = by;
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Scene scene = random_scene(seed, {.width = 96, .height = 64, .triangles = 10, .size_max = 90});
        const auto engine = make_model(c, {.form = ModelForm::scalar});
        Trace trace;
        engine->begin(scene);
        engine->draw(scene.triangles, 0, &trace);
        const model::Constants constants = model::make_constants(c, scene);
        const auto value = [&c](std::int64_t raw, FormatId id) {
          return std::ldexp(static_cast<long double>(raw), -c.format(id).fraction());
        };
        const long double b = value(constants.record.b, FormatId::setup_b);
        const long double a = b * value(constants.record.s_max, FormatId::setup_s);
        const model::ScreenZones zones = model::screen_zones(c, scene);
        const long double diagonal = zones.width * zones.width + zones.height * zones.height;
        const auto factor = [&](long double r2) {
          return std::sqrt(1 + r2 / (4 * static_cast<long double>(scene.focal) * scene.focal));
        };
        std::size_t at = 0;
        for (const DistanceRecord& r : trace.distance) {
          while (trace.fragment[at].triangle != r.triangle || trace.fragment[at].x != r.x ||
                 trace.fragment[at].y != r.y)
            ++at;
          const long double q = value(trace.fragment[at].h, FormatId::span_h) + b;
          if (q <= 0 || a / q > 2) continue;  // beyond the register
          const long double dx = 2 * r.x + 1 - zones.width, dy = 2 * r.y + 1 - zones.height;
          const long double truth = a / q * factor(dx * dx + dy * dy);
          const long double near = factor(static_cast<long double>(model::zone_start(zones, r.zone)) - 1);
          const long double next = r.zone + 1 == 1 << zones.bits
                                       ? diagonal
                                       : static_cast<long double>(model::zone_start(zones, r.zone + 1));
          const long double m =
              std::ldexp(static_cast<long double>(r.recip_m),
                         -c.pixel_reciprocal.output.fraction() - static_cast<int>(r.recip_e));
          const long double unit = std::abs(m * q - 1);
          const long double half_s = value(1, FormatId::distance_s) / 2,
                            half_g = value(1, FormatId::distance_g) / 2,
                            half_d = value(1, FormatId::distance_d) / 2,
                            half_a = value(1, FormatId::distance_a) / 2;
          const long double along = a / q * (unit + half_a / a * (1 + unit)) + half_s;  // error of s
          const long double zone = factor(next) - near + half_g;
          const long double bound = a / q * zone + along * (factor(next) + half_g) + half_d;
          ASSERT_LE(std::abs(value(r.d, FormatId::distance_d) - truth), bound)
              << c.name << " seed " << seed << " at " << r.x << "," << r.y;
          ++checked;
        }
      }
    }
  }
  EXPECT_GT(checked, 20000U);
}

TEST(Distance, GoldenAndModelAreEqual) {
  std::size_t records = 0, indices = 0;
  std::uint64_t seed = 0;
  for (const Config& base : shipped_configs()) {
    for (int i = 0; i < 40; ++i) {
      Random random(++seed);
      Config c = base;
      c.perspective = static_cast<Perspective>(random.integer(0, 3));
      c.fog = static_cast<FogMode>(random.integer(0, 4));
      c.fog_zone = random.chance(0.5) ? FogZone::r2 : FogZone::r;
      c.fog_depth_bits = static_cast<int>(random.integer(1, 8));
      c.fog_zone_bits = static_cast<int>(random.integer(0, 4));
      if (random.chance(0.5)) {
        c.mip = MipMode::linear;
        c.lod = random.chance(0.5) ? LodMode::zone_d : LodMode::finite;
        c.lod_first = static_cast<int>(random.log_uniform(20, 40000));
      }
      if (fog_entries(c) == 0) c.fog_depth_bits = 6;
      if (!has_pixel_zones(c)) {
        c.fog_zone_bits = 4;
        c.fog_zone = FogZone::r2;
      }
      if (first_violation(c)) continue;
      Scene scene = random_scene(
          seed,
          {.width = 64, .height = 48, .triangles = 24, .size_max = 60, .uv_limit = 400, .mip_chains = true});
      if (!scene.fog) scene.fog = Fog{{1, 2, 3}, scene.s_max / 3};
      Trace want, got;
      const auto golden = make_golden(c, true);
      const auto model = make_model(c, {.form = ModelForm::scalar});
      for (const auto& [engine, trace] : {std::pair(golden.get(), &want), {model.get(), &got}}) {
        engine->begin(scene);
        engine->draw(scene.triangles, 0, trace);
      }
      ASSERT_EQ(want.distance, got.distance) << base.name << " seed " << seed;
      ASSERT_EQ(want.lod, got.lod) << base.name << " seed " << seed;
      ASSERT_EQ(want.fog, got.fog) << base.name << " seed " << seed;
      ASSERT_EQ(want.merge, got.merge) << base.name << " seed " << seed;
      ASSERT_EQ(golden->counters(), model->counters()) << base.name << " seed " << seed;
      ASSERT_EQ(got.distance.size(), has_distance(c) ? got.texture.size() : 0);
      records += got.distance.size();
      for (const FogRecord& r : got.fog) indices += r.index > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(records, 20000U);
  EXPECT_GT(indices, 10000U);
}

TEST(Distance, WhatIsNotThereIsRefusedByName) {
  Config c = shipped_config("depth16");
  c.fog = FogMode::distance;
  EXPECT_FALSE(first_violation(c).has_value());
  EXPECT_FALSE(pixel_stages_are_in_rtl(c));
  c.format(FormatId::distance_g).word = 33;
  ASSERT_TRUE(first_violation(c).has_value());
  EXPECT_EQ(first_violation(c)->key, "formats.distance.g");
  c = shipped_config("depth16");
  c.fog_zone = FogZone::r;
  EXPECT_FALSE(first_violation(c).has_value());
  EXPECT_TRUE(pixel_stages_are_in_rtl(c));
  c.mip = MipMode::linear;
  c.lod = LodMode::finite;
  c.perspective = Perspective::affine;
  ASSERT_TRUE(first_violation(c).has_value());
  EXPECT_EQ(first_violation(c)->key, "lod.mode");
  EXPECT_NE(first_violation(c)->text.find("is finite"), std::string::npos);
}

}  // namespace
}  // namespace bitspan
