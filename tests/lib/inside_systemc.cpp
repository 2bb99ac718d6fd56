// SPDX-License-Identifier: Apache-2.0
// A SystemC program of the caller's: the engine systemc works beside its simulation and is refused inside its
// processes, where the engine timed works.
#include <bitspan/bitspan.h>

#include <cstdio>
#include <systemc>

namespace {

int faults = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s: %s\n", what, bs_last_error());
  ++faults;
}

bs_status draw(const char* engine) {
  bs_config* config = nullptr;
  bs_scene* scene = nullptr;
  bs_model* model = nullptr;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices = nullptr;
  const int32_t* textures = nullptr;
  size_t count = 0;
  bs_status status = bs_config_load("depth16", &config);
  if (status == BS_OK) status = bs_scene_load("demo", 96, 72, &scene);
  if (status == BS_OK) status = bs_open(config, engine, &model);
  if (status == BS_OK) status = bs_scene_get(scene, &desc);
  if (status == BS_OK) status = bs_scene_triangles(scene, &vertices, &textures, &count);
  if (status == BS_OK) status = bs_begin(model, &desc);
  if (status == BS_OK) status = bs_draw(model, vertices, textures, count, 0, 0);
  bs_close(model);
  bs_scene_free(scene);
  bs_config_free(config);
  return status;
}

struct Bench : sc_core::sc_module {
  SC_HAS_PROCESS(Bench);
  explicit Bench(const sc_core::sc_module_name& name) : sc_module(name) { SC_METHOD(run); }
  void run() {
    expect(draw("timed") == BS_OK, "timed in a process");
    expect(draw("systemc") == BS_OK, "systemc in a process");
  }
};

}  // namespace

int sc_main(int /*argc*/, char** /*argv*/) {
  const Bench bench("bench");
  expect(draw("systemc") == BS_OK, "systemc before the simulation");
  sc_core::sc_start(1, sc_core::SC_NS);
  expect(sc_core::sc_time_stamp() == sc_core::sc_time(1, sc_core::SC_NS), "the simulation's own time");
  expect(draw("systemc") == BS_OK, "systemc behind the simulation");
  return faults == 0 ? 0 : 1;
}
