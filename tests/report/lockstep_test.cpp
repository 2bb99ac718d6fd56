// SPDX-License-Identifier: Apache-2.0
// Engines in step: a broken one is found, by value and by exception, and the run ends soon after.
#include "report/lockstep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "model/engine_model.hpp"
#include "scene/random.hpp"
#include "tests/support/cut.hpp"
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

TEST(LockStep, PiecesAreTheWhole) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RandomOptions random;
    random.triangles = 40;
    random.size_max = 60;
    random.command_probability = 0.4;
    const Scene s = random_scene(seed, random);
    const Config c = config();
    const auto run = [&](const NextPiece& next, std::vector<Trace>& seen, Frame& frame) {
      std::vector<std::unique_ptr<Engine>> engines;
      for (int i = 0; i < 2; ++i) engines.push_back(make_model(c));
      Scene begun = s;
      begun.triangles.clear();
      begun.commands.clear();
      LockStepOptions options;
      options.batch_triangles = 1;
      options.observe = [&](const Batch& batch, const Trace& trace) {
        EXPECT_EQ(batch.first_index, static_cast<std::int64_t>(seen.size()));
        seen.push_back(trace);
      };
      const LockStepResult result = run_lock_step(engines, begun, next, options);
      EXPECT_TRUE(result.pairs[0].held());
      EXPECT_EQ(result.triangles_done, s.triangles.size());
      frame = engines[0]->frame();
      return result;
    };
    std::vector<Trace> whole, pieces;
    Frame whole_frame, pieces_frame;
    const LockStepResult a = run(Cut(s, s.triangles.size()), whole, whole_frame);
    const LockStepResult b = run(Cut(s, 7), pieces, pieces_frame);
    EXPECT_EQ(a.records, b.records);
    EXPECT_EQ(a.pairs[0].total().values, b.pairs[0].total().values);
    EXPECT_EQ(whole_frame.color, pieces_frame.color) << "seed " << seed;
    ASSERT_EQ(whole.size(), pieces.size());
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (int t = 0; t < record_types; ++t) {
        const RecordView x = view_of(whole[i], static_cast<RecordType>(t));
        const RecordView y = view_of(pieces[i], static_cast<RecordType>(t));
        ASSERT_EQ(x.records, y.records);
        EXPECT_TRUE(std::equal(x.values, x.values + x.records * x.fields.size(), y.values));
      }
    }
  }
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
