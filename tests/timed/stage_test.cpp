// SPDX-License-Identifier: Apache-2.0
// Latency, interval, FIFOs, stall reasons and memory of the clocked stages, counted by hand; no SystemC, no
// model.
#include "model/timed/stage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "model/timed/walk.hpp"

namespace bitspan::timed {
namespace {

struct Item {
  int number = 0;
};

class PlainStage : public PipeStage<Item> {
 public:
  using PipeStage::PipeStage;
  std::set<int> dropped;  // numbers that end here

 private:
  bool enters(Item& item) override { return !dropped.contains(item.number); }
};

// A producer that always offers, one stage, a consumer that takes where `ready` says so.
struct Bench {
  Pool<Item> pool;
  Fifo<Item*> in;
  Fifo<Item*> out{2};
  PlainStage stage;
  std::uint64_t now = 0;
  int offered = 0;
  int offer_limit = 1 << 30;
  std::vector<int> popped_at;  // clock the consumer took a record on
  std::vector<int> numbers;

  explicit Bench(const StageTiming& timing) : in(timing.fifo), stage("stage", timing, in, &out, pool) {}

  template <class Ready>
  void run(int clocks, Ready ready) {
    for (int i = 0; i < clocks; ++i, ++now) {
      if (offered < offer_limit && in.can_push(now)) {
        Item* item = pool.get();
        item->number = offered++;
        in.push(now) = item;
      }
      stage.clock(now);
      if (out.can_pop(now) && ready(now)) {
        popped_at.push_back(static_cast<int>(now));
        numbers.push_back(out.front()->number);
        pool.put(out.front());
        out.pop(now);
      }
    }
  }
  const StageReport& report() { return stage.meters().front()->report; }
};

TEST(PipeStage, LatencyAndIntervalByHand) {
  // Offered at 0, accepted at 1, delivered at 1 + L, popped by the consumer at 2 + L; then every max(I, 1)
  // clocks.
  for (const int latency : {1, 2, 3, 7}) {
    for (const int interval : {1, 2, 3, 10}) {
      Bench bench({.latency = latency, .interval = interval, .fifo = 2});
      bench.run(100, [](auto) { return true; });
      ASSERT_GT(bench.popped_at.size(), 8U);
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(bench.popped_at[i], 2 + latency + static_cast<int>(i) * interval)
            << "latency " << latency << " interval " << interval << " record " << i;
      }
    }
  }
}

TEST(PipeStage, AFifoOfOneHalvesTheThroughput) {
  Bench bench({.latency = 3, .interval = 1, .fifo = 1});
  bench.run(50, [](auto) { return true; });
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(bench.popped_at[i], 5 + 2 * static_cast<int>(i));
}

TEST(PipeStage, StatesByHand) {
  // L = 2: offered at 0, accepted at 1, delivered at 3; nothing else ever comes.
  Bench bench({.latency = 2, .interval = 1, .fifo = 2});
  bench.offer_limit = 1;
  bench.run(10, [](auto) { return true; });
  EXPECT_EQ(bench.report().busy, 1U);
  EXPECT_EQ(bench.report().starved, 9U);
  EXPECT_EQ(bench.report().blocked, 0U);

  // A consumer that never takes: 1 and 2 deliver into the output FIFO, then the stage fills and stands.
  Bench stuck({.latency = 1, .interval = 1, .fifo = 2});
  stuck.run(20, [](auto) { return false; });
  // Accepts at 1, 2, 3 (delivers at 2, 3 to the FIFO of 2); the third stands from 4 on.
  EXPECT_EQ(stuck.report().records_in, 3U);
  EXPECT_EQ(stuck.report().records_out, 2U);
  EXPECT_EQ(stuck.report().starved, 1U);
  EXPECT_EQ(stuck.report().busy, 3U);
  EXPECT_EQ(stuck.report().blocked, 16U);
  EXPECT_EQ(stuck.report().fifo_high_water, 2U);
}

TEST(PipeStage, KeepsOrderAndDropsOnlyWhatEnds) {
  Bench bench({.latency = 4, .interval = 1, .fifo = 3});
  bench.offer_limit = 300;
  for (int i = 0; i < 300; i += 3) bench.stage.dropped.insert(i);
  bench.run(2000, [](std::uint64_t now) { return now % 5 < 2; });
  ASSERT_EQ(bench.numbers.size(), 200U);
  int expected = 0;
  for (const int number : bench.numbers) {
    while (bench.stage.dropped.contains(expected)) ++expected;
    EXPECT_EQ(number, expected++);
  }
  EXPECT_EQ(bench.report().records_in, 300U);
  EXPECT_EQ(bench.report().records_out, 200U);
  EXPECT_EQ(bench.pool.in_use(), 0U);
  EXPECT_TRUE(bench.stage.idle());
  const StageReport& r = bench.report();
  EXPECT_EQ(r.busy + r.starved + r.blocked + r.memory, 2000U);
}

TEST(PipeStage, FewerReadyClocksNeverEndEarlier) {
  int previous = 0;
  for (const std::uint64_t period : {1U, 2U, 3U, 5U, 9U}) {
    Bench bench({.latency = 3, .interval = 1, .fifo = 2});
    bench.offer_limit = 100;
    bench.run(1500, [&](std::uint64_t now) { return now % period == 0; });
    ASSERT_EQ(bench.popped_at.size(), 100U);
    EXPECT_GE(bench.popped_at.back(), previous);
    previous = bench.popped_at.back();
  }
}

// One read an item.
class ReadingStage : public PipeStage<Item> {
 public:
  using PipeStage::PipeStage;
  int reads_per_item = 1;

 private:
  bool enters(Item&) override {
    static constexpr std::array<Access, 3> accesses{{{8, true}, {8, true}, {8, true}}};
    ask(accesses, static_cast<Asks>((1U << reads_per_item) - 1));
    return true;
  }
};

std::vector<int> delivery_clocks(int memory_latency, int width, int reads_per_item, StageReport* report) {
  const MemoryTiming timing{.latency = memory_latency, .width_bytes = width};
  Memory memory(timing);
  Pool<Item> pool;
  Fifo<Item*> in(2);
  Fifo<Item*> out(2);
  ReadingStage stage("stage", {.latency = 1, .interval = 1, .fifo = 2}, in, &out, pool, &memory,
                     Memory::Port::depth, memory_latency);
  stage.reads_per_item = reads_per_item;
  std::vector<int> clocks;
  for (std::uint64_t now = 0; now < 400; ++now) {
    if (in.can_push(now)) in.push(now) = pool.get();
    stage.clock(now);
    memory.clock(now);
    if (out.can_pop(now)) {
      clocks.push_back(static_cast<int>(now));
      pool.put(out.front());
      out.pop(now);
    }
  }
  *report = stage.meters().front()->report;
  return clocks;
}

TEST(PipeStage, MemoryLatencyDelaysAndBandwidthLimits) {
  StageReport report;
  // Accepted and asked at 1, taken at 2, answered at 2 + 10, popped at 13; then one per clock: latency is
  // hidden.
  auto clocks = delivery_clocks(10, 8, 1, &report);
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(clocks[i], 13 + static_cast<int>(i));
  EXPECT_EQ(report.busy + report.starved + report.blocked + report.memory, 400U);
  // Two beats a read: one in two clocks.
  clocks = delivery_clocks(10, 4, 1, &report);
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(clocks[i], 14 + 2 * static_cast<int>(i));
  EXPECT_NEAR(static_cast<double>(report.busy), 200, 12);  // every second clock a start
  EXPECT_NEAR(static_cast<double>(report.memory), 200, 14);
  // Three reads an item, one beat each: one in three clocks; the last of the first item's is asked at 3.
  clocks = delivery_clocks(10, 8, 3, &report);
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(clocks[i], 15 + 3 * static_cast<int>(i));
}

// A triangle of `index` rows, of which every second one has a record.
struct CountingWalk {
  std::int64_t left = 0;
  void start(TriangleItem& item) { left = item.index; }
  bool finished() const { return left == 0; }
  bool row(RowItem& row) {
    row.count = left--;
    return row.count % 2 == 0;
  }
};

TEST(WalkStage, ARowEachIntervalAndATriangleWithoutRowsTakesOne) {
  for (const int interval : {1, 2, 5}) {
    Pool<TriangleItem> triangles;
    Pool<RowItem> rows;
    Fifo<TriangleItem*> in(4);
    Fifo<RowItem*> out(2);
    WalkStage<CountingWalk> stage("walk", {.latency = 3, .interval = interval, .fifo = 4}, in, out, triangles,
                                  rows, {});
    const std::vector<std::int64_t> heights{4, 0, 3};
    std::size_t next = 0;
    std::vector<int> clocks;
    for (std::uint64_t now = 0; now < 100; ++now) {
      if (next < heights.size() && in.can_push(now)) {
        TriangleItem* item = triangles.get();
        item->index = heights[next++];
        in.push(now) = item;
      }
      stage.clock(now);
      if (out.can_pop(now)) {
        clocks.push_back(static_cast<int>(now));
        rows.put(out.front());
        out.pop(now);
      }
    }
    // Rows are walked at 1 + n I; row 0 and 2 of the first triangle and row 1 of the third have records, the
    // second triangle takes the fifth interval. Popped L + 1 later.
    const int i = interval;
    EXPECT_EQ(clocks, (std::vector<int>{5, 5 + 2 * i, 5 + 6 * i}));
    EXPECT_EQ(triangles.in_use(), 0U);
    EXPECT_TRUE(stage.idle());
    const StageReport& r = stage.meters().front()->report;
    EXPECT_EQ(r.records_in, 3U);
    EXPECT_EQ(r.records_out, 3U);
    EXPECT_EQ(r.busy + r.starved + r.blocked, 100U);
  }
}

}  // namespace
}  // namespace bitspan::timed
