// SPDX-License-Identifier: Apache-2.0
// The timed model, and the checking of golden against model, beside the RTL's own simulation of the same
// rows.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "config/store.hpp"
#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/lockstep.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan::bench {
namespace {

// Small enough for the RTL, and wide enough that its pipeline is mostly full.
Scene small_picture() {
  constexpr int triangles = 250;
  constexpr double pixels = 800;
  Scene scene = empty_scene("engines", 320, 240);
  CloudStream stream(5, scene, pixels);
  for (int i = 0; i < triangles; ++i) {
    scene.triangles.push_back(stream.next());
  }
  return scene;
}

std::vector<RtlInputs> rows_of(const Config& config, const Scene& scene) {
  const model::Pipeline pipeline = model::make_pipeline(config, scene);
  model::Rows rows;
  model::PlaneWalkState walk;
  Counters counters;
  for (const Triangle& t : scene.triangles) {
    model::triangle_to_rows(pipeline, t, 0, walk, rows, counters, nullptr);
  }
  std::vector<RtlInputs> out;
  for (const RowRecord& row : rows.rows) {
    out.push_back(rtl_inputs(config, row, pipeline.constants.record.b));
  }
  return out;
}

double draw(Engine& engine, const Scene& scene) {
  const double start = now_seconds();
  engine.begin(scene);
  engine.draw(scene.triangles, 0, nullptr);
  return now_seconds() - start;
}

}  // namespace

void bench_engines(const Options& options, Report& report) {
  const Config config = find_config("depth16");
  const Scene scene = small_picture();
  const auto model = make_model(config);
  draw(*model, scene);
  const double work = static_cast<double>(model->counters().fragments) / 1e6;
  Series& rtl_series = report.add("RTL span interpolator alone, Verilator", work);
  Series& cycle_series = report.add("timed model, cycle mode", work);
  Series& span_series = report.add("timed model, span mode", work);
  Series& verify_series = report.add("verify: golden and model, all records", work);

  Rtl rtl(config);
  const std::vector<RtlInputs> rows = rows_of(config, scene);
  const auto cycle = make_systemc(config, {.mode = TimedMode::cycle});
  const auto span = make_systemc(config, {.mode = TimedMode::span});
  std::array<std::unique_ptr<Engine>, 2> pair{make_golden(config), make_model(config)};
  std::vector<Turn> turns;
  turns.push_back({&rtl_series, [&] {
                     const double start = now_seconds();
                     const RtlRun run = run_rtl(rtl, rows, {}, false);
                     report.sound = report.sound && run.pixels.size() == model->counters().fragments;
                     return now_seconds() - start;
                   }});
  turns.push_back({&cycle_series, [&] { return draw(*cycle, scene); }});
  turns.push_back({&span_series, [&] {
                     const double seconds = draw(*span, scene);
                     report.sound = report.sound && span->counters() == cycle->counters();
                     return seconds;
                   }});
  turns.push_back({&verify_series, [&] {
                     const LockStepResult result = run_lock_step(pair, scene, {});
                     report.sound = report.sound && !result.stopped && result.records > 0;
                     return result.seconds;
                   }});
  take_turns("engines", turns, options.rounds);
  report.goals.push_back({"timed model, span mode, whole pipeline", "RTL span interpolator alone",
                          &span_series, &rtl_series, 5});
  report.goals.push_back(
      {"timed model, cycle mode", "RTL span interpolator alone", &cycle_series, &rtl_series, 0});
  report.goals.push_back({"verify of golden and model, all records", "RTL's own simulation time",
                          &verify_series, &rtl_series, 1});
}

}  // namespace bitspan::bench
