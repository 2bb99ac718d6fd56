// SPDX-License-Identifier: Apache-2.0
// Time and memory against the size of the work, triangles streamed: nothing here holds a scene.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/measure.hpp"
#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "cli/progress.hpp"
#include "config/store.hpp"
#include "model/engine_model.hpp"
#include "report/table.hpp"

namespace bitspan::bench {
namespace {

// Returns the largest resident size since the last reset, MiB; 0 where the system does not tell.
double peak_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) {
      return std::stod(line.substr(6)) / 1024;
    }
  }
  return 0;
}

void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

struct Point {
  std::int64_t triangles = 0;
  std::uint64_t fragments = 0;
  std::uint64_t passed = 0;  // fragments that passed the depth test
  double begin = 0;          // seconds of begin(), once per picture
  double seconds = 0;        // of draw(); making the triangles is left out
  double peak = 0;           // MiB
};

Point draw_stream(const Config& config, std::int64_t triangles, double pixels) {
  constexpr std::int64_t batch = 4096;
  const Scene scene = empty_scene("growth", 1024, 768);
  CloudStream stream(6, scene, pixels);
  reset_peak();
  Point p;
  p.triangles = triangles;
  const auto engine = make_model(config, {.winners = false});
  double start = now_seconds();
  engine->begin(scene);
  p.begin = now_seconds() - start;
  std::vector<Triangle> some;
  Progress progress("growth");
  for (std::int64_t done = 0; done < triangles;) {
    some.clear();
    while (static_cast<std::int64_t>(some.size()) < std::min(batch, triangles - done)) {
      some.push_back(stream.next());
    }
    start = now_seconds();
    engine->draw(some, done, nullptr);
    p.seconds += now_seconds() - start;
    done += static_cast<std::int64_t>(some.size());
    progress.update(static_cast<std::size_t>(done), static_cast<std::size_t>(triangles));
  }
  p.fragments = engine->counters().fragments;
  p.passed = engine->counters().depth_passed;
  p.peak = peak_mib();
  return p;
}

}  // namespace

Growth bench_growth(double pixels_limit, double triangles_limit) {
  constexpr double large = 1000, little = 16;  // pixels per triangle
  const Config config = find_config("depth16");
  nlohmann::ordered_json json;
  Growth out;
  const auto add = [&](const char* key, const char* title, double first, double limit, double pixels,
                       bool by_triangles) {
    std::vector<std::vector<std::string>> rows{{"triangles", "fragments", "passed %", "begin s", "draw s",
                                                by_triangles ? "ns per triangle" : "ns per fragment",
                                                "peak MiB"}};
    json[key] = nlohmann::ordered_json::array();
    for (double n = first; n <= limit * 1.5; n *= 10) {
      const auto triangles = static_cast<std::int64_t>(by_triangles ? n : n / pixels);
      const Point p = draw_stream(config, triangles, pixels);
      const double items = by_triangles ? static_cast<double>(p.triangles) : static_cast<double>(p.fragments);
      rows.push_back(
          {std::to_string(p.triangles), std::to_string(p.fragments),
           fmt::format("{:.0f}", 100 * static_cast<double>(p.passed) / static_cast<double>(p.fragments)),
           fmt::format("{:.4f}", p.begin), fmt::format("{:.4f}", p.seconds),
           fmt::format("{:.2f}", 1e9 * p.seconds / items), fmt::format("{:.1f}", p.peak)});
      json[key].push_back({{"triangles", p.triangles},
                           {"fragments", p.fragments},
                           {"depth_passed", p.passed},
                           {"begin_seconds", p.begin},
                           {"draw_seconds", p.seconds},
                           {"peak_mib", p.peak}});
    }
    out.text += fmt::format("{}\n{}\n", title, text_table(rows));
  };
  add("pixels", "against pixels: triangles of 1000 pixels, one picture", 1e4, pixels_limit, large, false);
  add("triangles", "against triangles: of 16 pixels, one picture", 10, triangles_limit, little, true);
  out.json = json.dump(2) + "\n";
  return out;
}

}  // namespace bitspan::bench
