// SPDX-License-Identifier: Apache-2.0
// A flat untextured triangle of a shipped configuration has the code that its vertices have; where it has
// not, the configuration's file says which codes.
#include <gtest/gtest.h>

#include <array>
#include <regex>
#include <utility>

#include "golden/engine_golden.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::test {
namespace {

constexpr int side = 16, columns = 16, codes = 256;

// A tile per code, of two triangles that a slanted depth and an edge of no whole slope make uneven.
Scene tiles() {
  Scene scene;
  scene.width = side * columns;
  scene.height = side * codes / columns;
  scene.s_min = 1;
  scene.s_max = 1000;
  scene.focal = 500;
  for (int code = 0; code < codes; ++code) {
    const double x = side * (code % columns), y = side * (code / columns);
    const double color = code / 255.0;
    const auto vertex = [&](double dx, double dy, double s) {
      Vertex v;
      v.x = x + dx;
      v.y = y + dy;
      v.s = s;
      v.c = {color, color, color, 1};
      return v;
    };
    const Vertex a = vertex(0, 0, 2), b = vertex(side, 0, 7.3), c = vertex(side, side, 50),
                 d = vertex(0, side, 3);
    scene.triangles.push_back({{a, b, c}, -1});
    scene.triangles.push_back({{a, c, d}, -1});
  }
  return scene;
}

// "Flat codes 128..191 are drawn one higher": first, last; the text of every file that draws all has none.
std::pair<int, int> exceptions(const std::string& text) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(R"(Flat codes (\d+)\.\.(\d+) are drawn one higher)")))
    return {1, 0};
  return {std::stoi(found[1]), std::stoi(found[2])};
}

// Calls see(code, the red, green and blue that are drawn) per pixel.
template <class See>
void draw(const Config& config, const Scene& scene, const See& see) {
  const auto engine = make_golden(config);
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  const Frame& frame = engine->frame();
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const std::uint8_t* pixel = &frame.color[4 * static_cast<std::size_t>(y * scene.width + x)];
      see(y / side * columns + x / side, std::array<int, 3>{pixel[0], pixel[1], pixel[2]});
    }
  }
}

TEST(FlatCodes, AreDrawnAsThemselvesOrTheFileSaysWhich) {
  const Scene scene = tiles();
  int higher = 0;
  for (const std::string& name : shipped_names) {
    const auto [first, last] = exceptions(read_file(source_path("config/") + name + ".toml"));
    draw(shipped_config(name), scene,
         [&, first = first, last = last](int code, const std::array<int, 3>& pixel) {
           const int expected = code + (code >= first && code <= last ? 1 : 0);
           higher += expected - code;
           ASSERT_EQ(pixel, (std::array{expected, expected, expected})) << name << " " << code;
         });
  }
  EXPECT_EQ(higher, 64 * side * side) << "of narrow alone";
}

// What the file of narrow advises.
TEST(FlatCodes, ATenthBitOfColoursDrawsAllInNarrow) {
  Config config = shipped_config("narrow");
  for (const FormatId id : {FormatId::setup_shade, FormatId::edge_shade, FormatId::span_shade})
    ++config.format(id).word;
  draw(config, tiles(), [](int code, const std::array<int, 3>& pixel) {
    ASSERT_EQ(pixel, (std::array{code, code, code})) << code;
  });
}

}  // namespace
}  // namespace bitspan::test
