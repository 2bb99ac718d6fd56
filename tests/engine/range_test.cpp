// SPDX-License-Identifier: Apache-2.0
// The range check: sharp (the bits named are the fewest that pass), sound (what sampled points of the ideal
// surface need, it asks for), and silent on usual scenes with the shipped configurations.
#include "engine/range.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "tests/config/support.hpp"

namespace bitspan {
namespace {

using F = FormatId;

std::string refusal(const Config& c, const Scene& scene) {
  return error_of([&] { check_scene_range(c, scene); });
}

bool names(const std::string& error, F id) {
  return error.find(": formats." + std::string(key_of(id)) + ": ") != std::string::npos;
}

// The number after `word` in a message.
int number_after(const std::string& text, const std::string& word) {
  const auto at = text.rfind(word);
  return at == std::string::npos ? -1000 : std::stoi(text.substr(at + word.size()));
}

// As a configuration whose formats all hold anything.
Config roomy(Perspective mode) {
  Config c = shipped_config("depth20");
  c.perspective = mode;
  c.depth_code = DepthCode::linear;
  c.fog = FogMode::linear;
  for (Format& f : c.formats) f.overflow_expected = true;
  return c;
}

// The fields of a mode that the triangles and the depth range decide about.
std::set<F> fields_of(Perspective mode, EdgeWalk walk) {
  std::set<F> ids{F::setup_s,       F::setup_b,   F::setup_h,        F::setup_uv,    F::setup_shade,
                  F::span_h,        F::span_uv,   F::span_shade_acc, F::span_shade,  F::depth_c1,
                  F::depth_c0,      F::fog_scale, F::fog_factor,     F::texture_mix, F::texture_color,
                  F::texture_alpha, F::fog_color};
  if (mode == Perspective::const_depth_rows) {
    ids.insert({F::plane_g, F::span_f, F::span_uv_acc});
    return ids;
  }
  ids.insert({F::edge_x, F::edge_h_acc, F::edge_h, F::edge_f_diff, F::edge_f, F::edge_uv, F::edge_shade_acc,
              F::edge_shade});
  if (walk == EdgeWalk::dda) ids.insert(F::edge_x_acc);
  if (mode == Perspective::affine) {
    ids.insert(F::span_uv_acc);
  } else {
    ids.insert({F::span_f_diff, F::span_f});
  }
  return ids;
}

TEST(Range, TheBitsNamedAreTheFewestThatPass) {
  std::mt19937_64 random(3);
  int narrowed = 0;
  for (const Perspective mode : all_perspectives) {
    for (const EdgeWalk walk : {EdgeWalk::exact, EdgeWalk::dda}) {
      const std::set<F> used = fields_of(mode, walk);
      for (int i = 0; i < format_count; ++i) {
        const auto id = static_cast<F>(i);
        Config c = roomy(mode);
        c.edge_walk = walk;
        const Scene scene =
            random_scene(random, {20, std::pow(10.0, 1 + static_cast<double>(i % 4)), 2000, 5000});
        ASSERT_EQ(refusal(c, scene), "");
        Format& f = c.format(id);
        f.overflow_expected = false;
        const int fraction = f.fraction();
        f.integer = (f.is_signed ? 2 : 1) - std::min(fraction, 5);  // far too narrow for every field
        f.word = f.integer + fraction;
        const std::string error = refusal(c, scene);
        if (!used.contains(id)) {
          EXPECT_EQ(error, "") << "slopes and the fields of other modes are not checked: " << key_of(id);
          continue;
        }
        ASSERT_TRUE(names(error, id)) << key_of(id) << ": " << error;
        EXPECT_NE(error.find("overflow_expected = true"), std::string::npos) << error;
        const int needed = number_after(error, "needs int = ");
        const int own_fraction = f.fraction();
        ASSERT_GT(needed, f.integer) << error;
        f.integer = needed;
        f.word = needed + own_fraction;
        EXPECT_EQ(refusal(c, scene), "") << "the bits named pass";
        --f.integer;
        --f.word;
        EXPECT_TRUE(names(refusal(c, scene), id)) << "one fewer does not: " << key_of(id);
        f.overflow_expected = true;
        EXPECT_EQ(refusal(c, scene), "") << "and passes where it is meant";
        ++narrowed;
      }
    }
  }
  EXPECT_GT(narrowed, 150);
}

TEST(Range, AnUnsignedFormatUnderANegativeRangeIsToldToBeSigned) {
  Config c = shipped_config("depth16");
  Scene scene;
  scene.triangles.resize(1);
  scene.triangles[0].v = {Vertex{1, 1, 2, -5, 0}, Vertex{90, 5, 2, 3, 0}, Vertex{5, 80, 2, 0, 3}};
  c.format(F::setup_uv).is_signed = false;
  const std::string error = refusal(c, scene);
  EXPECT_TRUE(names(error, F::setup_uv)) << error;
  EXPECT_NE(error.find("needs signed = true, int = 4 (word = 12 with the same fraction)"), std::string::npos)
      << error;
  EXPECT_NE(error.find("the scene needs -5 (triangle 0) to 3 (triangle 0) texel"), std::string::npos)
      << error;
  c.format(F::setup_uv) = {12, 4, true, Rounding::rnd, Overflow::sat, false};
  EXPECT_EQ(refusal(c, scene), "");
}

TEST(Range, LimitsAreThoseOfTheFormatToTheLastPlace) {
  Config c = shipped_config("depth16");
  Scene scene;
  scene.triangles.resize(1);
  const auto with_u = [&](double u) {
    scene.triangles[0].v = {Vertex{1, 1, 2, u, 0}, Vertex{90, 5, 2, u, 0}, Vertex{5, 80, 2, u, 3}};
    return refusal(c, scene);
  };
  c.format(F::setup_uv) = {16, 8, true, Rounding::rnd, Overflow::sat, false};  // -128 .. 127.99609375
  EXPECT_EQ(with_u(127.99609375), "");
  EXPECT_EQ(with_u(127.998), "") << "rounds down";
  EXPECT_TRUE(names(with_u(127.9981), F::setup_uv)) << "rounds up to 128";
  EXPECT_EQ(with_u(-128), "");
  EXPECT_EQ(with_u(-128.001), "");
  EXPECT_TRUE(names(with_u(-128.01), F::setup_uv));
  c.format(F::setup_uv).overflow = Overflow::sat_sym;
  EXPECT_TRUE(names(with_u(-128), F::setup_uv)) << "a symmetric format ends at -127.996";
  c.format(F::setup_uv).overflow = Overflow::sat;
  c.format(F::setup_uv).rounding = Rounding::trn;
  EXPECT_EQ(with_u(127.9999), "") << "truncates";
  EXPECT_TRUE(names(with_u(-128.0001), F::setup_uv));
  c.format(F::setup_uv).rounding = Rounding::trn_zero;
  EXPECT_EQ(with_u(-128.0001), "");
}

TEST(Range, CoordinatesNameTheBitsTheyNeed) {
  Config c = shipped_config("depth16");
  for (const int bits : {10, 12, 16, 20}) {
    c.coordinate_bits = bits;
    const double most = std::ldexp(1.0, bits - 1);
    for (const bool vertical : {false, true}) {
      const auto with = [&](double value) {
        Scene scene;
        scene.triangles.resize(1);
        scene.triangles[0].v = {Vertex{{1, 1, 2}, {}}, Vertex{{90, 5, 2}, {}}, Vertex{{5, 80, 2}, {}}};
        (vertical ? scene.triangles[0].v[1].y : scene.triangles[0].v[1].x) = value;
        Config wide = c;
        for (Format& f : wide.formats) f.overflow_expected = true;
        return refusal(wide, scene);
      };
      EXPECT_EQ(with(-most), "");
      EXPECT_EQ(with(most - 1.0 / 16), "");
      const std::string error = with(most);
      EXPECT_NE(error.find("raster.coordinate_bits: is " + std::to_string(bits) + ", too narrow for "),
                std::string::npos)
          << error;
      EXPECT_EQ(number_after(error, "needs "), bits + 1) << error;
      EXPECT_EQ(number_after(with(-most - 1), "needs "), bits + 1);
      EXPECT_EQ(number_after(with(most * 4), "needs "), bits + 3);
      EXPECT_NE(with(1e300).find("clip the triangle"), std::string::npos);
      EXPECT_NE(with(std::numeric_limits<double>::quiet_NaN()).find("is not finite"), std::string::npos);
    }
  }
}

TEST(Range, DepthRangesThatRoundTogetherNameTheFractionTheyNeed) {
  Config c = shipped_config("depth16");
  Scene scene;
  scene.s_min = 1;
  scene.s_max = 100000;
  c.format(F::setup_s) = {12, 1, false, Rounding::rnd, Overflow::sat, true};
  std::string error = refusal(c, scene);
  ASSERT_NE(error.find("formats.setup.s: too coarse: "), std::string::npos) << error;
  const int needed = number_after(error, "needs a fraction of ");
  c.format(F::setup_s).word = needed + 1;
  EXPECT_EQ(refusal(c, scene), "");
  c.format(F::setup_s).word = needed;
  EXPECT_NE(refusal(c, scene), "");

  c = shipped_config("depth16");
  scene.s_max = 1.0000001;  // s_min' and s_max' become one
  c.format(F::setup_s) = {12, 1, false, Rounding::rnd, Overflow::sat, false};
  EXPECT_NE(refusal(c, scene).find("formats.setup.s: too coarse: "), std::string::npos);

  c = shipped_config("depth16");
  scene.s_max = 1e9;
  c.format(F::setup_s) = {60, 1, false, Rounding::rnd, Overflow::sat, false};
  c.format(F::setup_b) = {20, 18, false, Rounding::rnd, Overflow::sat, false};
  error = refusal(c, scene);
  ASSERT_NE(error.find("formats.setup.b: too coarse: "), std::string::npos) << error;
  c.format(F::setup_b).word = 18 + number_after(error, "needs a fraction of ");
  EXPECT_EQ(refusal(c, scene).find("formats.setup.b"), std::string::npos);
  --c.format(F::setup_b).word;
  EXPECT_NE(refusal(c, scene).find("formats.setup.b: too coarse: "), std::string::npos);

  for (const auto& [least, most] : {std::pair{1.0, 1.0},
                                    {2.0, 1.0},
                                    {0.0, 1.0},
                                    {-1.0, 1.0},
                                    {1.0, std::numeric_limits<double>::infinity()}}) {
    scene.s_min = least;
    scene.s_max = most;
    EXPECT_NE(refusal(shipped_config("depth16"), scene).find("legal: finite, 0 < s_min < s_max"),
              std::string::npos);
  }
}

// What points inside the triangles need, by formulas of their own: the bits named are never fewer.
TEST(Range, AsksForWhatSampledPointsNeed) {
  std::mt19937_64 random(5);
  const auto real = [&random] { return std::uniform_real_distribution<double>(0, 1)(random); };
  for (const Perspective mode :
       {Perspective::delta_f, Perspective::hyperbolic, Perspective::const_depth_rows}) {
    for (int round = 0; round < 20; ++round) {
      const Scene scene = random_scene(random, {3, 300, 900, 3000});
      const double hmax = 1048575;
      const double b = hmax * scene.s_min / (scene.s_max - scene.s_min);
      std::map<F, std::pair<double, double>> need;
      const auto add = [&need](F id, double x) {
        auto& [lo, hi] = need.try_emplace(id, x, x).first->second;
        lo = std::min(lo, x);
        hi = std::max(hi, x);
      };
      for (const Triangle& t : scene.triangles) {
        const auto point = [&](double& u, double& q) {  // by 1/s, linear on the screen
          double w[3] = {real(), real(), real()};
          const double sum = w[0] + w[1] + w[2];
          double inverse = 0;
          u = 0;
          for (int i = 0; i < 3; ++i) {
            inverse += w[i] / sum / t.v[static_cast<std::size_t>(i)].s;
            u += w[i] / sum / t.v[static_cast<std::size_t>(i)].s * t.v[static_cast<std::size_t>(i)].u;
          }
          u /= inverse;
          q = b * scene.s_max * inverse;
        };
        // A triangle beside the picture draws nothing.
        double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
        for (const Vertex& v : t.v) {
          left = std::min(left, v.x);
          right = std::max(right, v.x);
          top = std::min(top, v.y);
          bottom = std::max(bottom, v.y);
        }
        if (left >= scene.width - 1 || right <= 1 || top >= scene.height - 1 || bottom <= 1) continue;
        for (int i = 0; i < 500; ++i) {
          double u_l = 0, q_l = 0, u_r = 0, q_r = 0;
          point(u_l, q_l);
          point(u_r, q_r);
          if (mode == Perspective::delta_f) {
            add(F::span_f_diff, (u_r - u_l) * q_r);
            add(F::span_f, (u_r - u_l) * q_r);
          } else if (mode == Perspective::hyperbolic) {
            add(F::span_f_diff, u_l * q_l);
            add(F::span_f, u_l * q_l);
          } else {
            add(F::span_f, u_l * q_l);
            add(F::span_uv_acc, u_l);
          }
          add(F::span_h, q_r - b);
          add(F::span_uv, u_r);
        }
      }
      for (const auto& [id, range] : need) {
        Config c = roomy(mode);
        c.start_offset = {};
        Format& f = c.format(id);
        const int fraction = f.fraction();
        f.overflow_expected = false;
        f.integer = 2 - fraction;
        f.word = 2;
        const std::string error = refusal(c, scene);
        ASSERT_TRUE(names(error, id)) << error;
        const int named = number_after(error, "needs int = ");
        const double reach = std::ldexp(1.0, f.is_signed ? named - 1 : named);
        EXPECT_LT(range.second, reach) << key_of(id);
        EXPECT_GE(range.first, f.is_signed ? -reach : -1) << key_of(id);
        EXPECT_GT(std::max(range.second, -range.first), reach / 64)
            << "and not for many more: " << key_of(id);
      }
    }
  }
}

TEST(Range, IntendedOverflowGoesOnAsTheRegisterHasIt) {
  // u wraps to -128..127 in setup.uv; the registers behind need no more than that.
  Config c = shipped_config("depth16");
  c.format(F::setup_uv) = {16, 8, true, Rounding::rnd, Overflow::wrap, true};
  c.format(F::edge_uv) = {16, 8, true, Rounding::rnd, Overflow::sat, false};
  c.format(F::span_uv) = {16, 8, true, Rounding::rnd, Overflow::sat, false};
  std::mt19937_64 random(9);
  const Scene scene = random_scene(random, {50, 100, 1000, 30000});
  EXPECT_EQ(refusal(c, scene), "");
  c.format(F::setup_uv).overflow_expected = false;
  EXPECT_TRUE(names(refusal(c, scene), F::setup_uv));
  c.format(F::setup_uv) = {16, 8, true, Rounding::rnd, Overflow::wrap_sm, true};
  EXPECT_EQ(refusal(c, scene), "");
  c.format(F::setup_uv).overflow = Overflow::sat_zero;
  EXPECT_EQ(refusal(c, scene), "");
}

TEST(Range, LinearFogStopsAtZeroOnlyWhereItSaturates) {
  Config c = shipped_config("depth16");
  c.fog = FogMode::linear;
  std::mt19937_64 random(4);
  Scene scene = random_scene(random, {3, 100, 500, 100});
  EXPECT_EQ(refusal(c, scene), "");
  c.format(F::fog_factor).overflow = Overflow::wrap;
  EXPECT_TRUE(names(refusal(c, scene), F::fog_factor));
  scene.fog.reset();
  EXPECT_EQ(refusal(c, scene), "");
  scene.fog = Fog{{}, 0};
  EXPECT_NE(refusal(c, scene).find("fog distance: is 0"), std::string::npos);
}

TEST(Range, AProjectorAsksForItsVerticesTheirProductsAndItsRange) {
  Config c = shipped_config("depth16");
  c.project = ProjectUnit::reciprocal;
  std::mt19937_64 random(9);
  Scene scene = random_scene(random, {20, 100, 500, 100});
  scene.projector = Projector{3, 900};
  double most = 0;
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) {
      v.project_w = std::uniform_real_distribution(-100.0, 900.0)(random);
      v.project_x = 37 * v.project_w;
      v.project_y = -5 * v.project_w;
      most = std::max(most, std::fabs(v.project_x));
    }
  }
  EXPECT_EQ(refusal(c, scene), "");
  for (const F id : {F::project_vertex, F::project_acc, F::project_value, F::project_ratio, F::project_h}) {
    Config narrow = c;
    Format& f = narrow.format(id);
    const int fraction = f.fraction();
    f.integer = 2 - fraction;
    f.word = 2;
    const std::string error = refusal(narrow, scene);
    EXPECT_TRUE(names(error, id)) << key_of(id) << ": " << error;
    const int integer = number_after(error, "int = ");
    f.integer = integer;
    f.word = integer + fraction;
    EXPECT_EQ(refusal(narrow, scene), "") << key_of(id);
    --f.integer;
    --f.word;
    EXPECT_TRUE(names(refusal(narrow, scene), id)) << key_of(id);
    if (id == F::project_vertex) {
      EXPECT_GE(std::ldexp(1.0, integer - 1), most / 1024);  // s_max <= 2^10
      EXPECT_LT(std::ldexp(1.0, integer - 2), most / 1024);
    }
    narrow.project = ProjectUnit::none;
    EXPECT_EQ(refusal(narrow, scene), "");
    narrow.project = ProjectUnit::reciprocal;
    Scene plain = scene;
    plain.projector.reset();
    EXPECT_EQ(refusal(narrow, plain), "");
  }
  scene.projector = Projector{1e-9, 900};
  EXPECT_NE(refusal(c, scene).find("projector.s_min"), std::string::npos) << refusal(c, scene);
}

TEST(Range, ALightAsksForItsPlaceAndThePointsItIsSeenFrom) {
  Config c = shipped_config("depth16");
  c.light_source = LightSource::point;
  Scene scene;
  scene.width = 200;
  scene.height = 100;
  scene.s_min = 1;
  scene.s_max = 16;
  scene.focal = 12.5;
  Triangle& triangle = scene.triangles.emplace_back();
  triangle.v = {Vertex{-300, 1, 4, 0, 0}, Vertex{90, 5, 8, 0, 0}, Vertex{5, 80, 2, 0, 0}};
  scene.light = Light{.is_point = true, .place = {-3, 2, -5}};
  // In units of 16: at pixels 99.5 / 12.5 to each side, and at the vertices -400 / 12.5 / 4.
  for (const auto& [at, most] :
       {std::pair{LightAt::pixel, 7.96}, {LightAt::vertex, -8.0}, {LightAt::face, -8.0}}) {
    c.light = at;
    Config narrow = c;
    Format& f = narrow.format(F::light_position);
    const auto with_places = [&](int integer) {
      f.word = integer + f.fraction();
      f.integer = integer;
      return refusal(narrow, scene);
    };
    EXPECT_EQ(with_places(4), "") << "-8 to below 8";
    EXPECT_TRUE(names(with_places(3), F::light_position));
    EXPECT_EQ(number_after(with_places(3), "int = "), 4) << most;
    EXPECT_NE(with_places(3).find(most < 0 ? "-8 (triangle 0)" : "7.96"), std::string::npos)
        << with_places(3);
    f.overflow_expected = true;
    EXPECT_EQ(with_places(1), "");
    narrow.light = LightAt::none;
    f.overflow_expected = false;
    EXPECT_EQ(with_places(1), "") << "no light";
  }
  const Scene near = scene;
  scene.light->place = {0, 128 * 16.0, 0};
  EXPECT_TRUE(names(refusal(c, scene), F::light_position)) << "ends below 128";
  scene.light->place = {0, -128 * 16.0, 0};
  EXPECT_EQ(refusal(c, scene), "");
  scene.light = Light{.is_point = false, .place = {0, 1e30, 1e29}};
  EXPECT_EQ(refusal(c, scene), "") << "a direction of any length";
  c.format(F::light_scale) = {24, 0, false, Rounding::rnd, Overflow::sat, false};
  EXPECT_EQ(refusal(c, scene), "");
  EXPECT_TRUE(names(refusal(c, near), F::light_scale)) << "16 / 12.5";
}

TEST(Range, ALightAsksForItsLawsAndItsField) {
  Config c = shipped_config("depth16");
  c.light = LightAt::pixel;
  c.light_source = LightSource::point;
  c.light_law = LightLaw::lunar;
  c.light_fall = LightFall::first;
  c.light_normal = LightNormal::map;
  Scene scene;
  scene.s_max = 16;
  Triangle& triangle = scene.triangles.emplace_back();
  triangle.v = {Vertex{3, 1, 4, 0, 0}, Vertex{90, 5, 8, 0, 0}, Vertex{5, 80, 2, 0, 0}};
  scene.light = Light{.is_point = true, .place = {0, 0, 1}, .lunar = 6, .reach = 4, .offset = 40};
  EXPECT_EQ(refusal(c, scene), "");
  const auto with = [&](F id, int integer) {
    Config narrow = c;
    Format& f = narrow.format(id);
    f.word += integer - f.integer;
    f.integer = integer;
    return refusal(narrow, scene);
  };
  EXPECT_EQ(with(F::light_lunar, 3), "") << "1 + 6";
  EXPECT_TRUE(names(with(F::light_lunar, 2), F::light_lunar));
  EXPECT_EQ(with(F::light_distance, 6), "") << "40";
  EXPECT_TRUE(names(with(F::light_distance, 5), F::light_distance));
  scene.light->reach = 0;
  EXPECT_EQ(with(F::light_distance, 5), "") << "it does not fall";
  triangle.v[1].lx = 1000;
  triangle.v[2].lz = -2000;
  EXPECT_EQ(with(F::relief_vertex, 12), "");
  EXPECT_TRUE(names(with(F::relief_vertex, 11), F::relief_vertex));
}

TEST(Range, ALightAsksForItsNormals) {
  Config c = shipped_config("depth16");
  Scene scene;
  scene.s_max = 16;
  scene.light = Light{};
  Triangle& triangle = scene.triangles.emplace_back();
  triangle.v = {Vertex{3, 1, 4, 0, 0}, Vertex{90, 5, 8, 0, 0}, Vertex{5, 80, 2, 0, 0}};
  triangle.v[1].ny = -2;
  triangle.v[2].nx = 1.5;
  for (const LightAt at : {LightAt::pixel, LightAt::vertex}) {
    c.light = at;
    triangle.v[0].nz = 0;
    EXPECT_EQ(refusal(c, scene), "");
    triangle.v[0].nz = 2;
    const F first = at == LightAt::pixel ? F::normal_vertex : F::normal_value;
    EXPECT_TRUE(names(refusal(c, scene), first)) << "-2 to below 2";
    Config wide = c;
    for (const F id : {F::normal_vertex, F::normal_value}) {
      ++wide.format(id).word;
      ++wide.format(id).integer;
    }
    EXPECT_EQ(refusal(wide, scene), "");
  }
  c.light = LightAt::none;
  EXPECT_EQ(refusal(c, scene), "") << "normals without a light";
}

TEST(Range, DegenerateAndInvisibleTrianglesAskForNothingTheyDoNotUse) {
  Config c = shipped_config("depth16");
  Scene scene;
  scene.triangles.resize(1);
  scene.triangles[0].v = {Vertex{1, 1, 2, 1e9, 0}, Vertex{2, 2, 2, 0, 0}, Vertex{3, 3, 2, 0, 0}};
  EXPECT_EQ(refusal(c, scene), "") << "no area";
  scene.triangles[0].v[2].y = 9;
  EXPECT_TRUE(names(refusal(c, scene), F::setup_uv));
  c.format(F::span_shade) = {4, -2, false};
  scene.triangles[0].v = {Vertex{{-30, 1, 2}, {}}, Vertex{{-20, 2, 2}, {}}, Vertex{{-25, 30, 2}, {}}};
  EXPECT_EQ(refusal(c, scene), "") << "left of the picture: no span";
  scene.triangles[0].v[0].x = 30;
  EXPECT_TRUE(names(refusal(c, scene), F::span_shade));
}

TEST(Range, LinesOnTheEdgesOfThePictureAreSeen) {
  Config c = shipped_config("depth16");
  c.line_walk = LineForm::exact;
  c.format(F::span_shade) = {4, -2, false};
  Scene scene;
  scene.triangles.resize(1);
  Triangle& line = scene.triangles[0];
  line.is_line = true;
  const auto asked = [&](double x, double y, double x1, double y1) {
    line.v = {Vertex{{x, y, 2}, {}}, Vertex{{x1, y1, 2}, {}}, Vertex{{x1, y1, 2}, {}}};
    return names(refusal(c, scene), F::span_shade);
  };
  EXPECT_TRUE(asked(0, 3, 0, 9)) << "the first column";
  EXPECT_TRUE(asked(3, 0, 9, 0)) << "the first row";
  EXPECT_FALSE(asked(-1, 3, -1, 9));
  EXPECT_FALSE(asked(3, -1, 9, -1));
}

TEST(Range, ShippedConfigurationsTakeUsualScenes) {
  std::mt19937_64 random(6);
  for (const std::string& name : shipped_names) {
    const Config file = shipped_config(name);
    for (const double ratio : {1.25, 2.0, 10.0, 1000.0, 20000.0, 100000.0}) {
      for (const Perspective mode : all_perspectives) {
        for (const DepthCode code : {DepthCode::inverse, DepthCode::linear, DepthCode::opengl}) {
          Config c = file;
          c.perspective = mode;
          c.depth_code = code;
          c.fog = FogMode::linear;
          for (const EdgeWalk walk : {EdgeWalk::exact, EdgeWalk::dda}) {
            c.edge_walk = walk;
            EXPECT_EQ(refusal(c, random_scene(random, {30, ratio, 16384, ratio < 2 ? 8192.0 : 32768.0})), "")
                << name << " " << ratio;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
