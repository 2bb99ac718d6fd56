// SPDX-License-Identifier: Apache-2.0
// Engines in step: a broken one is found, by value and by exception, and the run ends soon after.
#include "report/lockstep.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "model/engine_model.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"
#include "tests/support/wrapped_engine.hpp"

namespace bitspan {
namespace {

// The model, with one record changed on its way out.
class BrokenEngine : public WrappedEngine {
 public:
  enum class Fault { none, fragment, lost_span, throws };
  BrokenEngine(const Config& config, std::int64_t triangle, Fault fault)
      : WrappedEngine(make_model(config)), triangle_(triangle), fault_(fault) {}
  std::string_view name() const override { return "broken"; }
  void draw(std::span<const Triangle> triangles, std::int64_t first, Trace* trace) override {
    WrappedEngine::draw(triangles, first, trace);
    const bool mine = first <= triangle_ && triangle_ < first + static_cast<std::int64_t>(triangles.size());
    if (!mine || trace == nullptr) {
      return;
    }
    if (fault_ == Fault::throws) {
      throw std::logic_error("assertion failed");
    }
    for (FragmentRecord& f : trace->fragment) {
      if (fault_ == Fault::fragment && f.triangle >= triangle_) {
        f.v += 1;
        break;
      }
    }
    if (fault_ == Fault::lost_span && !trace->span.empty()) {
      trace->span.erase(trace->span.begin());
    }
  }

 private:
  std::int64_t triangle_;
  Fault fault_;
};

Config config() { return shipped_config("depth16"); }

Scene scene() {
  RandomOptions options;
  options.triangles = 60;
  options.size_max = 100;
  return random_scene(11, options);
}

LockStepResult run(BrokenEngine::Fault fault, std::size_t batch = 8) {
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(make_model(config()));
  engines.push_back(std::make_unique<BrokenEngine>(config(), 17, fault));
  const Scene s = scene();
  LockStepOptions options;
  options.batch_triangles = batch;
  return run_lock_step(engines, s, options);
}

TEST(LockStep, EqualEnginesHoldWhateverTheBatch) {
  const LockStepResult small = run(BrokenEngine::Fault::none, 1);
  const LockStepResult large = run(BrokenEngine::Fault::none, 1000);
  EXPECT_TRUE(small.pairs[0].held());
  EXPECT_EQ(small.triangles_done, 60U);
  EXPECT_GT(small.pairs[0].total().non_trivial, 1000U);
  EXPECT_EQ(small.pairs[0].total().values, large.pairs[0].total().values);
  EXPECT_EQ(small.pairs[0].total().non_trivial, large.pairs[0].total().non_trivial);
}

TEST(LockStep, OneWrongBitIsFoundAndEndsTheRun) {
  const LockStepResult result = run(BrokenEngine::Fault::fragment);
  ASSERT_TRUE(result.pairs[0].first);
  EXPECT_EQ(result.pairs[0].first->stage, "span");
  EXPECT_EQ(result.pairs[0].first->field, "v");
  EXPECT_EQ(result.pairs[0].differences(), 1U);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.triangles_done, 24U);
}

TEST(LockStep, ALostRecordIsFound) {
  const LockStepResult result = run(BrokenEngine::Fault::lost_span);
  ASSERT_TRUE(result.pairs[0].first);
  EXPECT_EQ(result.pairs[0].first->stage, "span_setup");
  EXPECT_EQ(result.pairs[0].first->kind, DivergenceKind::missing);
}

TEST(LockStep, AnEngineThatBreaksOffIsAtFault) {
  const LockStepResult result = run(BrokenEngine::Fault::throws);
  EXPECT_FALSE(result.pairs[0].held());
  EXPECT_EQ(result.pairs[0].fault, "assertion failed");
  EXPECT_TRUE(result.stopped);
}

TEST(LockStep, BatchesCoverTheSceneInOrder) {
  const Scene s = scene();
  LockStepOptions options;
  options.batch_pixels = 1;  // a triangle each
  std::size_t done = 0;
  while (done < s.triangles.size()) {
    const std::size_t n = next_batch(s, done, options);
    ASSERT_GE(n, 1U);
    done += n;
  }
  EXPECT_EQ(done, s.triangles.size());
}

}  // namespace
}  // namespace bitspan
