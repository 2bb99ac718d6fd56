// SPDX-License-Identifier: Apache-2.0
// All oracles of the truth over the same random streams.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <map>
#include <mutex>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

// What oracles are compared over, in all: counts of pixels.
struct StreamCounts {
  std::uint64_t compared = 0, ties = 0, unexplained = 0;
};

// Compares every oracle of the truth with the model over random streams in the shipped configurations. An
// oracle that refuses a stream is not compared over it.
std::map<std::string, StreamCounts> over_streams(std::uint64_t streams, std::uint64_t first_seed,
                                                 const RandomOptions& options) {
  const std::vector<Config> configs = shipped_configs();
  std::map<std::string, StreamCounts> out;
  std::mutex out_lock;
  tbb::parallel_for(first_seed, first_seed + streams, [&](std::uint64_t seed) {
    const Config& config = configs[seed % configs.size()];
    const Scene scene = random_scene(seed, options);
    const Frame frame = test::drawn_by("model", config, scene);
    const Visibility visibility(config, scene, stored_depth_bounds(config, scene));
    for (const Oracle& oracle : oracles()) {
      if (!oracle.is_truth || !oracle.judges_pixels()) continue;
      if (oracle.refuses != nullptr && !oracle.refuses(config, scene).empty()) continue;
      const VisibilityReport report = visibility.compare(oracle, visibility.picture(oracle), frame, "model");
      EXPECT_EQ(report.unexplained, 0U)
          << oracle.name << ", " << config.name << ", seed " << seed << ": " << report.first;
      const std::scoped_lock lock(out_lock);
      StreamCounts& counts = out[std::string(oracle.name)];
      counts.compared += report.compared();
      counts.ties += report.ties;
      counts.unexplained += report.unexplained;
    }
  });
  return out;
}

// BITSPAN_LONG asks for 10^4 streams and more than 10^9 pixels, which take more than an hour of a core. Code
// with sanitizers has a twentieth of them.
#ifdef __SANITIZE_ADDRESS__
constexpr std::uint64_t long_streams = 500;
#else
constexpr std::uint64_t long_streams = 10'000;
#endif

TEST(OracleStreams, EveryOracleOfTheTruthHolds) {
  constexpr std::uint64_t first_seed = 5001;
  const std::uint64_t streams = is_long_run() ? long_streams : 4;
  RandomOptions options = test::opaque_options();
  options.width = 252;
  options.height = 189;
  options.triangles = 14;
  options.size_min = 72;
  options.size_max = 315;
  options.depth_ratio_max = 8;  // so that `parametric` takes every stream
  const auto start = std::chrono::steady_clock::now();
  const auto counts = over_streams(streams, first_seed, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  StreamCounts all;
  for (const auto& [name, of_oracle] : counts) {
    printf("%-12s %12llu pixels, %9llu ties, %llu unexplained\n", name.c_str(),
           static_cast<unsigned long long>(of_oracle.compared),
           static_cast<unsigned long long>(of_oracle.ties),
           static_cast<unsigned long long>(of_oracle.unexplained));
    EXPECT_GT(of_oracle.compared, 6000 * streams) << name;
    all.compared += of_oracle.compared;
    all.ties += of_oracle.ties;
  }
  printf("%llu streams, seeds from %llu: %llu pixels compared, %llu ties, %.1f s\n",
         static_cast<unsigned long long>(streams), static_cast<unsigned long long>(first_seed),
         static_cast<unsigned long long>(all.compared), static_cast<unsigned long long>(all.ties),
         seconds.count());
  EXPECT_GE(counts.size(), 8U);
  if (streams >= 10'000) {
    EXPECT_GE(all.compared, 1'000'000'000U);
  }
}

}  // namespace
}  // namespace bitspan
