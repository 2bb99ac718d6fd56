// SPDX-License-Identifier: Apache-2.0
#include "tests/config/support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "report/random_config.hpp"

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

Config any_config(std::uint64_t seed) {
  static const std::vector<Config> bases = shipped_configs();
  Config c = draw_config(seed, bases, {.least_coordinate_bits = 2, .for_scenes = false, .check = {}});
  c.name = "random";
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
