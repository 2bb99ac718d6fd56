// SPDX-License-Identifier: Apache-2.0
// Memory that runs out at any allocation of a run: the call fails, the library does not.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

#include "bitspan/bitspan.h"

namespace {
// Allocations of this thread that may still succeed; negative: all.
thread_local long allowance = -1;
}  // namespace

// The library takes the program's. Aligned forms stay the compiler's. Inlined ones GCC takes for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (allowance == 0) throw std::bad_alloc();
  if (allowance > 0) --allowance;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*nothrow*/) noexcept {
  return allowance == 0 ? nullptr : std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace bitspan {
namespace {

// A short run; returns the first status that is not BS_OK.
bs_status run(bs_config* config, const char* engine) {
  bs_model* model = nullptr;
  bs_status status = bs_open(config, engine, &model);
  bs_scene_desc scene = BS_SCENE_DESC_INIT;
  scene.width = 32;
  scene.height = 24;
  bs_vertex v[3] = {BS_VERTEX_INIT, BS_VERTEX_INIT, BS_VERTEX_INIT};
  v[1].x = 30;
  v[2].y = 20;
  if (status == BS_OK) status = bs_begin(model, &scene);
  if (status == BS_OK) status = bs_triangle(model, v, -1, 0, 0);
  bs_view view{};
  view.size = sizeof view;
  if (status == BS_OK) status = bs_records(model, BS_STAGE_SPAN, &view);
  if (status == BS_OK && std::string(engine) != "ideal" && view.rows < 100) status = BS_INTERNAL;
  bs_close(model);
  return status;
}

void starve(const char* engine) {
  bs_config* config = nullptr;
  ASSERT_EQ(bs_config_load("depth16", &config), BS_OK);
  ASSERT_EQ(run(config, engine), BS_OK) << bs_last_error();  // what is made once is there
  long failures = 0;
  for (long n = 0;; n += 1 + n / 20) {
    allowance = n;
    const bs_status status = run(config, engine);
    allowance = -1;
    if (status == BS_OK) break;
    ++failures;
    ASSERT_EQ(status, BS_NO_MEMORY) << "after " << n << " allocations: " << bs_last_error();
    ASSERT_STRNE(bs_last_error(), "");
  }
  EXPECT_GT(failures, 20) << engine;
  EXPECT_EQ(run(config, engine), BS_OK) << bs_last_error();
  bs_config_free(config);
}

TEST(LibMemory, RunsOutInGolden) { starve("golden"); }
TEST(LibMemory, RunsOutInTheModel) { starve("model"); }
TEST(LibMemory, RunsOutInTheTimedModel) { starve("timed"); }

// Not where TOML is read: toml++ allocates in functions that may not throw.
TEST(LibMemory, RunsOutInSettingAKey) {
  bs_config* config = nullptr;
  ASSERT_EQ(bs_config_load("depth16", &config), BS_OK);
  const std::string hash = bs_config_hash(config);
  for (long n = 0;; ++n) {
    allowance = n;
    const bs_status status = bs_config_set(config, "formats.span.uv.word", "24");
    allowance = -1;
    if (status == BS_OK) break;
    ASSERT_EQ(status, BS_NO_MEMORY) << bs_last_error();
    ASSERT_EQ(bs_config_hash(config), hash);
  }
  EXPECT_NE(bs_config_hash(config), hash);
  bs_config_free(config);
}

}  // namespace
}  // namespace bitspan
