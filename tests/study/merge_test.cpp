// SPDX-License-Identifier: Apache-2.0
#include "study/merge.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/study/sweep_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

const std::string grid =
    "[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 18\nto = 30\n"
    "[[vary]]\nkeys = [\"formats.edge.uv.word\"]\nvalues = [28, 29]\n";
const std::string named = "metrics = [\"span.u.max\"]\n";

// All of a database that two runs have alike, as text.
std::string content(Store& store) {
  std::string out;
  for (const char* query :
       {"SELECT hash, config_hash, config, scenes, status, message FROM points ORDER BY hash",
        "SELECT * FROM metrics ORDER BY hash, name", "SELECT * FROM scene_metrics ORDER BY hash, scene, name",
        "SELECT * FROM fields ORDER BY hash", "SELECT * FROM registers ORDER BY hash",
        "SELECT * FROM expressions ORDER BY hash, text", "SELECT * FROM studies", "SELECT * FROM axes",
        "SELECT * FROM constraints", "SELECT * FROM study_metrics",
        "SELECT * FROM study_points ORDER BY i"}) {
    for (const Row& row : store.rows(query)) {
      for (const Cell& cell : row) {
        out += std::holds_alternative<std::string>(cell) ? text_of(cell) : std::to_string(number_of(cell));
        out += '|';
      }
      out += '\n';
    }
  }
  return out;
}

TEST(Merge, TheRowsOfShardsAreThoseOfOneRun) {
  const StudyPlan plan =
      sweep_plan(grid + below + "[[constraint]]\nmetric = \"span.u.max * 2\"\nat_most = 9\n", named);
  Bench one;
  const SweepResult whole = one.sweep(plan);
  Bench all;
  std::size_t points = 0, holding = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    Bench shard;
    shard.options.shard = {i, 3};
    if (i == 1) {  // it is cut off, and goes on
      shard.options.limit = 2;
      EXPECT_FALSE(shard.sweep(plan).finished());
      shard.options.limit = 1000;
    }
    const SweepResult part = shard.sweep(plan);
    EXPECT_TRUE(part.finished());
    points += part.points;
    holding += part.holding;
    const Merged merged = merge_database(*all.store, shard.store->path(), "1");
    EXPECT_EQ(merged.points, merged.fresh);
    EXPECT_EQ(merge_database(*all.store, shard.store->path(), "1").fresh, 0U) << "twice is once";
  }
  EXPECT_EQ(points, whole.points);
  EXPECT_EQ(holding, whole.holding);
  EXPECT_EQ(content(*all.store), content(*one.store));
  EXPECT_EQ(all.sweep(plan).known, whole.points);
  EXPECT_EQ(all.fake.calls, 0);
}

TEST(Merge, AShardWithoutPointsIsFinished) {
  Bench b;
  b.options.shard = {6, 7};
  const SweepResult part = b.sweep(sweep_plan(words));
  EXPECT_EQ(part.points, 0U);
  EXPECT_TRUE(part.finished());
  EXPECT_EQ(b.fake.calls, 0);
}

// Every table that there is, so that a new one is not forgotten.
TEST(Merge, NoTableIsLeftOut) {
  Bench a, b;
  b.sweep(sweep_plan(words + below));
  const std::string hash = text_of(b.store->rows("SELECT hash FROM study_points")[0][0]);
  const auto tables = b.store->rows("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name");
  for (const Row& table : tables) {  // a row in each that has none
    const std::string name = text_of(table[0]);
    if (b.count(name) > 0) continue;
    std::string values;
    for (const Row& column : b.store->rows("SELECT name FROM pragma_table_info(?)", {name})) {
      const std::string of = text_of(column[0]);
      values +=
          std::string(values.empty() ? "" : ", ") + (of == "study"                         ? "'s'"
                                                     : of == "hash" || of == "config_hash" ? "'" + hash + "'"
                                                                                           : "1");
    }
    b.store->run("INSERT INTO " + name + " VALUES(" + values + ")");
  }
  merge_database(*a.store, b.store->path(), "1");
  for (const Row& table : tables) {
    EXPECT_EQ(a.count(text_of(table[0])), b.count(text_of(table[0]))) << text_of(table[0]);
  }
}

// What each kept of a point is there after the merge, and what was asked of both counts as asked.
TEST(Merge, ADatabaseOfAnEarlierBitspanMayLackATable) {
  const StudyPlan plan = sweep_plan(words);
  Bench earlier;
  const SweepResult whole = earlier.sweep(plan);
  earlier.store->run("DROP TABLE measured_costs");
  earlier.store->run("DROP TABLE pictures");
  Bench all;
  EXPECT_EQ(merge_database(*all.store, earlier.store->path(), "1").fresh, whole.points);
  EXPECT_EQ(content(*all.store), content(*earlier.store));
}

TEST(Merge, WhatTwoKeptOfAPointIsKept) {
  Bench a, b;
  a.sweep(sweep_plan(words, named));
  StudyPlan other = sweep_plan(words, "metrics = [\"span.v.max\"]\n");
  other.name = "t";
  b.sweep(other);
  EXPECT_EQ(merge_database(*a.store, b.store->path(), "1").fresh, 0U);
  const std::string hash =
      text_of(a.store->rows("SELECT hash FROM study_points WHERE study = 's' AND i = 1")[0][0]);
  EXPECT_EQ(a.count("study_points WHERE study = 't'"), 4);
  EXPECT_TRUE(a.store->metrics(hash).all.contains("span.u.max"));
  EXPECT_TRUE(a.store->metrics(hash).all.contains("span.v.max"));
  const int calls = a.fake.calls;
  a.sweep(sweep_plan(words, "metrics = [\"span.u.max\", \"span.v.max\"]\n"));
  EXPECT_EQ(a.fake.calls, calls);
  // Everything of the base is in both, once.
  const std::string base = text_of(a.store->rows("SELECT base_hash FROM studies")[0][0]);
  EXPECT_EQ(a.count("fields WHERE hash = '" + base + "'"), 1);
}

TEST(Merge, WhatCannotBeOneIsRefusedAndNothingIsChanged) {
  Bench a, b;
  const StudyPlan plan = sweep_plan(words + below, named);
  a.sweep(plan);
  b.sweep(plan);
  const std::string before = content(*a.store);
  const auto refused = [&](const std::string& part) {
    expect_refusal([&] { merge_database(*a.store, b.store->path(), "1"); }, part);
    EXPECT_EQ(content(*a.store), before);
  };
  b.store->run("UPDATE studies SET plan = 'another'");
  refused("a.db: its study s is not that of");
  b.store->run("UPDATE studies SET plan = ?", {plan.text});
  b.store->run("UPDATE study_points SET hash = '0' WHERE i = 3");
  refused("they differ in their points");
  b.sweep(plan);
  b.store->run("UPDATE metric_values SET value = value + 1 WHERE scene = 0");
  refused("span.u.max of point ");
  b.store->run("UPDATE metric_values SET value = value - 1 WHERE scene = 0");
  b.store->run("UPDATE point_rows SET status = 'ok' WHERE status = 'refused'");
  refused("the status of point ");
  b.store->run("UPDATE point_rows SET status = 'refused' WHERE hash NOT IN (SELECT hash FROM metrics)");
  EXPECT_EQ(merge_database(*a.store, b.store->path(), "1").fresh, 0U);
  expect_refusal([&] { merge_database(*a.store, a.store->path(), "1"); }, "is the database that the others");
  expect_refusal([&] { merge_database(*a.store, a.folder.path("none.db"), "1"); },
                 "none.db: no such database");
  EXPECT_EQ(content(*a.store), before);
}

}  // namespace
}  // namespace bitspan
