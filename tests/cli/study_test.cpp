// SPDX-License-Identifier: Apache-2.0
// `bitspan study` from outside: exit codes, messages, what a run leaves behind.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/cli/program.hpp"

namespace bitspan {
namespace {

class Study : public Program {
 protected:
  void SetUp() override {
    stream("a.tri");
    folder.write("s.toml", study("[30, 32, 34]"));
  }

  std::string command(const std::string& arguments) const { return Program::command("study " + arguments); }
  Result run(const std::string& arguments) const { return Program::run("study " + arguments); }
  Result refused(const std::string& arguments, const std::string& part) const {
    return Program::refused("study " + arguments, part);
  }
  // Ctrl-C as soon as three points are in s.db.
  Result interrupted(const std::string& arguments) const {
    return signalled("study " + arguments, SIGINT,
                     [this] { return number("s.db", "SELECT count(*) FROM points") >= 3; });
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder.path(name)); }

  static std::string study(const std::string& words, const std::string& rest = "",
                           const std::string& scene = "a.tri") {
    return "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"" + scene +
           "\"]\nmetrics = [\"span.u.max\"]\n[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = " + words +
           "\n" + rest;
  }

  // The first column of the first row; -1 where there is no such database, table or row yet.
  std::int64_t number(const std::string& db, const std::string& sql) const {
    sqlite3* handle = nullptr;
    std::int64_t out = -1;
    if (sqlite3_open_v2(folder.path(db).c_str(), &handle, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK) {
      sqlite3_busy_timeout(handle, 1000);
      sqlite3_stmt* statement = nullptr;
      sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr);
      if (sqlite3_step(statement) == SQLITE_ROW) out = sqlite3_column_int64(statement, 0);
      sqlite3_finalize(statement);
    }
    sqlite3_close(handle);
    return out;
  }
  std::string hash(const std::string& db) const {
    sqlite3* handle = nullptr;
    std::string out;
    sqlite3_open(folder.path(db).c_str(), &handle);
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(handle, "SELECT hash FROM points WHERE status = 'ok'", -1, &statement, nullptr);
    if (sqlite3_step(statement) == SQLITE_ROW) {
      out = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
    }
    sqlite3_finalize(statement);
    sqlite3_close(handle);
    return out;
  }
};

TEST_F(Study, MeasuresOnceExportsAndReplays) {
  const Result first = run("s.toml --csv out.csv");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("s: 3 points: 0 of them known, 0 refused, 3 hold"), std::string::npos)
      << first.out;
  EXPECT_EQ(number("s.db", "SELECT count(*) FROM points"), 3);
  EXPECT_EQ(number("s.db", "SELECT count(*) FROM metrics WHERE name = 'span.u.max'"), 3);
  const std::string csv = folder.read("out.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_TRUE(csv.starts_with("i,formats.span.h.word,status,holds,span.u.max,seconds,")) << csv;
  EXPECT_NE(csv.find("bitspan study --db s.db --replay "), std::string::npos);

  const Result again = run("s.toml");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("3 of them known, 0 refused, 3 hold (there is no constraint); 0 measured"),
            std::string::npos)
      << again.out;

  const std::string point = hash("s.db");
  ASSERT_EQ(point.size(), 32U);
  const Result replay = run("--db s.db --replay " + point.substr(0, 12));
  EXPECT_EQ(replay.code, 0) << replay.out << replay.err;
  EXPECT_NE(replay.out.find(point + ": the same, bit for bit"), std::string::npos) << replay.out;
  // A stored number that is not what is measured.
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(folder.path("s.db").c_str(), &handle), SQLITE_OK);
  EXPECT_EQ(
      sqlite3_exec(handle,
                   "UPDATE metric_values SET value = value + 1 WHERE scene = -1 AND name = (SELECT id FROM "
                   "metric_names WHERE name = 'span.u.max')",
                   nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(handle);
  const Result differs = run("--db s.db --replay " + point);
  EXPECT_EQ(differs.code, 1) << differs.err;
  EXPECT_NE(differs.out.find("metric span.u.max: stored 1"), std::string::npos) << differs.out;
  EXPECT_NE(differs.out.find("1 differences"), std::string::npos) << differs.out;
}

// Four widths; the error is far below the limit, so that the search has far to go.
std::string search_study(const std::string& limits) {
  std::string out = "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\n";
  for (const char* key : {"span.h", "span.uv", "edge.h", "edge.uv"}) {
    out += std::string("[[vary]]\nkeys = [\"formats.") + key + ".fraction\"]\nfrom = 1\nto = 18\n";
  }
  return out + "[[constraint]]\nmetric = \"span.u.p999\"\nat_most = 4\n[search]\n" + limits;
}

TEST_F(Study, AxesThatDoNotMoveTheCostAreNamedBeforeTheSearch) {
  const std::string cost = "estimate.ecp5.luts + 100 * estimate.ecp5.multipliers";
  std::string text = search_study("evaluations = 8\ncost = \"" + cost + "\"\n");
  text.replace(text.find("[[constraint]]"), 0, "[[vary]]\nkeys = [\"depth.bits\"]\nfrom = 15\nto = 16\n");
  folder.write("s.toml", text);
  const Result idle = run("s.toml --csv s.csv");
  EXPECT_EQ(idle.code, 0) << idle.err;
  EXPECT_TRUE(idle.out.starts_with("depth.bits does not move " + cost + "\n")) << idle.out;
  EXPECT_EQ(idle.out.find("does not move", 20), std::string::npos) << idle.out;
  EXPECT_NE(folder.read("s.csv").find("," + cost + ",seconds,"), std::string::npos);
  text.replace(text.find(cost), cost.size(), "memory.depth_bits");
  folder.write("t.toml", text);
  const Result moves = run("t.toml --db t.db");
  EXPECT_NE(moves.out.find("formats.span.h.fraction does not move memory.depth_bits\n"), std::string::npos);
  EXPECT_EQ(moves.out.find("depth.bits does not move"), std::string::npos) << moves.out;
  // The point that is measured again has no value of the plan's, and equals what is stored.
  EXPECT_EQ(run("--db s.db --replay " + hash("s.db")).code, 0);
}

TEST_F(Study, AnExpressionHeadsItsColumn) {
  folder.write("s.toml", study("[32, 34]", "[[constraint]]\nmetric = \"2 * span.u.max\"\nat_most = 100\n"));
  const Result result = run("s.toml");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("2 * span.u.max"), std::string::npos) << result.out;
  folder.write("s.toml", study("[32]", "[[constraint]]\nmetric = \"2 * span.u.mox\"\nat_most = 100\n"));
  refused("s.toml",
          "constraint[1].metric: \"2 * span.u.mox\": character 5: \"span.u.mox\" is no metric; legal: ");
}

TEST_F(Study, TablesShowWhatTellsLinkedKeysApart) {
  const auto varied = [this](const std::string& vary) {
    folder.write("s.toml",
                 "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\n"
                 "metrics = [\"span.u.max\"]\n[[vary]]\nkeys = [\"depth.round\", \"depth.bits\", "
                 "\"formats.span.h.word\", \"formats.edge.h.word\", \"reciprocal.pixel.kind\"]\n" +
                     vary);
    return run("s.toml --db t.db").out;
  };
  const std::string values =
      "values = [[\"SC_TRN\", 16, 34, 30, \"restoring\"], [\"SC_TRN\", 16, 33, 31, \"restoring\"]]\n";
  const std::string unnamed = varied(values);
  EXPECT_TRUE(unnamed.starts_with("i  formats.span.h.word +4")) << unnamed;
  EXPECT_NE(unnamed.find("\n1                      33 "), std::string::npos) << unnamed;
  // No key tells these three apart.
  const std::string changing = varied(
      "values = [[\"SC_TRN\", 16, 34, 30, \"restoring\"], [\"SC_TRN\", 16, 34, 31, \"restoring\"], "
      "[\"SC_TRN\", 16, 33, 31, \"restoring\"]]\n");
  EXPECT_TRUE(changing.starts_with("i  formats.span.h.word, word +3")) << changing;
  EXPECT_NE(changing.find("34, 31 "), std::string::npos) << changing;
  const std::string named = varied("name = \"set\"\n" + values);
  EXPECT_TRUE(named.starts_with("i  set  ")) << named;
  EXPECT_NE(named.find("SC_TRN, 16, 33, 31, restoring"), std::string::npos) << named;
}

TEST_F(Study, ASearchSaysTheNameOfAnAxisAndItsKeys) {
  folder.write("s.toml",
               "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\n[[vary]]\nname = \"depth\"\n"
               "keys = [\"depth.bits\", \"formats.span.h.word\"]\nfrom = 14\nto = 16\noffsets = [0, 18]\n"
               "[[constraint]]\nmetric = \"cost.register_bits\"\nat_least = 1\n[search]\n");
  const std::string out = run("s.toml").out;
  EXPECT_NE(out.find("\n  depth = 14 (depth.bits = 14, formats.span.h.word = 32)\ncertificate:\n"),
            std::string::npos)
      << out;
  EXPECT_NE(out.find("\n  depth 14: at its smallest\n"), std::string::npos) << out;
}

TEST_F(Study, ASearchComparesItsCategories) {
  folder.write(
      "s.toml",
      "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\n[[vary]]\n"
      "keys = [\"reciprocal.pixel.kind\"]\nvalues = [\"lut_linear\", \"restoring\", \"magic\"]\n[[vary]]\n"
      "keys = [\"formats.span.h.word\"]\nfrom = 32\nto = 34\n[[constraint]]\n"
      "metric = \"cost.register_bits\"\nat_least = 1\n[search]\n");
  const Result r = run("s.toml --csv out.csv");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("combinations:\ncombination                         cost.register_bits  evaluations  "
                       "stopped by  certificate  what fails\n"),
            std::string::npos)
      << r.out;
  EXPECT_NE(r.out.find("\nreciprocal.pixel.kind = restoring "), std::string::npos) << r.out;
  const auto magic = r.out.find("\nreciprocal.pixel.kind = magic ");
  ASSERT_NE(magic, std::string::npos) << r.out;
  EXPECT_NE(r.out.find("refused: reciprocal.pixel.kind: \"magic\" is no value", magic), std::string::npos)
      << r.out;
  EXPECT_EQ(number("s.db", "SELECT count(*) FROM combinations WHERE minimal = 1 AND cost > 0"), 2);
  EXPECT_EQ(
      number("s.db", "SELECT count(*) FROM certificate WHERE combination LIKE 'reciprocal.pixel.kind = %'"),
      2);
  EXPECT_NE(folder.read("out.csv").find(",restoring,34,ok,1,"), std::string::npos);
}

TEST_F(Study, ASearchExportsItsEvaluations) {
  folder.write("s.toml", search_study("algorithm = \"greedy\"\nevaluations = 30\n"));
  const Result first = run("s.toml --csv out.csv");
  EXPECT_EQ(first.code, 0) << first.out << first.err;
  const std::string csv = folder.read("out.csv");
  EXPECT_TRUE(
      csv.starts_with("i,formats.span.h.fraction,formats.span.uv.fraction,formats.edge.h.fraction,"
                      "formats.edge.uv.fraction,status,holds,"))
      << csv.substr(0, 300);
  EXPECT_NE(csv.find("\r\n0,18,18,18,18,ok,1,"), std::string::npos);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 31);
  const Result again = run("s.toml --csv again.csv --db s.db");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(folder.read("again.csv"), csv);
}

TEST_F(Study, ExitsByItsConstraints) {
  const auto constraint = [](const char* at_most) {
    return std::string("[[constraint]]\nmetric = \"span.u.max\"\nat_most = ") + at_most + "\n";
  };
  folder.write("s.toml", study("[30, 34]", constraint("100")));
  EXPECT_EQ(run("s.toml").code, 0);
  folder.write("s.toml", study("[30, 34]", constraint("0")));
  const Result none = run("s.toml");
  EXPECT_EQ(none.code, 1) << none.err;
  EXPECT_NE(none.out.find("0 hold"), std::string::npos);
  EXPECT_NE(none.out.find("nothing to recommend: no point holds all constraints\n"), std::string::npos)
      << none.out;
  // Who asks for areas and gets none is told why.
  folder.write("s.toml", study("[30, 34]", "[area]\nfamilies = [\"ecp5\"]\n"));
  const Result level = run("s.toml");
  EXPECT_EQ(level.code, 0) << level.err;
  EXPECT_NE(level.out.find("nothing to recommend: there is no constraint, and span.u.max against "
                           "cost.register_bits has no knee; areas, budgets and bounds are of what is "
                           "recommended\n"),
            std::string::npos)
      << level.out;
}

// A mesh is lit by the unit of a configuration, or by the front end where it has none.
TEST_F(Study, LightsAMeshAsItsPointsAsk) {
  const auto lit = [&](const std::string& axes, const std::string& flags = "") {
    return "[study]\nname = \"s\"\nbase = \"depth16\"\nsize = \"48x36\"\nscenes = [\"" +
           source_path("tests/data/spot.obj") + " " + flags + "\"]\n" + axes;
  };
  const std::string pixels = "[[vary]]\nkeys = [\"light.at\"]\nvalues = [\"pixel\"]\n";
  const std::string limit = "[[constraint]]\nmetric = \"light.value.max\"\nat_most = 0.01\n";
  folder.write("s.toml", lit(pixels + limit, "--light=3,5,-4,0.2,0.3,8"));
  EXPECT_EQ(run("s.toml").code, 0) << "the base has no unit, and its points have it";
  folder.write("s.toml", lit(pixels + "[[constraint]]\nmetric = \"light.value.max\"\nat_most = 0\n",
                             "--light=3,5,-4,0.2,0.3,8"));
  EXPECT_EQ(run("s.toml").code, 1) << "no light is exact";
  for (const std::string axis : {"[[vary]]\nkeys = [\"light.at\"]\nvalues = [\"none\", \"pixel\"]\n",
                                 "[[vary]]\nkeys = [\"light.at\", \"light.source\"]\n"
                                 "values = [[\"pixel\", \"parallel\"], [\"pixel\", \"point\"]]\n"}) {
    folder.write("s.toml", lit(axis, "--light=3,5,-4"));
    refused("s.toml", "the points do not light it alike");
    folder.write("s.toml", lit(axis, "--unlit"));
    EXPECT_EQ(run("s.toml").code, 0) << axis;
  }
}

TEST_F(Study, MeasuresOnePoint) {
  const Result r = run("--point depth16 a.tri --db p.db");
  EXPECT_EQ(r.code, 0) << r.err;
  for (const char* part :
       {"SQNR", "head-room", "picture.wrong_order_rate", "cost.register_bits", "on 1 scenes"}) {
    EXPECT_NE(r.out.find(part), std::string::npos) << part << "\n" << r.out;
  }
  EXPECT_EQ(run("--db p.db --replay " + hash("p.db")).code, 0);
  EXPECT_NE(run("--help").out.find("Example:\n  bitspan study "), std::string::npos);
}

TEST_F(Study, BadStudiesAreRefusedAndLeaveNothing) {
  refused("", "one STUDY.toml");
  refused("s.toml s.toml", "one STUDY.toml");
  refused("none.toml", "none.toml: no such study");
  folder.write("key.toml", study("[3]") + "[[vary]]\nkeys = [\"depht.bits\"]\nvalues = [16]\n");
  refused("key.toml",
          "key.toml:10: vary[2].keys: depht.bits: no such key of a configuration; nearest: depth.bits");
  folder.write("empty.toml", study("[]"));
  refused("empty.toml", "empty.toml:8: vary[1].values: is empty");
  folder.write("base.toml", "[study]\nname = \"b\"\nbase = \"depht16\"\n");
  refused("base.toml", "shipped names: depth16");
  folder.write("scene.toml", study("[30]", "", "none.tri"));
  refused("scene.toml", "none.tri: no such file");
  folder.write("bad.tri", "no scene\n");
  folder.write("bad.toml", study("[30]", "", "bad.tri"));
  refused("bad.toml", "bad.tri:1");
  folder.write("extreme.toml", study("[30]", "", "extreme/none"));
  refused("extreme.toml", "extreme/none: no such scene");
  refused("s.toml --threads -1", "--threads");
  refused("s.toml --size 3x3", "--size");
  refused("s.toml --point depth16 --replay 1", "one of them");
  refused("--point none a.tri", "none");
  refused("--point depth16 none.tri", "none.tri");
  refused("--replay 1f", "--db");
  refused("--db none.db --replay 1f", "none.db: no such database");
  EXPECT_FALSE(exists("s.db") || exists("none.db"));
  EXPECT_EQ(run("s.toml").code, 0);
  refused("--db s.db --replay zz", "--replay zz: no point of s.db");
  refused("--db s.db --replay 1f a.tri", "leave them out");
}

TEST_F(Study, SceneThatDrawsNothingIsAnError) {
  stream("away.tri", "{\"v\": [[-20, 2, 2, 0, 0], [-3, 4, 50, 20, 0], [-15, 22, 9, 0, 20]]}\n");
  refused("--point depth16 away.tri", "nothing is drawn");
  folder.write("away.toml", study("[30, 34]", "", "away.tri"));
  refused("away.toml", "not one of 2 points can be measured; the first: ");
}

TEST_F(Study, DamagedAndLockedDatabasesAreRefusedAndKept) {
  folder.write("junk.db", std::string(3000, 'j'));
  refused("s.toml --db junk.db", "junk.db: is damaged, or no SQLite database");
  EXPECT_EQ(folder.read("junk.db"), std::string(3000, 'j'));
  refused("s.toml --db no/such/x.db", "no/such/x.db: cannot be opened as a database");
  refused("s.toml --csv no/such/x.csv --db s.db", "no/such/x.csv: cannot write");
  EXPECT_FALSE(std::filesystem::exists(folder.path("s.db"))) << "refused before the work";
  refused("s.toml --report junk.db", "junk.db: cannot write");
  EXPECT_EQ(run("s.toml").code, 0);
  EXPECT_EQ(number("s.db", "SELECT count(*) FROM points"), 3);
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(folder.path("s.db").c_str(), &handle), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(handle, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  refused("s.toml", "s.db: is locked by another program, and was for 5 s");
  sqlite3_close(handle);
  EXPECT_EQ(run("s.toml").code, 0);
}

TEST_F(Study, FullDiskLosesNothing) {
  std::string words = "[20";
  for (int w = 21; w < 50; ++w) words += ", " + std::to_string(w);
  folder.write("s.toml", study(words + "]"));
  // No file may pass 480 KiB: what a full disk is to a database.
  const std::string limited = "trap '' XFSZ; ulimit -f 480; " + command("s.toml");
  const int status = std::system(("bash -c \"" + limited + "\"").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2) << folder.read(".out");
  EXPECT_NE(folder.read(".err").find("all points finished before are kept"), std::string::npos)
      << folder.read(".err");
  const std::int64_t kept = number("s.db", "SELECT count(*) FROM points");
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, 30);
  const Result rest = run("s.toml");
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_NE(rest.out.find("30 points: " + std::to_string(kept) + " of them known"), std::string::npos)
      << rest.out;
}

TEST_F(Study, InterruptStopsAndTheSameCommandGoesOn) {
  folder.write("s.toml",
               "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\n"
               "[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 25\nto = 44\n"
               "[[vary]]\nkeys = [\"formats.span.uv.word\"]\nfrom = 20\nto = 39\n");
  const Result stopped = interrupted("s.toml --threads 1");
  EXPECT_EQ(stopped.code, 130) << stopped.out << stopped.err;
  const std::int64_t kept = number("s.db", "SELECT count(*) FROM points");
  EXPECT_GE(kept, 3);
  EXPECT_LT(kept, 400);
  EXPECT_NE(stopped.out.find("stopped: " + std::to_string(kept) +
                             " of 400 points are in s.db; go on with: bitspan study s.toml --db s.db\n"),
            std::string::npos)
      << stopped.out;
  const Result limited = run("s.toml --points 5");
  EXPECT_EQ(limited.code, 0) << limited.err;
  EXPECT_NE(limited.out.find("not finished: "), std::string::npos) << limited.out;
  EXPECT_EQ(number("s.db", "SELECT count(*) FROM points"), kept + 5);
}

TEST_F(Study, ShardsMakeOneStudy) {
  const auto shard = [&](const char* part, const char* says) {
    const Result r = run(std::string("s.toml --shard ") + part);
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.out.find(says), std::string::npos) << r.out;
  };
  shard("1/2", "s: 2 points: 0 of them known");
  shard("2/2", "shard 2/2 is finished; with all others: bitspan study merge --db s.db s.2-of-2.db");
  const Result merged = run("merge --db s.db s.1-of-2.db s.2-of-2.db");
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(merged.out, "s.1-of-2.db: 2 points, 2 of them new\ns.2-of-2.db: 1 points, 1 of them new\n");
  const Result whole = run("s.toml --db s.db");
  EXPECT_EQ(whole.code, 0) << whole.err;
  EXPECT_NE(whole.out.find("s: 3 points: 3 of them known"), std::string::npos) << whole.out;
  EXPECT_FALSE(exists("s.db-claims"));

  for (const char* part : {"0/2", "3/2", "1", "1/", "/2", "1/2x", "a/b", "1/100001", "-1/2", "1/0"}) {
    refused(std::string("s.toml --shard ") + part, "--shard: \"" + std::string(part) + "\"; expected I/N");
  }
  refused("s.toml --shard 1/2 --report out", "--shard: a report is of all parts");
  refused("--shard 1/2 --point depth16", "--shard: goes with a STUDY.toml");
  folder.write("search.toml", search_study("evaluations = 8\n"));
  refused("search.toml --shard 1/2", "--shard: a search goes from point to point");
  refused("merge --db new.db s.db none.db", "none.db: no such database");
  EXPECT_FALSE(exists("new.db"));
  refused("merge s.db", "--db is required");
}

TEST_F(Study, AReportComparesWithAnotherStudy) {
  EXPECT_EQ(run("s.toml --db before.db").code, 0);
  folder.write("s.toml", study("[30, 32, 34]", "[[constraint]]\nmetric = \"span.u.max\"\nat_most = 1\n"));
  const Result r = run("s.toml --report out --against before.db");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  const std::string page = folder.read("out/report.html");
  EXPECT_NE(page.find("Compared with"), std::string::npos);
  EXPECT_NE(page.find("before.db"), std::string::npos);
  refused("s.toml --against before.db", "--against: goes with --report");
  refused("s.toml --report new --against none.db", "--against none.db: no such file");
  EXPECT_FALSE(exists("new"));
}

TEST_F(Study, PointsComeFromAFile) {
  folder.write("p.csv", "formats.span.h.word,depth.bits\n30,\n34,15\n");
  folder.write("s.toml",
               "[study]\nname = \"s\"\nbase = \"depth16\"\nscenes = [\"a.tri\"]\npoints = \"p.csv\"\n"
               "metrics = [\"span.u.max\"]\n");
  const Result first = run("s.toml --csv s.csv");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("s: 2 points"), std::string::npos) << first.out;
  // The CSV file of a study is a list of its points.
  folder.write("p.csv", folder.read("s.csv"));
  const Result again = run("s.toml --csv t.csv");
  EXPECT_NE(again.out.find("s: 2 points: 2 of them known"), std::string::npos) << again.out << again.err;
  EXPECT_EQ(folder.read("t.csv"), folder.read("s.csv"));
}

TEST_F(Study, ScenesHaveFlags) {
  const auto lit = [&](const std::string& scenes, const std::string& rest = "") {
    folder.write("s.toml", "[study]\nname = \"s\"\nbase = \"depth16\"\nsize = \"64x48\"\nscenes = [" +
                               scenes +
                               "]\nmetrics = [\"shadow.unexplained\", \"cost.register_bits\"]\n"
                               "[[vary]]\nkeys = [\"project.unit\", \"depth.bits\"]\n"
                               "values = [[\"reciprocal\", 15], [\"reciprocal\", 16]]\n" +
                               rest);
  };
  const std::string lamp = "demo --shadow=-12,16,-2 --shadow-map 256 --shadow-bias=";
  lit('"' + lamp + "0\", \"" + lamp + "auto\"");
  const Result first = run("s.toml --csv-scenes s.csv");
  EXPECT_EQ(first.code, 0) << first.err;
  const std::string csv = folder.read("s.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5) << csv;
  for (const char* bits : {"15", "16"}) {
    const std::string at = std::string("auto\",reciprocal,") + bits + ",ok,1,0,";
    EXPECT_NE(csv.find(at), std::string::npos) << csv;
    EXPECT_EQ(csv.find("=0\",reciprocal," + std::string(bits) + ",ok,1,0,"), std::string::npos) << csv;
  }
  EXPECT_NE(run("--db s.db --replay " + hash("s.db")).out.find("the same, bit for bit"), std::string::npos);

  lit("\"demo --shadw=1,2,3\"");
  refused("s.toml", "flags of a scene: --shadw=1,2,3: ");
  lit("\"demo --texture1=a.png\"");
  refused("s.toml", "--texture1: the configuration gives");
  lit('"' + lamp + "auto\"", "[report]\nbounds = true\n");
  refused("s.toml", "s: report.bounds is of one view, and " + lamp + "auto is drawn in passes");
  lit('"' + lamp + "auto\"", "[[vary]]\nkeys = [\"scene.s_ratio\"]\nvalues = [10]\n");
  refused("s.toml", "scene.s_ratio would move what is projected");
}

TEST_F(Study, AnInterruptedSearchExportsWhatIsThere) {
  folder.write("s.toml", search_study("algorithm = \"annealing\"\nevaluations = 100000\n"));
  const Result stopped = interrupted("s.toml --threads 1 --csv out.csv");
  EXPECT_EQ(stopped.code, 130) << stopped.out << stopped.err;
  const std::string csv = folder.read("out.csv");
  EXPECT_NE(csv.find("\r\n0,18,18,18,18,ok,1,"), std::string::npos) << csv.substr(0, 300);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'),
            1 + number("s.db", "SELECT count(*) FROM study_points"));
  const std::string told = "stopped; go on with: bitspan study s.toml --db s.db --csv out.csv\n";
  EXPECT_TRUE(stopped.out.ends_with(told)) << stopped.out;
  EXPECT_EQ(stopped.out.find("go on with"), stopped.out.rfind("go on with")) << stopped.out;
}

}  // namespace
}  // namespace bitspan
