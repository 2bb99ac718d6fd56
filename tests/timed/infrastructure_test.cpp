// SPDX-License-Identifier: Apache-2.0
// The parts of the timed model that have no SystemC in them: FIFO, cache, memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <list>
#include <random>
#include <tuple>
#include <vector>

#include "model/timed/cache.hpp"
#include "model/timed/fifo.hpp"
#include "model/timed/memory.hpp"

namespace bitspan::timed {
namespace {

// One producer, one consumer, always willing; returns the clocks until n records have passed.
std::uint64_t clocks_to_pass(int capacity, int n, bool consumer_first) {
  Fifo<int> fifo(capacity);
  int pushed = 0;
  int popped = 0;
  std::uint64_t now = 0;
  for (; popped < n; ++now) {
    const auto produce = [&] {
      if (pushed < n && fifo.can_push(now)) fifo.push(now) = pushed++;
    };
    const auto consume = [&] {
      if (!fifo.can_pop(now)) return;
      EXPECT_EQ(fifo.front(), popped);
      fifo.pop(now);
      ++popped;
    };
    if (consumer_first) {
      consume();
      produce();
    } else {
      produce();
      consume();
    }
  }
  return now;
}

TEST(Fifo, PassesARecordAClockFromCapacityTwoOn) {
  for (const bool consumer_first : {false, true}) {
    EXPECT_EQ(clocks_to_pass(1, 100, consumer_first), 200U);  // push at 0, pop at 1, push at 2 ...
    EXPECT_EQ(clocks_to_pass(2, 100, consumer_first), 101U);
    EXPECT_EQ(clocks_to_pass(3, 100, consumer_first), 101U);
  }
}

TEST(Fifo, EqualsTheRegisteredReferenceWhateverTheOrderOfEvaluation) {
  std::mt19937 random(7);
  for (int capacity = 1; capacity <= 6; ++capacity) {
    Fifo<std::uint32_t> fifo(capacity);
    std::deque<std::uint32_t> reference;  // as of the start of the clock
    std::size_t high_water = 0;
    for (std::uint64_t now = 0; now < 5000; ++now) {
      const std::size_t before = reference.size();
      high_water = std::max(high_water, before);
      const bool wants_push = random() % 3 != 0;
      const bool wants_pop = random() % 2 != 0;
      const std::uint32_t value = static_cast<std::uint32_t>(random());
      const auto push = [&] {
        ASSERT_EQ(fifo.can_push(now), before < static_cast<std::size_t>(capacity));
        if (wants_push && fifo.can_push(now)) fifo.push(now) = value;
      };
      const auto pop = [&] {
        ASSERT_EQ(fifo.can_pop(now), before > 0);
        if (!wants_pop || !fifo.can_pop(now)) return;
        ASSERT_EQ(fifo.front(), reference.front());
        fifo.pop(now);
      };
      if (random() % 2 == 0) {
        push();
        pop();
      } else {
        pop();
        push();
      }
      if (wants_pop && before > 0) reference.pop_front();
      if (wants_push && before < static_cast<std::size_t>(capacity)) reference.push_back(value);
    }
    EXPECT_EQ(high_water, static_cast<std::size_t>(capacity));
  }
}

TEST(Cache, EqualsANaiveReference) {
  std::mt19937 random(3);
  for (const auto& [line, sets, ways] :
       {std::tuple{64, 64, 2}, {1, 1, 1}, {4, 1, 4}, {16, 8, 1}, {32, 3, 5}, {8, 5, 2}}) {
    Cache cache({line, sets, ways});
    std::vector<std::list<std::uint64_t>> reference(static_cast<std::size_t>(sets));  // most recent first
    std::uint64_t misses = 0;
    const int accesses = 20000;
    std::uint64_t address = 0;
    for (int i = 0; i < accesses; ++i) {
      // Walks with jumps, so that there are hits and misses.
      address = random() % 4 == 0 ? random() % 20000 : address + random() % 8;
      const std::uint64_t number = address / static_cast<std::uint64_t>(line);
      auto& set = reference[number % static_cast<std::uint64_t>(sets)];
      const auto found = std::ranges::find(set, number);
      const bool hit = found != set.end();
      if (hit) set.erase(found);
      set.push_front(number);
      if (set.size() > static_cast<std::size_t>(ways)) set.pop_back();
      misses += hit ? 0 : 1;
      ASSERT_EQ(cache.access(address), hit) << "access " << i;
    }
    EXPECT_EQ(cache.misses(), misses);
    EXPECT_EQ(cache.hits(), accesses - misses);
    EXPECT_GT(cache.misses(), 0U);
    EXPECT_GT(cache.hits(), 0U);
  }
}

// Clocks memory and asker by hand: the clock on which a read asked for at `asked` is seen as answered.
std::uint64_t answer_clock(Memory& memory, Memory::Port port, std::uint64_t ticket, std::uint64_t& now) {
  while (!memory.answered(port, ticket, now)) {
    memory.clock(now);
    ++now;
    if (now > 100000) return now;
  }
  return now;
}

TEST(Memory, AnswersAfterTheRequestRegisterTheLatencyAndTheBeats) {
  for (const int latency : {1, 2, 20}) {
    for (const int width : {1, 4, 8, 64, 100}) {
      Memory memory({.latency = latency, .width_bytes = width});
      std::uint64_t now = 5;
      const auto ticket = memory.read(Memory::Port::texture, 64, now);
      const int beats = (64 + width - 1) / width;
      EXPECT_EQ(answer_clock(memory, Memory::Port::texture, ticket, now),
                static_cast<std::uint64_t>(5 + 1 + latency + beats - 1));
      EXPECT_EQ(memory.report().beats, static_cast<std::uint64_t>(beats));
      EXPECT_TRUE(memory.idle());
    }
  }
}

TEST(Memory, StreamsAtTheBusWidthAndServesDownstreamFirst) {
  Memory memory({.latency = 10, .width_bytes = 8});
  std::uint64_t depth = 0;
  std::uint64_t merge_writes = 0;
  std::uint64_t depth_reads_while_merge_wrote = 0;
  for (std::uint64_t now = 0; now < 200; ++now) {
    if (now < 100 && memory.can_request(Memory::Port::merge, now)) {
      memory.write(Memory::Port::merge, 8, now);
      ++merge_writes;
    }
    if (memory.can_request(Memory::Port::depth, now)) depth = memory.read(Memory::Port::depth, 8, now);
    memory.clock(now);
    if (now == 100) depth_reads_while_merge_wrote = depth;
  }
  EXPECT_EQ(merge_writes, 100U);  // one per clock: the bus is never the limit for the first port
  EXPECT_EQ(depth_reads_while_merge_wrote, 2U);  // its request FIFO is full and waits
  EXPECT_GE(depth, 98U);                         // then a read a clock
  EXPECT_EQ(memory.report().writes, merge_writes);
  EXPECT_EQ(memory.report().reads, depth);
}

TEST(WordRegister, AsksOncePerWord) {
  WordRegister word({.width_bytes = 8}, 2);
  int asked = 0;
  for (std::uint64_t x = 0; x < 64; ++x) asked += word.access(2 * x) ? 1 : 0;
  EXPECT_EQ(asked, 16);
  EXPECT_TRUE(word.access(0));
  EXPECT_FALSE(word.access(6));
  WordRegister wide({.width_bytes = 1}, 4);  // an access wider than the bus is a word of its own
  EXPECT_EQ(wide.word_bytes(), 4U);
  EXPECT_TRUE(wide.access(0));
  EXPECT_FALSE(wide.access(0));
  EXPECT_TRUE(wide.access(4));
}

}  // namespace
}  // namespace bitspan::timed
