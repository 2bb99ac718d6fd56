// SPDX-License-Identifier: Apache-2.0
// What the C interface costs: frames and records of the demo by bitspan.h, beside the engine itself.
#include <memory>
#include <stdexcept>
#include <string>

#include "bench/report.hpp"
#include "bitspan/bitspan.h"
#include "config/store.hpp"
#include "engine/registry.hpp"
#include "scene/demo.hpp"

namespace bitspan::bench {
namespace {

void check(bs_status status) {
  if (status != BS_OK) throw std::runtime_error(bs_last_error());
}

// Never closed: they live as long as the program.
struct Handles {
  Handles() {
    check(bs_config_load("depth16", &config));
    check(bs_scene_load("demo", 0, 0, &scene));
    check(bs_scene_get(scene, &desc));
    check(bs_scene_triangles(scene, &vertices, &textures, &triangles));
  }
  bs_config* config = nullptr;
  bs_scene* scene = nullptr;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices = nullptr;
  const std::int32_t* textures = nullptr;
  std::size_t triangles = 0;
};

// Draws, and returns the number of pixel records.
std::size_t draw(const Handles& handles, bs_model* model, bool records) {
  check(bs_begin(model, &handles.desc));
  check(bs_draw(model, handles.vertices, handles.textures, handles.triangles, 0, 0));
  if (!records) return 0;
  bs_view view{};
  view.size = sizeof view;
  check(bs_records(model, BS_STAGE_SPAN, &view));
  return view.rows;
}

}  // namespace

void bench_interface(const Options& options, Report& report) {
  const Handles handles;
  const Scene scene = demo_scene(handles.desc.width, handles.desc.height);
  std::vector<Turn> turns;
  std::vector<std::unique_ptr<Engine>> engines;
  for (const bool records : {false, true}) {
    const std::string what = records ? "demo and all records, " : "demo, ";
    Engine* const engine = engines.emplace_back(make_engine("model", find_config("depth16"))).get();
    const auto trace = std::make_shared<Trace>();
    bs_model* model = nullptr;
    check(bs_open(handles.config, "model", &model));
    check(bs_trace(model, records ? 1 : 0));
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    const double work = static_cast<double>(engine->counters().fragments) / 1e6;
    Series& own = report.add(what + "the engine", work);
    Series& interface = report.add(what + "C interface", work);
    turns.push_back({&own, [=, &scene] {
                       const double start = now_seconds();
                       trace->clear();
                       engine->begin(scene);
                       engine->draw(scene.triangles, 0, records ? trace.get() : nullptr);
                       return now_seconds() - start;
                     }});
    turns.push_back({&interface, [=, &handles, &report] {
                       const double start = now_seconds();
                       const std::size_t pixels = draw(handles, model, records);
                       const double seconds = now_seconds() - start;
                       report.sound = report.sound && pixels == trace->fragment.size();
                       return seconds;
                     }});
    report.goals.push_back({what + "C interface", "the engine itself", &interface, &own, 1 / 1.2});
  }
  take_turns("interface", turns, options.rounds);
}

}  // namespace bitspan::bench
