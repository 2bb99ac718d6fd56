// SPDX-License-Identifier: Apache-2.0
// The distance and the point that come back from the depth buffer, against the truth of the triangle that the
// pixel shows. The bound is the proved one of the stored code.
#include "report/position.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "golden/ideal.hpp"
#include "golden/packed_depth.hpp"
#include "model/engine_model.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "scene/random.hpp"
#include "study/bounds/bounds.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr std::array all_codes{DepthCode::inverse, DepthCode::opengl, DepthCode::linear};

Scene range(double s_min, double s_max) {
  Scene scene;
  scene.width = 4;
  scene.height = 2;
  scene.focal = 2;
  scene.s_min = s_min;
  scene.s_max = s_max;
  return scene;
}

TEST(Position, ByHand) {
  // B = 65535, A = 131070.
  Config config = plain_config();
  const Scene scene = range(1, 2);
  const DistanceOfCode inverse(config, scene);
  EXPECT_EQ(inverse(65535), 1);
  EXPECT_EQ(inverse(21845), 1.5);
  EXPECT_TRUE(std::isnan(inverse(0)));
  config.depth_code = DepthCode::opengl;
  const DistanceOfCode opengl(config, scene);
  EXPECT_EQ(opengl(0), 1);
  EXPECT_EQ(opengl(43690), 1.5);
  EXPECT_TRUE(std::isnan(opengl(65535)));
  // c1 = 65535 * 131070, c0 = 65535: S = (z + c0) / 65535.
  config.depth_code = DepthCode::linear;
  const DistanceOfCode linear(config, scene);
  EXPECT_EQ(linear(0), 1);
  EXPECT_DOUBLE_EQ(linear(13107), 1.2);
  EXPECT_TRUE(std::isnan(linear(65535)));
  // K = 17, p = 12: the nearest octave starts from 2^17, and code 2048 is its middle, 98304.
  config.depth_code = DepthCode::w_float;
  const DistanceOfCode w_float(config, scene);
  EXPECT_DOUBLE_EQ(w_float(0), 131070.0 / 131072);
  EXPECT_DOUBLE_EQ(w_float(2048), 131070.0 / 98304);
  EXPECT_DOUBLE_EQ(w_float(4096), 131070.0 / 65536);
  EXPECT_TRUE(std::isnan(w_float(65535)));
  // 9 bits of mantissa: 8192 is one 1 and no mantissa, 32768. The low 4 bits are dz.
  config.depth_code = DepthCode::float_dz;
  const DistanceOfCode float_dz(config, scene);
  EXPECT_EQ(float_dz(0), 1);
  EXPECT_EQ(float_dz(15), 1);
  EXPECT_DOUBLE_EQ(float_dz(8192), 131070.0 / (65535 + 32767));
  EXPECT_DOUBLE_EQ(float_dz(8192 + 16 + 7), 131070.0 / (65535 + 32767 - 32));
  EXPECT_TRUE(std::isnan(float_dz(65520)));
  EXPECT_EQ(float_dz(65521), 2);
}

// The middle of the picture lies on the axis; y goes down, as in the picture.
TEST(Position, PointsAreThoseOfTheCamera) {
  const Config config = plain_config();
  const Scene scene = range(1, 2);
  Frame frame;
  clear_frame(frame, 4, 2, {0, 0, 0}, 0);
  frame.depth = {65535, 21845, 0, 65535, 65535, 65535, 65535, 65535};
  const Positions out = positions_of(config, scene, frame);
  ASSERT_EQ(out.s.size(), 8U);
  ASSERT_EQ(out.points.size(), 24U);
  const auto point = [&](std::size_t i) {
    return std::array{out.points[3 * i], out.points[3 * i + 1], out.points[3 * i + 2]};
  };
  EXPECT_EQ(point(0), (std::array{-0.75, -0.25, 1.0}));
  EXPECT_EQ(point(1), (std::array{-0.375, -0.375, 1.5}));
  EXPECT_TRUE(std::isnan(out.s[2]) && std::isnan(point(2)[0]) && std::isnan(point(2)[1]));
  EXPECT_EQ(point(3), (std::array{0.75, -0.25, 1.0}));
  EXPECT_EQ(point(7), (std::array{0.75, 0.25, 1.0}));
}

// Every code: back to the code by the formula of the specification with unquantised constants.
TEST(Position, EveryCodeGoesThereAndBack) {
  for (const DepthCode code : all_codes) {
    for (const auto& [s_min, s_max] : {std::pair{1.0, 1000.0}, {0.02, 0.5}, {24.0, 33.0}}) {
      Config config = plain_config();
      config.depth_code = code;
      const Scene scene = range(s_min, s_max);
      const DistanceOfCode distance(config, scene);
      int none = 0;
      for (std::uint32_t z = 0; z < 65536; ++z) {
        const double s = distance(z);
        if (std::isnan(s)) {
          ++none;
          continue;
        }
        const double h = 65535 * s_min * (s_max - s) / (s * (s_max - s_min));
        const double back = code == DepthCode::inverse  ? h
                            : code == DepthCode::opengl ? 65535 - h
                                                        : 65535 * (s - s_min) / (s_max - s_min);
        ASSERT_NEAR(back, z, 0.05) << to_string(code) << " " << s_min << " " << z;
      }
      EXPECT_EQ(none, 1);
    }
  }
}

// Every word of float_dz: back to the z that it stands for.
TEST(Position, EveryPackedWordGoesThereAndBack) {
  Config config = plain_config();
  config.depth_code = DepthCode::float_dz;
  for (const auto& [s_min, s_max] : {std::pair{1.0, 1000.0}, {0.02, 0.5}, {24.0, 33.0}}) {
    const DistanceOfCode distance(config, range(s_min, s_max));
    for (std::uint32_t word = 0; word < 65536; ++word) {
      const double s = distance(word);
      if (word == 65520) {
        ASSERT_TRUE(std::isnan(s));
        continue;
      }
      const double z = 65535 - 65535 * s_min * (s_max - s) / (s * (s_max - s_min));
      ASSERT_NEAR(z, static_cast<double>(golden::unpacked(word, 16).z), 0.05) << s_min << " " << word;
    }
  }
}

// The largest error of S over that which the proved bound of the code allows; 1 is the limit. Of what is no
// bound proved, nothing is returned.
struct Worst {
  double ratio = 0, error = 0, point = 0;  // error, point: in the unit of s
  std::uint64_t pixels = 0;
};
Worst worst_of(const Config& config, const Scene& scene, double code_bound) {
  const auto model = make_model(config);
  model->begin(scene);
  model->draw(scene.triangles, 0, nullptr);
  const Frame& frame = model->frame();
  const Positions back = positions_of(config, scene, frame);
  const double hmax = std::exp2(config.depth_bits) - 1;
  // S of an unquantised code.
  const auto distance = [&](double z) {
    const double h = config.depth_code == DepthCode::opengl ? hmax - z : z;
    return hmax * scene.s_min * scene.s_max / ((scene.s_max - scene.s_min) * h + hmax * scene.s_min);
  };
  Worst out;
  for (std::size_t i = 0; i < frame.triangle.size(); ++i) {
    if (frame.triangle[i] < 0) continue;
    const auto triangle =
        ideal_triangle(config, scene.triangles[static_cast<std::size_t>(frame.triangle[i])]);
    const auto x = static_cast<std::int64_t>(i) % frame.width;
    const auto y = static_cast<std::int64_t>(i) / frame.width;
    const double s = ideal_at(config, scene, *triangle, x, y).point.s;
    const double z = frame.depth[i];
    const double low = std::min(distance(z - code_bound), distance(z + code_bound));
    const double high = std::max(distance(z - code_bound), distance(z + code_bound));
    // A code that saturated tells nothing of what lies beyond it.
    if (z == 0 || z == hmax) continue;
    const double allowed = std::max(high - back.s[i], back.s[i] - low);
    const double error = std::fabs(back.s[i] - s);
    out.ratio = std::max(out.ratio, error / allowed);
    out.error = std::max(out.error, error);
    const double across = static_cast<double>(x) + 0.5 - scene.width / 2.0;
    const double down = static_cast<double>(y) + 0.5 - scene.height / 2.0;
    const double off =
        std::hypot(back.points[3 * i] - across * s / scene.focal,
                   back.points[3 * i + 1] - down * s / scene.focal, back.points[3 * i + 2] - s);
    EXPECT_LE(off, error * std::hypot(1, across / scene.focal, down / scene.focal) * (1 + 1e-9) + 1e-12 * s);
    out.point = std::max(out.point, off);
    ++out.pixels;
  }
  return out;
}

double code_bound(const Config& config, const Scene& scene) {
  for (const Bound& b : error_bounds(config, scene)) {
    if (b.place == "depth.z") return b.bound;
  }
  throw std::logic_error("no bound of depth.z");
}

// Random triangles: of every pixel, S lies within what the proved bound of its code allows.
TEST(Position, StaysWithinTheProvedBoundOfTheCode) {
  RandomOptions options;
  options.width = 160;
  options.height = 120;
  options.triangles = 24;
  options.depth_ratio_max = 100;
  std::uint64_t pixels = 0;
  double worst = 0;
  for (const std::string& name : shipped_names) {
    for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
      Config config = shipped_config(name);
      config.depth_code = code;
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Scene scene = random_scene(seed, options);
        const Worst w = worst_of(config, scene, code_bound(config, scene));
        EXPECT_LE(w.ratio, 1) << name << " " << to_string(code) << ", seed " << seed;
        worst = std::max(worst, w.ratio);
        pixels += w.pixels;
      }
    }
  }
  EXPECT_GT(pixels, 100000U);
  EXPECT_GT(worst, 0.3);  // the bound is not idle
}

// Spot's depth gives points on Spot: each within a step of the code of the triangle that it shows.
TEST(Position, SpotsDepthGivesPointsOnSpot) {
  MeshOptions options;
  options.width = 320;
  options.height = 240;
  ProjectReport report;
  const std::string folder = source_path("tests/data/");
  const Scene scene = mesh_scene(read_mesh(folder + "spot.obj", folder + "spot.png"), options, report);
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    Config config = shipped_config("depth16");
    config.depth_code = code;
    const Worst w = worst_of(config, scene, code_bound(config, scene));
    EXPECT_GT(w.pixels, 10000U);
    EXPECT_LE(w.ratio, 1);
    // Spot is about two units long.
    EXPECT_LT(w.point, 2e-4) << to_string(code);
    EXPECT_GT(w.point, 1e-6);
    RecordProperty("largest_distance_" + std::string(to_string(code)), std::to_string(w.point));
    printf("Spot, %s: %llu pixels, S off by %.3g, point by %.3g at most\n",
           std::string(to_string(code)).c_str(), static_cast<unsigned long long>(w.pixels), w.error, w.point);
  }
  // The linear code has no proved bound: one step, and what R_pixel and c1 lose.
  Config config = shipped_config("depth20");
  config.depth_code = DepthCode::linear;
  const double step = (scene.s_max - scene.s_min) / (std::exp2(20) - 1);
  const Worst w = worst_of(config, scene, 1);
  EXPECT_GT(w.pixels, 10000U);
  EXPECT_LT(w.error, 32 * step);
  printf("Spot, linear of 20 bits: S off by %.3g steps at most\n", w.error / step);
}

}  // namespace
}  // namespace bitspan
