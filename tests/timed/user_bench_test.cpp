// SPDX-License-Identifier: Apache-2.0
// The engine called from within a process of a user's own SystemC test bench.
#include <gtest/gtest.h>

#include <systemc>

#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

struct Bench : sc_core::sc_module {
  SC_HAS_PROCESS(Bench);
  Bench(const sc_core::sc_module_name& name, Engine* engine, const Scene* scene)
      : sc_module(name), engine_(engine), scene_(scene) {
    SC_THREAD(run);
  }
  Trace trace;
  double ended_ns = 0;

 private:
  void run() {
    wait(7, sc_core::SC_NS);
    engine_->begin(*scene_);
    for (std::size_t i = 0; i < scene_->triangles.size(); ++i) {
      engine_->draw({scene_->triangles.data() + i, 1}, static_cast<std::int64_t>(i), &trace);
      wait(3, sc_core::SC_NS);
    }
    ended_ns = sc_core::sc_time_stamp().to_seconds() * 1e9;
  }
  Engine* engine_;
  const Scene* scene_;
};

TEST(UserBench, DrawsFromWithinAThreadOfItsOwnSimulation) {
  const Config config = shipped_config("depth16");
  const Scene scene = random_scene(3, {.width = 64, .height = 48, .triangles = 5, .size_max = 30});
  const auto engine = make_systemc(config);
  Bench bench("bench", engine.get(), &scene);
  sc_core::sc_start();
  EXPECT_NEAR(bench.ended_ns, 7 + 5 * 3, 1e-6);  // the engine's clock is its own
  const auto model = make_model(config);
  Trace expected;
  model->begin(scene);
  model->draw(scene.triangles, 0, &expected);
  EXPECT_FALSE(expected.merge.empty());
  EXPECT_TRUE(bench.trace.fragment == expected.fragment);
  EXPECT_TRUE(bench.trace.merge == expected.merge);
}

}  // namespace
}  // namespace bitspan

// The leak checker takes the stack of a process of SystemC for the thread's own, and faults on what is no
// longer there.
extern "C" const char* __asan_default_options();
const char* __asan_default_options() { return "detect_leaks=0"; }

// Its own main: SystemC's library has one too, and is linked in front of GoogleTest's here.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
