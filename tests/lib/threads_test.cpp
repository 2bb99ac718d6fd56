// SPDX-License-Identifier: Apache-2.0
// Handles come and go without a trace, and different ones work at the same time.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "scene/random.hpp"
#include "tests/lib/support.hpp"

namespace bitspan {
namespace {

Scene scene_of(std::uint64_t seed) {
  RandomOptions options;
  options.triangles = 10;
  options.size_max = 40;
  options.width = 64;
  options.height = 48;
  return random_scene(seed, options);
}

TEST(LibHandles, OpenAndClose10000Times) {
  const ConfigHandle config = config_handle("depth16");
  std::array<bs_model*, 4> last{};
  for (int i = 0; i < 10000; ++i) {
    bs_model* model = nullptr;
    ASSERT_EQ(bs_open(config.get(), bs_engine_name(i % 4), &model), BS_OK) << bs_last_error();
    for (const bs_model* old : last) ASSERT_NE(old, model) << "a handle is given twice";
    last[static_cast<std::size_t>(i % 4)] = model;
    bs_close(model);
  }
  for (int i = 0; i < 10000; ++i) {
    bs_config* c = nullptr;
    ASSERT_EQ(bs_config_load("no such name", &c), BS_BAD_INPUT);
  }
}

// Draws 200 pictures in turn and compares each with the first.
TEST(LibHandles, AModelDrawsAgainAndAgain) {
  const ConfigHandle config = config_handle("depth20");
  const ModelHandle model = open_model(config.get(), "model");
  const std::array scenes{scene_of(1), scene_of(2)};
  const std::array<Described, 2> described{Described(scenes[0]), Described(scenes[1])};
  std::array<std::vector<std::int64_t>, 2> first;
  for (std::size_t i = 0; i < 200; ++i) {
    draw(model.get(), described[i % 2]);
    if (i < 2) first[i] = records(model.get(), BS_STAGE_MERGE);
    ASSERT_TRUE(records(model.get(), BS_STAGE_MERGE) == first[i % 2]) << i;
  }
}

TEST(LibHandles, TenThreadsWithAHandleEach) {
  const ConfigHandle config = config_handle("depth16");
  const std::array<const char*, 3> engines{"golden", "model", "timed"};
  std::vector<std::vector<std::int64_t>> expected;
  std::vector<Scene> scenes;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    scenes.push_back(scene_of(seed));
    const Described described(scenes.back());
    const ModelHandle model = open_model(config.get(), "golden");
    draw(model.get(), described);
    expected.push_back(records(model.get(), BS_STAGE_MERGE));
  }
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 10; ++t) {
    threads.emplace_back([&, t] {
      const Described described(scenes[t]);
      bs_model* model = nullptr;
      if (bs_open(config.get(), engines[t % 3], &model) != BS_OK) ++wrong;
      bs_view view{};
      view.size = sizeof view;
      for (int round = 0; round < 10; ++round) {
        wrong += bs_begin(model, &described.desc) != BS_OK;
        wrong += bs_draw(model, described.vertices.data(), described.texture_of.data(),
                         described.texture_of.size(), 0, 0) != BS_OK;
        wrong += bs_records(model, BS_STAGE_MERGE, &view) != BS_OK;
        const auto* const values = static_cast<const std::int64_t*>(view.base);
        wrong += std::vector<std::int64_t>(values, values + view.rows * view.columns) != expected[t];
        // Each thread has a last error of its own.
        const std::string name = "no-engine-" + std::to_string(t);
        bs_model* none = nullptr;
        wrong += bs_open(config.get(), name.c_str(), &none) != BS_BAD_INPUT;
        wrong += std::string(bs_last_error()).find(name) == std::string::npos;
      }
      bs_close(model);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong.load(), 0);
}

TEST(LibHandles, TheLastErrorIsTheThreadsOwn) {
  bs_model* model = nullptr;
  EXPECT_EQ(bs_open(nullptr, "model", &model), BS_BAD_HANDLE);
  const std::string own = bs_last_error();
  std::string at_first;
  std::string other;
  std::thread([&] {
    at_first = bs_last_error();
    bs_close(nullptr);
    static_cast<void>(bs_trace(nullptr, 1));
    other = bs_last_error();
  }).join();
  EXPECT_EQ(at_first, "");
  EXPECT_NE(other, own);
  EXPECT_EQ(bs_last_error(), own);
}

// Threads that share a handle against the rule get BS_BUSY or their turn, and a close amid a call is
// harmless.
TEST(LibHandles, OneHandleInManyThreadsIsRefused) {
  const ConfigHandle config = config_handle("depth16");
  const Scene scene = scene_of(3);
  const Described described(scene);
  for (int round = 0; round < 5; ++round) {
    bs_model* const model = open_model(config.get(), "model").release();
    std::atomic<int> bad{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 20; ++i) {
          const bs_status begun = bs_begin(model, &described.desc);
          const bs_status drawn = bs_draw(model, described.vertices.data(), nullptr, 10, 0, 0);
          for (const bs_status status : {begun, drawn}) {
            bad += status != BS_OK && status != BS_BUSY && status != BS_BAD_ORDER && status != BS_BAD_HANDLE;
          }
        }
      });
    }
    bs_close(model);
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(bad.load(), 0);
  }
}

}  // namespace
}  // namespace bitspan
