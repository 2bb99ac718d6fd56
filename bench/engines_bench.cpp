// Whole engines over one scene, turn about: fragments a second. Quote the ratios between the rows of one run.
#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <string>

#include "config/config.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/demo.hpp"
#include "tb/engine_rtl.hpp"

namespace {

using namespace bitspan;

Config depth16() { return load_config(BITSPAN_CONFIG_DIR "/depth16.toml"); }

void draw_demo(benchmark::State& state, const std::function<std::unique_ptr<Engine>(const Config&)>& make) {
  const Scene scene = demo_scene(320, 240);
  const std::unique_ptr<Engine> engine = make(depth16());
  std::uint64_t fragments = 0;
  for (auto iteration : state) {
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    fragments += engine->counters().fragments;
    benchmark::DoNotOptimize(engine->frame().color.data());
  }
  state.counters["fragments"] = benchmark::Counter(static_cast<double>(fragments),
                                                   benchmark::Counter::kIsRate, benchmark::Counter::kIs1000);
}

BENCHMARK_CAPTURE(draw_demo, model, [](const Config& c) {
  return make_model(c);
})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw_demo, golden, [](const Config& c) {
  return make_golden(c);
})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw_demo, ideal, [](const Config& c) {
  return make_ideal(c);
})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw_demo, systemc, [](const Config& c) {
  return make_systemc(c, {});
})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw_demo, rtl, [](const Config& c) {
  return make_rtl(c, {});
})->Unit(benchmark::kMillisecond);

}  // namespace
