// SPDX-License-Identifier: Apache-2.0
// What the tests of the configuration share.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {

std::vector<std::string> lines_of(const std::string& text);
std::string text_of(const std::vector<std::string>& lines);

// "" where it is legal; the origin is "file.toml".
std::string parse_error_of(const std::string& text);

// Any value of every key, legal one by one; the rules between keys may still refuse it.
Config any_config(std::uint64_t seed);

// Triangles all over the picture and beyond it, inside the limits given.
struct SceneLimits {
  int triangles = 20;
  double s_ratio = 1000;
  double xy = 8192;  // |x|, |y| at most
  double uv = 32768;
};
Scene random_scene(std::mt19937_64& random, const SceneLimits& limits);

}  // namespace bitspan
