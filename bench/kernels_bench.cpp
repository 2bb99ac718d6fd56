// SPDX-License-Identifier: Apache-2.0
// The span kernel in every form, under Google Benchmark, all in this process and in random order.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <deque>
#include <map>

#include "bench/plain_kernel.hpp"
#include "bench/report.hpp"
#include "bench/span_kernels.hpp"
#include "cli/progress.hpp"
#include "config/store.hpp"
#include "model/simd/shipped.hpp"

namespace bitspan::bench {
namespace {

constexpr int spans = 4;
constexpr int span_pixels = 256;

// Takes the repetitions of each benchmark as samples of the series of its name.
class Collector final : public benchmark::BenchmarkReporter {
 public:
  Collector(std::map<std::string, Series*> series, std::size_t runs)
      : series_(std::move(series)), runs_(runs) {}
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const auto found = series_.find(run.run_name.function_name);
      if (run.run_type != Run::RT_Iteration || found == series_.end()) {
        continue;
      }
      auto& seconds = found->second->seconds;
      const auto round = static_cast<std::size_t>(run.repetition_index);
      seconds.resize(std::max(seconds.size(), round + 1));
      seconds[round] = run.cpu_accumulated_time / static_cast<double>(run.iterations);
      progress_.update(++done_, runs_);
    }
  }

 private:
  std::map<std::string, Series*> series_;
  std::size_t runs_, done_ = 0;
  Progress progress_{"kernels"};
};

void run_google_benchmark(const Options& options, std::map<std::string, Series*> series) {
  std::array<std::string, 4> flags{"bitspan_bench", fmt::format("--benchmark_repetitions={}", options.rounds),
                                   fmt::format("--benchmark_min_time={}", options.kernel_time),
                                   "--benchmark_enable_random_interleaving=true"};
  std::array<char*, 4> arguments{};
  for (std::size_t i = 0; i < flags.size(); ++i) {
    arguments[i] = flags[i].data();
  }
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  const std::size_t runs = series.size() * static_cast<std::size_t>(options.rounds);
  Collector collector(std::move(series), runs);
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::Shutdown();
}

}  // namespace

void bench_kernels(const Options& options, Report& report) {
  const Config depth16 = find_config("depth16");
  std::deque<SpanCase> cases;
  std::map<std::string, Series*> series;
  for (const Config& config : {depth16, restoring_of(depth16)}) {
    SpanCase& c = cases.emplace_back(make_span_case(config, spans, span_pixels, span_pixels));
    const auto name_of = [&](std::string_view kernel) {
      return fmt::format("span, {}: {}", config.name, kernel);
    };
    for (const NamedKernel& named : span_kernels()) {
      Series& s = report.add(name_of(named.name), static_cast<double>(c.pixels) / 1e6);
      try {
        const SpanKernel kernel = named.make(c);
        benchmark::RegisterBenchmark(s.name.c_str(), [kernel](benchmark::State& state) {
          for (auto iteration : state) {
            kernel(nullptr);
            benchmark::ClobberMemory();
          }
        });
        series[s.name] = &s;
      } catch (const InputError& e) {
        s.missing = e.what();
      }
    }
    // What the table asks for; a kernel that this build lacks shows as not measured.
    const auto of = [&](std::string_view kernel) -> const Series* {
      for (const Series& s : report.series) {
        if (s.name == name_of(kernel)) {
          return &s;
        }
      }
      Series& absent = report.add(name_of(kernel), 0);
      absent.missing = "this build has no such kernel";
      return &absent;
    };
    const Series* plain = of("plain int64, constants");
    const std::string kernel = fmt::format("span kernel, {}", config.name);
    const Series* vector = of("model, vector");
    report.goals.push_back({kernel + ", run-time formats", "plain int64, constants", vector, plain, 1.8});
    if (model::shipped_index(config).spans >= 0) {
      report.goals.push_back(
          {kernel + ", specialised", "plain int64, constants", of("model, specialised"), plain, 2.4});
    }
    report.goals.push_back({kernel + ", run-time, all statistics", "plain int64, constants",
                            of("model, vector, statistics"), plain, 0.8});
    report.goals.push_back({kernel + ", run-time formats", "sc_fix", vector, of("sc_fix"), 800});
    report.goals.push_back({kernel + ", run-time formats", "sc_fixed_fast", vector, of("sc_fixed_fast"), 0});
    report.goals.push_back(
        {kernel + ", run-time formats", "RTL under Verilator", vector, of("RTL, Verilator"), 0});
    report.goals.push_back({kernel + ", scalar", "plain int64, constants", of("model, scalar"), plain, 0});
  }
  run_google_benchmark(options, std::move(series));
}

}  // namespace bitspan::bench
