// SPDX-License-Identifier: Apache-2.0
// The caches of the timed model: their counters against a replay of the access log by a cache that is written
// otherwise, the log against the records, the memory traffic by hand, and the tables of docs/timing.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <list>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/config.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"
#include "tests/timed/square_half.hpp"

namespace bitspan {
namespace {

// A list per set with the line used last in front, and one list for all.
class ReplayedCache {
 public:
  ReplayedCache(int line_bytes, int sets, int ways, SetHash hash, bool write_back)
      : line_bits_(std::countr_zero(static_cast<unsigned>(line_bytes))),
        set_bits_(std::countr_zero(static_cast<unsigned>(sets))),
        ways_(static_cast<std::size_t>(ways)),
        xors_(hash == SetHash::xor_upper),
        write_back_(write_back),
        sets_(static_cast<std::size_t>(sets)) {}

  CacheReport report;

  // What the log should say of the access.
  CacheAccess see(const CacheAccess& access) {
    CacheAccess out{.cache = access.cache, .kind = access.kind, .address = access.address};
    if (access.kind == CacheAccessKind::flush) {
      report.flushed += written_lines();
      for (auto& set : sets_) set.clear();
      all_.clear();
      ever_.clear();
      return out;
    }
    const bool is_write = access.kind == CacheAccessKind::write;
    ++(is_write ? report.writes : report.reads);
    const std::uint64_t line = access.address >> line_bits_;
    const std::uint64_t mask = (std::uint64_t{1} << set_bits_) - 1;
    auto& set = sets_[(xors_ ? (line & mask) ^ ((line >> set_bits_) & mask) : line & mask)];
    const auto found = std::ranges::find(set, line, &Line::number);
    const bool allocates = write_back_ || !is_write;
    const auto in_all = std::ranges::find(all_, line);
    const bool one_set_hits = in_all != all_.end();
    if (found != set.end()) {
      set.splice(set.begin(), set, found);
      out.result = CacheResult::hit;
    } else {
      out.result = !ever_.contains(line) ? CacheResult::compulsory
                   : one_set_hits        ? CacheResult::conflict
                                         : CacheResult::capacity;
      if (allocates) {
        set.push_front({line, false});
        if (set.size() > ways_) {
          out.writes_back = set.back().written;
          set.pop_back();
        }
      }
    }
    if (is_write && write_back_) set.front().written = true;
    if (one_set_hits) {
      all_.splice(all_.begin(), all_, in_all);
    } else if (allocates) {
      all_.push_front(line);
      if (all_.size() > ways_ * sets_.size()) all_.pop_back();
    }
    if (allocates) ever_.insert(line);
    ++report.results[static_cast<std::size_t>(out.result)];
    report.written_back += out.writes_back ? 1 : 0;
    return out;
  }
  std::uint64_t written_lines() const {
    std::uint64_t n = 0;
    for (const auto& set : sets_) n += static_cast<std::uint64_t>(std::ranges::count_if(set, &Line::written));
    return n;
  }

 private:
  struct Line {
    std::uint64_t number = 0;
    bool written = false;
  };
  int line_bits_, set_bits_;
  std::size_t ways_;
  bool xors_, write_back_;
  std::vector<std::list<Line>> sets_;
  std::list<std::uint64_t> all_;
  std::set<std::uint64_t> ever_;
};

using Logs = std::map<std::string, std::vector<CacheAccess>, std::less<>>;

struct CachedRun {
  Logs logs;
  TimedReport report;
  Trace trace;
};
CachedRun run_of(const Config& config, const Scene& scene, TimedMode mode, bool with_trace = true) {
  CachedRun out;
  const auto engine = make_systemc(
      config, {.mode = mode, .measure_texture_cache = true, .watch_caches = [&](const CacheAccess& access) {
                 out.logs[std::string(access.cache)].push_back(access);
               }});
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), with_trace ? &out.trace : nullptr);
  out.report = engine->report();
  return out;
}

bool same(const CacheAccess& a, const CacheAccess& b) {
  return a.kind == b.kind && a.address == b.address && a.result == b.result && a.writes_back == b.writes_back;
}
bool same(const std::vector<CacheAccess>& a, const std::vector<CacheAccess>& b) {
  return std::ranges::equal(a, b, [](const CacheAccess& x, const CacheAccess& y) { return same(x, y); });
}

ReplayedCache replayed_cache(const MemoryTiming& m, std::string_view name) {
  if (name == "texture") return {m.cache_line_bytes, m.cache_sets, m.cache_ways, m.cache_hash, false};
  const BufferCache& c = name == "depth" ? m.depth_cache : m.color_cache;
  return {c.line_bytes, c.sets, c.ways, c.hash, c.mode == BufferCacheMode::write_back};
}

BufferCache random_cache(Random& random, int width) {
  return {.mode = static_cast<BufferCacheMode>(random.integer(1, 2)),
          .line_bytes = std::max(width, 4 << random.integer(0, 5)),
          .sets = 1 << random.integer(0, 5),
          .ways = static_cast<int>(random.integer(1, 4)),
          .hash = random.chance(0.5) ? SetHash::none : SetHash::xor_upper};
}

TEST(Caches, CountersEqualAReplayOfTheAccessLog) {
  std::map<std::string, CacheReport> all;
  std::uint64_t flushes = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Config config = shipped_config(seed % 3 == 0 ? "depth20" : seed % 3 == 1 ? "depth16" : "narrow");
    config.perspective = all_perspectives[seed / 3 % 4];
    config.filter = random.chance(0.5) ? TextureFilter::nearest : TextureFilter::bilinear;
    MemoryTiming& memory = config.memory;
    memory.latency = static_cast<int>(random.integer(1, 60));
    memory.width_bytes = 1 << random.integer(0, 6);
    memory.cache_line_bytes = std::max(memory.width_bytes, 4 << random.integer(0, 4));
    memory.cache_sets = 1 << random.integer(0, 5);
    memory.cache_ways = static_cast<int>(random.integer(1, 4));
    memory.cache_hash = random.chance(0.5) ? SetHash::none : SetHash::xor_upper;
    memory.depth_cache = random_cache(random, memory.width_bytes);
    memory.color_cache = random_cache(random, memory.width_bytes);
    ASSERT_FALSE(first_violation(config).has_value());
    const Scene scene = random_scene(seed, {.width = 40,
                                            .height = 30,
                                            .triangles = 40,
                                            .size_min = 4,
                                            .size_max = 40,
                                            .command_probability = random.chance(0.5) ? 0.2 : 0});
    const CachedRun cycle = run_of(config, scene, TimedMode::cycle);
    const CachedRun span = run_of(config, scene, TimedMode::span);
    const CachedRun bare = run_of(config, scene, TimedMode::span, false);
    ASSERT_EQ(cycle.report.caches.size(), 3U);
    EXPECT_TRUE(span.report.caches == cycle.report.caches);
    EXPECT_TRUE(bare.report.caches == cycle.report.caches);
    EXPECT_EQ(span.report.cycles, cycle.report.cycles);
    EXPECT_EQ(bare.report.cycles, cycle.report.cycles);
    for (const CacheReport& counted : cycle.report.caches) {
      const std::string name(counted.name);
      SCOPED_TRACE(name);
      const auto log = cycle.logs.find(name);
      if (log == cycle.logs.end()) continue;
      EXPECT_TRUE(same(span.logs.at(name), log->second));
      ReplayedCache replay = replayed_cache(memory, name);
      for (std::size_t i = 0; i < log->second.size(); ++i) {
        ASSERT_TRUE(same(replay.see(log->second[i]), log->second[i])) << "access " << i;
        flushes += log->second[i].kind == CacheAccessKind::flush ? 1 : 0;
      }
      replay.report.flushed += replay.written_lines();
      replay.report.name = counted.name;
      EXPECT_TRUE(replay.report == counted);
      CacheReport& sum = all[name];
      sum.reads += counted.reads;
      sum.writes += counted.writes;
      sum.written_back += counted.written_back;
      sum.flushed += counted.flushed;
      for (std::size_t r = 0; r < sum.results.size(); ++r) sum.results[r] += counted.results[r];
    }
    if (HasFailure()) return;
  }
  for (const auto& [name, sum] : all) {
    std::cout << name << ": " << sum.reads << " reads, " << sum.writes << " writes, " << sum.results[0]
              << " hits, " << sum.results[1] << " compulsory, " << sum.results[2] << " capacity, "
              << sum.results[3] << " conflict, " << sum.written_back << " written back, " << sum.flushed
              << " flushed\n";
    for (const std::uint64_t n : sum.results) EXPECT_GT(n, 100U) << name;
    EXPECT_GT(sum.reads, 10000U) << name;
    if (name == "texture") continue;
    EXPECT_GT(sum.writes, 5000U) << name;
    EXPECT_GT(sum.written_back, 500U) << name;
    EXPECT_GT(sum.flushed, 100U) << name;
  }
  EXPECT_EQ(all.size(), 3U);
  EXPECT_GT(flushes, 20U);
}

// Which bytes a log has follows from the records.
TEST(Caches, TheLogHasTheAccessesOfTheRecords) {
  Config config = shipped_config("depth16");
  config.memory.depth_cache = {.mode = BufferCacheMode::write_back, .sets = 4};
  config.memory.color_cache = {.mode = BufferCacheMode::write_through, .sets = 4};
  const Scene scene =
      random_scene(5, {.width = 40, .height = 30, .triangles = 30, .translucent_probability = 0.5});
  const CachedRun run = run_of(config, scene, TimedMode::cycle);
  std::vector<CacheAccess> expected;
  for (const DepthRecord& r : run.trace.depth) {
    const auto address = static_cast<std::uint64_t>(r.y * scene.width + r.x) * 2;
    expected.push_back({.kind = CacheAccessKind::read, .address = address});
    if (r.pass == 1) expected.push_back({.kind = CacheAccessKind::write, .address = address});
  }
  const auto alike = [](const CacheAccess& a, const CacheAccess& b) {
    return a.kind == b.kind && a.address == b.address;
  };
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_TRUE(std::ranges::equal(run.logs.at("depth"), expected, alike));

  expected.clear();
  std::map<std::array<std::int64_t, 3>, std::int64_t> alpha;
  for (const TextureRecord& r : run.trace.texture) alpha[{r.triangle, r.x, r.y}] = r.a;
  for (const TextureSecondRecord& r : run.trace.texture_second) alpha[{r.triangle, r.x, r.y}] = r.a;
  const std::int64_t one = std::int64_t{1} << config.format(FormatId::texture_alpha).fraction();
  std::uint64_t reads = 0;
  for (const MergeRecord& r : run.trace.merge) {
    const auto address = static_cast<std::uint64_t>(r.y * scene.width + r.x) * 4;
    if (alpha.at({r.triangle, r.x, r.y}) < one) {
      expected.push_back({.kind = CacheAccessKind::read, .address = address});
      ++reads;
    }
    expected.push_back({.kind = CacheAccessKind::write, .address = address});
  }
  EXPECT_GT(reads, 50U);
  EXPECT_TRUE(std::ranges::equal(run.logs.at("color"), expected, alike));
}

TEST(Caches, MemoryTrafficByHand) {
  const auto memory = [](BufferCacheMode mode, int line_bytes, int sets) {
    Config config = shipped_config("depth16");
    config.memory.width_bytes = 8;
    config.memory.depth_cache =
        config.memory.color_cache = {.mode = mode, .line_bytes = line_bytes, .sets = sets, .ways = 1};
    return run_of(config, square_half(), TimedMode::cycle).report.memory;
  };
  // A line holds the whole buffer: each is read once, in 32 and 16 beats, and written by a flush alone.
  const MemoryReport back = memory(BufferCacheMode::write_back, 256, 1);
  EXPECT_EQ(back.reads, 2U);
  EXPECT_EQ(back.writes, 0U);
  EXPECT_EQ(back.beats, 64U);
  // Colours are not read, and so nothing brings their line in; the words of 8 bytes are written one by one:
  // of colours 2, 2, 1, 1 of the rows, of depth codes one per row.
  const MemoryReport through = memory(BufferCacheMode::write_through, 256, 1);
  EXPECT_EQ(through.reads, 1U);
  EXPECT_EQ(through.writes, 10U);
  EXPECT_EQ(through.beats, 42U);
  // Lines of 16 bytes in a single place: a row of depth codes is a line, and the last stays; the colours have
  // 1, 1, 1, 1 lines, too, since a row begins with four pixels of one line.
  const MemoryReport narrow = memory(BufferCacheMode::write_back, 16, 1);
  EXPECT_EQ(narrow.reads, 8U);
  EXPECT_EQ(narrow.writes, 6U);
  EXPECT_EQ(narrow.beats, 28U);
}

// A change of target writes a cache back and empties it; one to the target that is drawn on does nothing.
TEST(Caches, AChangeOfTargetFlushes) {
  Config config = shipped_config("depth16");
  config.memory.depth_cache = config.memory.color_cache = {
      .mode = BufferCacheMode::write_back, .line_bytes = 256, .sets = 64, .ways = 4};
  const auto flushes = [&](const std::vector<int>& targets, TimedMode mode) {
    Scene scene = random_scene(6, {.width = 40, .height = 30, .triangles = 12, .size_min = 20});
    for (std::size_t i = 0; i < targets.size(); ++i)
      scene.commands.push_back({.before = 2 * i + 2, .what = Target{targets[i]}});
    const CachedRun run = run_of(config, scene, mode);
    std::array<std::size_t, 2> n{};
    for (const CacheReport& cache : run.report.caches) {
      if (cache.name == "texture") continue;
      const std::vector<CacheAccess>& log = run.logs.at(std::string(cache.name));
      n.at(cache.name == "depth" ? 0 : 1) =
          static_cast<std::size_t>(std::ranges::count(log, CacheAccessKind::flush, &CacheAccess::kind));
      EXPECT_EQ(cache.written_back, 0U);
      if (targets.empty()) continue;
      EXPECT_GT(cache.flushed, 1U);
      EXPECT_EQ(cache.results[static_cast<std::size_t>(CacheResult::capacity)], 0U);
    }
    return n;
  };
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    EXPECT_EQ(flushes({}, mode), (std::array<std::size_t, 2>{0, 0}));
    EXPECT_EQ(flushes({0, 0}, mode), (std::array<std::size_t, 2>{0, 0}));
    EXPECT_EQ(flushes({1, 0, 2, 2, 1}, mode), (std::array<std::size_t, 2>{4, 4}));
  }
}

// The words touched last are another target's: one translucent pixel, twice, with stencil and depth written.
TEST(Caches, AChangeOfTargetForgetsTheWordsTouchedLast) {
  const Config config = shipped_config("depth16");
  const auto memory = [&](int target, TimedMode mode) {
    Scene scene = square_half({{"depth.when", 1},
                               {"depth.func", static_cast<std::int64_t>(DepthFunc::always)},
                               {"stencil.test", 1},
                               {"stencil.pass", static_cast<std::int64_t>(StencilOp::invert)}},
                              0.5);
    scene.triangles[0].v[1].x = scene.triangles[0].v[2].y = 1.25;
    scene.triangles.push_back(scene.triangles[0]);
    scene.commands.push_back({.before = 1, .what = Target{target}});
    const CachedRun run = run_of(config, scene, mode);
    EXPECT_EQ(run.trace.merge.size(), 2U);
    return std::pair(run.report.memory.reads, run.report.memory.writes);
  };
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    // Depth, stencil and colour are read and written once each, and once more on the other target.
    EXPECT_EQ(memory(0, mode), (std::pair<std::uint64_t, std::uint64_t>(3, 3)));
    EXPECT_EQ(memory(1, mode), (std::pair<std::uint64_t, std::uint64_t>(6, 6)));
  }
}

// ---------------------------------------------------------------- docs/timing.md

using Rows = std::vector<std::string>;

// As in tests/config/docs_test.cpp.
void expect_table(const std::string& name, const Rows& expected) {
  const std::string page = source_path("docs/timing.md");
  Rows lines;
  std::istringstream text(read_file(page));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  const auto begin = std::ranges::find(lines, "<!-- " + name + " -->");
  const auto end = std::ranges::find(lines, "<!-- end of " + name + " -->");
  ASSERT_TRUE(begin < end && end != lines.end()) << name;
  if (std::getenv("BITSPAN_UPDATE_DOCS") != nullptr) {
    const auto at = lines.erase(begin + 1, end);
    lines.insert(at, expected.begin(), expected.end());
    std::ofstream out(page);
    for (const std::string& line : lines) out << line << "\n";
    return;
  }
  EXPECT_EQ(Rows(begin + 1, end), expected) << "BITSPAN_UPDATE_DOCS=1 writes it anew";
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(1);
  out << 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  return out.str();
}

TEST(Caches, TheTraceInTheDocument) {
  Config config = shipped_config("depth16");
  config.memory.color_cache = {
      .mode = BufferCacheMode::write_back, .line_bytes = 8, .sets = 2, .ways = 1, .hash = SetHash::none};
  Rows rows{"| access | pixel | byte | line | set | result |", "|---|---|---|---|---|---|"};
  const CachedRun run = run_of(config, square_half(), TimedMode::span);
  int number = 0;
  for (const CacheAccess& a : run.logs.at("color")) {
    std::ostringstream row;
    row << "| " << to_string(a.kind) << " " << ++number << " | " << a.address / 4 % 8 << ", "
        << a.address / 4 / 8 << " | " << a.address << " | " << a.address / 8 << " | " << a.address / 8 % 2
        << " | " << to_string(a.result) << (a.writes_back ? ", writes a line back" : "") << " |";
    rows.push_back(row.str());
  }
  EXPECT_EQ(rows.size(), 12U);
  expect_table("trace of a cache", rows);
}

TEST(Caches, TheHitRatesInTheDocument) {
  Rows rows{
      "| picture | sets x ways | cache | accesses | hits % | compulsory | capacity | conflict | written back "
      "| cycles |",
      "|---|---|---|---|---|---|---|---|---|---|"};
  for (const auto& [width, height] : {std::pair{320, 240}, {640, 480}}) {
    const Scene scene = demo_scene(width, height);
    for (const auto& [sets, ways] : {std::pair{16, 1}, {64, 2}}) {
      Config config = shipped_config("depth16");
      config.memory.cache_sets = sets;
      config.memory.cache_ways = ways;
      config.memory.depth_cache =
          config.memory.color_cache = {.mode = BufferCacheMode::write_back, .sets = sets, .ways = ways};
      const auto engine = make_systemc(config, {.mode = TimedMode::span, .measure_texture_cache = true});
      engine->begin(scene);
      draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
      const TimedReport report = engine->report();
      for (const CacheReport& c : report.caches) {
        std::ostringstream row;
        row << "| " << width << "x" << height << " | " << sets << " x " << ways << " | " << c.name << " | "
            << c.reads + c.writes << " | " << percent(c.results[0], c.reads + c.writes) << " | "
            << c.results[1] << " | " << c.results[2] << " | " << c.results[3] << " | "
            << (c.name == "texture" ? "-" : std::to_string(c.written_back)) << " | " << report.cycles << " |";
        rows.push_back(row.str());
      }
    }
  }
  EXPECT_EQ(rows.size(), 14U);
  expect_table("hit rates", rows);
}

}  // namespace
}  // namespace bitspan
