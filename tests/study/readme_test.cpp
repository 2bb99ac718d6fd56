// SPDX-License-Identifier: Apache-2.0
// The numbers that README.md claims of pictures and widths, computed again from the finished pictures alone,
// without the metrics of studies and verdicts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "engine/engine.hpp"
#include "scene/camera_views.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "study/cost.hpp"
#include "study/engines.hpp"
#include "study/keys.hpp"
#include "tests/support/files.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

std::string readme() {
  static const std::string text = read_file(source_path("README.md"));
  return text;
}

// Returns the captures of the first place that matches.
std::vector<std::string> quoted(const std::string& pattern) {
  const std::string text = readme();
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(pattern))) {
    ADD_FAILURE() << "README.md has no " << pattern;
    return std::vector<std::string>(20);
  }
  return {match.begin() + 1, match.end()};
}

struct Pair {
  Frame engine, ideal;
};
Pair drawn_by_both(const Config& config, const Scene& scene) {
  return {drawn("model", config, scene), drawn("ideal", config, scene)};
}

// Returns the share of the pixels on which the same textured triangle won and u or v is in another quarter.
double wrong_quarters(const Config& config, const Scene& scene) {
  const auto [engine, ideal] = drawn_by_both(config, scene);
  const auto quarter = [](double x) { return std::floor(4 * x); };
  double all = 0;
  double wrong = 0;
  for (std::size_t i = 0; i < engine.triangle.size(); ++i) {
    const auto t = engine.triangle[i];
    if (t < 0 || t != ideal.triangle[i] || scene.triangles[static_cast<std::size_t>(t)].texture < 0) continue;
    ++all;
    wrong +=
        quarter(engine.u[i]) != quarter(ideal.u[i]) || quarter(engine.v[i]) != quarter(ideal.v[i]) ? 1 : 0;
  }
  EXPECT_GT(all, 2'000) << scene.name;
  return wrong / all;
}

// "95 % of the pixels keep their quarter of a texel, in u and v together": the widths that the README quotes,
// on its views and on those that chose nothing.
TEST(Readme, TheWidthsOfTheSearchKeepTheQuarterTexel) {
  const std::string text = readme();
  const auto from = text.find("uv_bits: cost.register_bits");
  ASSERT_NE(from, std::string::npos);
  const std::string block = text.substr(from, text.find("[docs/study.md]", from) - from);
  std::vector<KeySetting> settings;
  const std::regex setting("\n +([a-z_.]+) = (\\d+)");
  for (std::sregex_iterator at(block.begin(), block.end(), setting), end; at != end; ++at) {
    settings.push_back({(*at)[1].str(), std::int64_t{std::stoi((*at)[2].str())}});
  }
  ASSERT_EQ(settings.size(), 4U);
  const Config config = with_keys(shipped_config("depth16"), settings);
  EXPECT_EQ(quoted("uv_bits: cost.register_bits = (\\d+) after")[0],
            fmt::format("{}", register_bits(config)));

  const double limit = 1 - std::stod(quoted("with which (\\d+) % of the pixels keep")[0]) / 100;
  const Scene own = demo_scene(320, 240);
  double worst = 0;
  for (int camera = 0; camera < 24; ++camera) {
    const Scene scene = camera == 0 ? own : seen_from(own, camera);
    const double share = wrong_quarters(config, scene);
    EXPECT_LE(share, limit) << camera;
    if (camera < 12) worst = std::max(worst, share);
  }
  EXPECT_EQ(quoted("picture.wrong_subtexel_rate_2 is (\\S+) on")[0], fmt::format("{:.6g}", worst));
}

// docs/studies/views.md: the worst of a hundred views that chose nothing and, in the long form, how many
// hold.
TEST(Readme, WidthsHoldOnAsManyUnseenViewsAsThePageSays) {
  const std::string page = read_file(source_path("docs/studies/views.md"));
  const std::regex row(
      R"(\| ([^|]*) \| (\d+), (\d+), (\d+) \| (\d+) \| [^|]* \| (\d+) \| ([0-9.]+) on demo@(\d+) \|)");
  const Scene own = demo_scene(320, 240);
  int rows = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), row), end; at != end; ++at, ++rows) {
    const auto number = [&](std::size_t i) { return std::int64_t{std::stoi((*at)[i].str())}; };
    const Config config = with_keys(shipped_config("depth16"), {{"formats.span.f.word", number(2)},
                                                                {"formats.span.f_step.word", number(2)},
                                                                {"formats.edge.uv.word", number(3)},
                                                                {"reciprocal.pixel.output.word", number(4)}});
    EXPECT_EQ(register_bits(config), static_cast<double>(number(5)));
    const auto share = [&](int camera) { return wrong_quarters(config, seen_from(own, camera)); };
    EXPECT_EQ((*at)[7].str(), fmt::format("{:.3g}", share(static_cast<int>(number(8))))) << (*at)[1];
    if (!is_long_run()) continue;
    int held = 0;
    const int first = (*at)[1].str().starts_with("one") ? 1 : 12;
    for (int camera = first; camera < first + 100; ++camera) held += share(camera) <= 0.05 ? 1 : 0;
    EXPECT_EQ(held, number(6)) << (*at)[1];
  }
  EXPECT_EQ(rows, 3);
  EXPECT_NE(page.find(" | " + quoted("holds on (\\d+) of 100 other views; this one holds on")[0] + " | "),
            std::string::npos);
  EXPECT_NE(page.find(" | " + quoted("other views; this one holds on (\\d+) of 100")[0] + " | "),
            std::string::npos);
}

// The table of the shipped configurations: errors of the visible pixels' u and v, and the signal to noise.
TEST(Readme, TheTableOfConfigurationsHasTheirErrors) {
  MeshOptions options;
  options.texture = source_path("tests/data/spot.png");
  ProjectReport faces;
  const Scene scene =
      mesh_scene(read_mesh(source_path("tests/data/spot.obj"), options.texture), options, faces);
  EXPECT_EQ(quoted("Spot is a closed\nmesh of ([0-9,]+) triangles")[0],
            fmt::format("{},{:03}", faces.faces / 1000, faces.faces % 1000));
  for (const std::string name : {"depth16", "depth20", "narrow"}) {
    const auto [engine, ideal] = drawn_by_both(shipped_config(name), scene);
    double count = 0;
    double squares = 0;
    double worst = 0;
    double colours = 0;
    for (std::size_t i = 0; i < engine.triangle.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = static_cast<double>(engine.color[4 * i + c]) - ideal.color[4 * i + c];
        colours += d * d;
      }
      if (engine.triangle[i] < 0 || engine.triangle[i] != ideal.triangle[i]) continue;
      for (const double d : {engine.u[i] - ideal.u[i], engine.v[i] - ideal.v[i]}) {
        ++count;
        squares += d * d;
        worst = std::max(worst, std::fabs(d));
      }
    }
    const double psnr =
        10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(engine.triangle.size()) / colours);
    const auto row =
        quoted(fmt::format(R"(\| `{}` \|(?:[^|]*\|){{5}} ([0-9.]+), ([0-9.]+) \| ([0-9.]+) dB)", name));
    EXPECT_EQ(row[0], fmt::format("{:.2g}", std::sqrt(squares / count))) << name;
    EXPECT_EQ(std::stod(row[1]), std::stod(fmt::format("{:.2g}", worst))) << name;
    EXPECT_EQ(row[2], fmt::format("{:.1f}", psnr)) << name;
  }
}

}  // namespace
}  // namespace bitspan
