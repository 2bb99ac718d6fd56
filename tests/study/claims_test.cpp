// SPDX-License-Identifier: Apache-2.0
#include "study/claims.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "tests/study/sweep_support.hpp"

namespace bitspan {
namespace {

constexpr const char* point = "0123456789abcdef0123456789abcdef";
constexpr const char* other_point = "fffffffffffffffffffffffffffffff0";

TEST(Claims, OneProgramHasAPointUntilItGivesItBackOrEnds) {
  const TemporaryFolder folder;
  const std::string file = folder.path("a.db") + "-claims";
  {
    Claims a(folder.path("a.db"));
    auto b = std::make_unique<Claims>(folder.path("a.db"));
    EXPECT_TRUE(a.take(point));
    EXPECT_FALSE(b->take(point));
    EXPECT_TRUE(b->take(other_point));
    EXPECT_FALSE(a.take(other_point));
    a.give_back(point);
    EXPECT_TRUE(b->take(point));
    b.reset();
    EXPECT_TRUE(a.take(point)) << "the other's claims end with it";
    EXPECT_TRUE(std::filesystem::exists(file)) << "the first still has it open";
    EXPECT_TRUE(Claims(folder.path("b.db")).take(point)) << "another database";
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Claims, WhereTheFileCannotBeEveryClaimSucceeds) {
  Claims a("/proc/no such folder/a.db");
  EXPECT_TRUE(a.take(point));
  a.give_back(point);
}

const std::string many = "[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 20\nto = 59\n";

TEST(Claims, TwoProgramsShareThePointsOfAStudy) {
  Bench a, b;
  b.store = std::make_unique<Store>(a.folder.path("a.db"), "1");
  const auto slow = [](const Config&) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
  a.fake.hook = slow;
  b.fake.hook = slow;
  const StudyPlan plan = sweep_plan(many + below);
  SweepResult of_b;
  std::thread other([&] { of_b = b.sweep(plan); });
  const SweepResult of_a = a.sweep(plan);
  other.join();
  EXPECT_EQ(a.fake.calls + b.fake.calls, 40) << "the base is among the points";
  EXPECT_GT(a.fake.calls, 0);
  EXPECT_GT(b.fake.calls, 0);
  EXPECT_EQ(of_a.measured + of_b.measured, 40U);
  EXPECT_EQ(of_a.known + of_a.measured, 40U);
  EXPECT_EQ(of_a.holding, of_b.holding);
  EXPECT_TRUE(of_a.finished() && of_b.finished());
  EXPECT_EQ(a.count("study_points WHERE holds"), static_cast<std::int64_t>(of_a.holding));
}

TEST(Claims, APointThatAnotherProgramMeasuresIsWaitedFor) {
  Bench b;
  const StudyPlan plan = sweep_plan(words);
  const std::string hash = b.runner().prepare({{"formats.span.h.word", std::int64_t{24}}}).hash;
  auto other = std::make_unique<Claims>(b.store->path());
  ASSERT_TRUE(other->take(hash));
  std::thread ends([&] {
    while (b.fake.calls < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    other.reset();  // it ended without a result
  });
  const SweepResult result = b.sweep(plan);
  ends.join();
  EXPECT_TRUE(result.finished());
  EXPECT_EQ(b.fake.calls, 4);
  EXPECT_EQ(text_of(b.store->rows("SELECT hash FROM points ORDER BY rowid DESC")[0][0]).size(), 32U);
}

TEST(Claims, AStopEndsTheWait) {
  Bench b;
  Claims other(b.store->path());
  ASSERT_TRUE(other.take(b.runner().prepare({{"formats.span.h.word", std::int64_t{24}}}).hash));
  std::stop_source stop;
  b.options.stop = stop.get_token();
  b.options.progress = [&](std::size_t done, std::size_t) {
    if (done == 3) stop.request_stop();
  };
  EXPECT_EQ(b.sweep(sweep_plan(words)).missing, 1U);
}

}  // namespace
}  // namespace bitspan
