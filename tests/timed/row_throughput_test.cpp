// SPDX-License-Identifier: Apache-2.0
// The interpolator's clocks over real rows that are always there, its pixels always taken: docs/area.md has
// the table that this prints.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "model/engine_model.hpp"
#include "model/timed/span_interpolator_timing.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Pixels of each row.
std::vector<std::int64_t> rows_of(const Config& config, const Scene& scene) {
  Trace trace;
  const auto model = make_model(config);
  model->begin(scene);
  model->draw(scene.triangles, 0, &trace);
  std::vector<std::int64_t> counts;
  for (const SpanRecord& span : trace.span) counts.push_back(span.count);
  return counts;
}

std::uint64_t clocks_of(const InterpolatorLatency& latency, const std::vector<std::int64_t>& rows) {
  SpanInterpolatorTiming timing(latency);
  std::uint64_t clocks = 0;
  for (std::size_t next = 0; next < rows.size() || !timing.idle(); ++clocks) {
    const bool there = next < rows.size();
    next += timing.clock(there, there ? rows[next] : 1, true).accept ? 1 : 0;
  }
  return clocks;
}

struct Variant {
  int interval, bits_per_cycle, multipliers;
  bool shades = true;
};

TEST(RowThroughput, NothingIsLostBesideTheInterval) {
  const Config shipped = shipped_config("depth16");
  ProjectReport report;
  const std::string spot = source_path("tests/data/spot");
  const std::vector<std::pair<std::string, Scene>> scenes = {
      {"demo", demo_scene(640, 480)},
      {"spot", mesh_scene(read_mesh(spot + ".obj", spot + ".png"), MeshOptions{}, report)}};
  for (const auto& [name, scene] : scenes) {
    const std::vector<std::int64_t> rows = rows_of(shipped, scene);
    std::int64_t pixels = 0;
    for (const std::int64_t count : rows) pixels += count;
    ASSERT_GT(rows.size(), 1000U);
    fmt::print("{}: {} rows, {} pixels\n", name, rows.size(), pixels);
    for (const Variant& v : {Variant{4, 8, 2, false},
                             {8, 4, 1, false},
                             {12, 2, 1, false},
                             {23, 1, 1, false},
                             {4, 8, 4},
                             {8, 4, 2},
                             {16, 2, 1},
                             {23, 1, 1}}) {
      for (const int fifo : {1, 2}) {
        Config config = shipped;
        config.row_reciprocal.bits_per_cycle = v.bits_per_cycle;
        config.rtl.setup_multipliers = v.multipliers;
        config.rtl.fifo = fifo;
        config.rtl.shades = v.shades;
        const InterpolatorLatency latency = interpolator_latency(config);
        ASSERT_EQ(latency.interval, v.interval);
        std::uint64_t least = 0;
        for (const std::int64_t count : rows)
          least += static_cast<std::uint64_t>(std::max<std::int64_t>(count, v.interval));
        const std::uint64_t clocks = clocks_of(latency, rows);
        const double ratio = static_cast<double>(clocks) / static_cast<double>(least);
        fmt::print("  interval {}{}, FIFO {}: {} clocks, {:.3f} of the least, {:.3f} pixels per clock\n",
                   v.interval, v.shades ? " with shades" : "", fifo, clocks, ratio,
                   static_cast<double>(pixels) / static_cast<double>(clocks));
        EXPECT_GE(clocks, static_cast<std::uint64_t>(pixels));
        EXPECT_LE(ratio, 1.001);
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
