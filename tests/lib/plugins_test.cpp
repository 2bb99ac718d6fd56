// SPDX-License-Identifier: Apache-2.0
// Engines of plug-ins deliver what golden does, and whatever is no plug-in of this build is refused.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "engine/records.hpp"
#include "scene/random.hpp"
#include "tests/lib/support.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

Scene small_scene(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 20;
  options.size_max = 40;
  options.width = 96;
  options.height = 72;
  return random_scene(seed, options);
}

TEST(LibPlugins, DrawWhatGoldenDraws) {
  const ConfigHandle config = config_handle("depth16");
  const Scene scene = small_scene(1);
  const Described described(scene);
  const ModelHandle golden = open_model(config.get(), "golden");
  draw(golden.get(), described);
  for (const char* engine : {"systemc", "rtl"}) {
    SCOPED_TRACE(engine);
    const ModelHandle model = open_model(config.get(), engine);
    draw(model.get(), described);
    for (bs_stage stage = 0; stage < record_types; ++stage) {
      EXPECT_TRUE(records(model.get(), stage) == records(golden.get(), stage)) << bs_stage_name(stage);
    }
    EXPECT_GT(records(model.get(), BS_STAGE_MERGE).size(), 1000U);
    EXPECT_EQ(plane<std::uint8_t>(model.get(), BS_PLANE_COLOR),
              plane<std::uint8_t>(golden.get(), BS_PLANE_COLOR));
    std::int64_t cycles = 0;
    EXPECT_EQ(bs_counter(model.get(), "cycles", &cycles), BS_OK);
    EXPECT_GT(cycles, 1000);
    EXPECT_NE(std::string(bs_run_text(model.get())).find(std::string("engine ") + engine), std::string::npos);
    EXPECT_EQ(bs_stage_override(model.get(), BS_STAGE_SPAN, nullptr, nullptr), BS_UNSUPPORTED);
  }
}

// SystemC has one simulation per process; models in different threads wait for each other.
TEST(LibPlugins, ThreadsWithAModelOfSystemcEach) {
  const ConfigHandle config = config_handle("depth16");
  const std::array scenes{small_scene(2), small_scene(3), small_scene(4), small_scene(5)};
  std::array<std::vector<std::int64_t>, 4> expected;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Described described(scenes[i]);
    const ModelHandle model = open_model(config.get(), "golden");
    draw(model.get(), described);
    expected[i] = records(model.get(), BS_STAGE_MERGE);
  }
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    threads.emplace_back([&, i] {
      const Described described(scenes[i]);
      for (int round = 0; round < 3; ++round) {
        const ModelHandle model = open_model(config.get(), "systemc");
        draw(model.get(), described);
        wrong += records(model.get(), BS_STAGE_MERGE) != expected[i] ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong.load(), 0);
}

std::string refusal(const char* engine) {
  const ConfigHandle config = config_handle("depth16");
  bs_model* model = nullptr;
  EXPECT_EQ(bs_open(config.get(), engine, &model), BS_UNSUPPORTED);
  EXPECT_EQ(model, nullptr);
  return bs_last_error();
}

TEST(LibPlugins, AForeignBuildIsRefused) {
  const Environment folder("BITSPAN_PLUGINS", build_path("tests/lib/foreign"));
  for (int again = 0; again < 2; ++again) {
    EXPECT_NE(
        refusal("rtl").find("libbitspan-rtl.so: is of build 0123456789abcdef; expected the library's, "),
        std::string::npos)
        << bs_last_error();
  }
  EXPECT_NE(refusal("systemc").find("libbitspan-systemc.so: has no bitspan_plugin; expected a plug-in"),
            std::string::npos)
      << bs_last_error();
}

TEST(LibPlugins, AMissingOrDamagedFileIsRefused) {
  const TemporaryFolder temporary;
  const Environment folder("BITSPAN_PLUGINS", temporary.path());
  EXPECT_NE(refusal("rtl").find("libbitspan-rtl.so: no such file"), std::string::npos) << bs_last_error();
  temporary.write("libbitspan-rtl.so", "no library");
  EXPECT_NE(refusal("rtl").find("expected a plug-in"), std::string::npos) << bs_last_error();
  EXPECT_STREQ(bs_engine_name(4), "rtl");
  EXPECT_EQ(bs_engine_name(5), nullptr);
}

}  // namespace
}  // namespace bitspan
