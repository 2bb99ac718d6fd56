// SPDX-License-Identifier: Apache-2.0
#include "study/store.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "study/metrics.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

PointResult some_result(double error) {
  PointResult r;
  r.fields.push_back({"span", "u", "texel", 1.0 / 256, 1234, error});
  r.fields.push_back({"depth", "z", "code", 1, 7, 0});
  RegisterUse use;
  use.name = "span.h";
  use.format = {34, 16, false, Rounding::trn, Overflow::sat, false};
  use.count = std::uint64_t{1} << 40;
  use.min = -0.0;
  use.max = 65535.99;
  use.used_bits = 16;
  use.zeros = 3;
  use.octave[70] = 99;
  r.registers.push_back(use);
  r.metrics = {{"span.u.max", error}, {"depth.z.sqnr_db", inf}, {"a.b.c", -inf},   {"x.y.z", nan},
               {"zero", -0.0},        {"tiny", 5e-324},         {"third", 1.0 / 3}};
  return r;
}

PointRow some_point(const std::string& hash) {
  return {hash, "c" + hash, "[raster]\n", "[]", true, "", 0.25};
}

void put(Store& store, const std::string& hash, double error = 0.1) {
  const PointResult result = some_result(error);
  store.put_point(some_point(hash), &result);
}

// "h7"
std::string nth(int i) {
  std::string out = "h";
  return out += std::to_string(i);
}

std::string refused(const std::string& path, Store::Mode mode = Store::Mode::create) {
  return input_error([&] { Store(path, "1.2.3", mode, 50ms); });
}

// Costs are kept unasked, but not the estimates of the pixel stages.
TEST(Store, EstimatesOfPixelStagesAreKeptWhereTheyAreAskedFor) {
  PointResult result;
  result.metrics = {{"cost.register_bits", 1}, {"estimate.ecp5.luts", 2}, {"estimate.ecp5.pixel_luts", 3}};
  const auto kept = [&](const std::vector<std::string>& asked) {
    std::vector<std::string> out;
    for (const Row& row : rows_of(result, {.everything = false, .metrics = asked}).metrics)
      out.push_back(text_of(row[0]));
    return out;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(kept({}), (Names{"cost.register_bits", "estimate.ecp5.luts"}));
  EXPECT_EQ(kept({"estimate.ecp5.pixel_luts"}),
            (Names{"cost.register_bits", "estimate.ecp5.luts", "estimate.ecp5.pixel_luts"}));
}

TEST(Store, KeepsAPointWithEveryBit) {
  const TemporaryFolder folder;
  const PointResult result = some_result(0.1);
  {
    Store store(folder.path("a.db"), "1.2.3");
    store.put_point(some_point("h1"), &result);
    PointRow refusal = some_point("h2");
    refusal.ok = false;
    refusal.message = "too narrow";
    store.put_point(refusal, nullptr);
  }
  Store store(folder.path("a.db"), "1.2.4", Store::Mode::existing);
  EXPECT_EQ(store.result_rows("h1"), rows_of(result));
  EXPECT_NE(store.result_rows("h1"), rows_of(some_result(std::nextafter(0.1, 1.0))));
  const Metrics metrics = store.metrics("h1").all;
  ASSERT_EQ(metrics.size(), result.metrics.size());
  EXPECT_EQ(metrics.at("span.u.max"), 0.1);
  EXPECT_EQ(metrics.at("depth.z.sqnr_db"), inf);
  EXPECT_EQ(metrics.at("a.b.c"), -inf);
  EXPECT_TRUE(std::isnan(metrics.at("x.y.z")));
  EXPECT_EQ(metrics.at("tiny"), 5e-324);
  EXPECT_EQ(metrics.at("third"), 1.0 / 3);
  // As others read it.
  EXPECT_EQ(
      store.rows("SELECT unit, better, role, field FROM known_metrics WHERE name = 'span.u.sqnr_db'")[0],
      (Row{std::string("dB"), std::string("high"), std::string("result"), std::string("span.u")}));
  EXPECT_EQ(integer_of(store.rows("SELECT count(*) FROM known_metrics")[0][0]),
            static_cast<std::int64_t>(known_metrics().size()));
  EXPECT_EQ(store.rows("SELECT typeof(value) FROM metrics WHERE hash = 'h1' AND name = 'x.y.z'")[0][0],
            Cell(std::string("null")));
  EXPECT_EQ(store.rows("SELECT value FROM metrics WHERE name = 'a.b.c'")[0][0], Cell(std::string("-inf")));
  const auto p = store.point("h1");
  ASSERT_TRUE(p);
  EXPECT_TRUE(p->ok);
  EXPECT_EQ(p->config_hash, "ch1");
  EXPECT_EQ(p->config, "[raster]\n");
  EXPECT_EQ(p->seconds, 0.25);
  const auto r = store.point("h2");
  ASSERT_TRUE(r);
  EXPECT_FALSE(r->ok);
  EXPECT_EQ(r->message, "too narrow");
  EXPECT_FALSE(store.point("h3"));
  EXPECT_EQ(store.points_like("h").size(), 2U);
  EXPECT_EQ(store.points_like("h2"), std::vector<std::string>{"h2"});
  EXPECT_TRUE(store.points_like("%").empty());
}

TEST(Store, APointReplacesTheOneBefore) {
  const TemporaryFolder folder;
  Store store(folder.path("a.db"), "1");
  put(store, "h", 0.5);
  put(store, "h", 0.25);
  EXPECT_EQ(store.result_rows("h"), rows_of(some_result(0.25)));
  EXPECT_EQ(integer_of(store.rows("SELECT count(*) FROM points")[0][0]), 1);
}

TEST(Store, CellsOfEachKindComeBack) {
  const TemporaryFolder folder;
  Store store(folder.path("a.db"), "1");
  const std::vector<std::uint8_t> png{0, 1, 255, 0};
  store.run("INSERT INTO pictures VALUES(?, ?, ?, ?)",
            {std::string("h"), std::string("s'\"\n"), std::string("ideal"), png});
  store.run("INSERT INTO pictures VALUES(?, ?, ?, ?)",
            {std::string("h"), std::string("t"), std::monostate{}, std::vector<std::uint8_t>{}});
  const auto rows = store.rows("SELECT scene, name, png FROM pictures ORDER BY rowid");
  EXPECT_EQ(rows[0], (Row{std::string("s'\"\n"), std::string("ideal"), png}));
  EXPECT_EQ(rows[1], (Row{std::string("t"), std::monostate{}, std::vector<std::uint8_t>{}}));
  store.run("INSERT INTO bounds VALUES('h', 'p', 'u', ?, ?)", {inf, nan});
  EXPECT_EQ(store.rows("SELECT bound, observed FROM bounds")[0], (Row{std::string("inf"), std::monostate{}}));
  EXPECT_EQ(number_of(std::string("inf")), inf);
  EXPECT_EQ(number_of(std::int64_t{3}), 3);
  EXPECT_TRUE(std::isnan(number_of(std::monostate{})));
  EXPECT_TRUE(std::isnan(number_of(std::string("x"))));
  EXPECT_TRUE(names(input_error([&] { store.run("SELECT nonsense"); }), "a.db: no such column"));
}

TEST(Store, ATransactionIsAllOrNothing) {
  const TemporaryFolder folder;
  Store store(folder.path("a.db"), "1");
  EXPECT_THROW(store.transaction([&] {
    put(store, "h1");  // nested
    throw std::runtime_error("stop");
  }),
               std::runtime_error);
  EXPECT_FALSE(store.point("h1"));
  store.transaction([&] { put(store, "h2"); });
  EXPECT_TRUE(store.point("h2"));
}

TEST(Store, FilesThatAreNoStudiesAreRefusedUntouched) {
  const TemporaryFolder folder;
  const std::string text = folder.write("text.db", std::string(5000, 'x'));
  EXPECT_TRUE(names(refused(text), "text.db: is damaged, or no SQLite database"));
  EXPECT_EQ(folder.read("text.db"), std::string(5000, 'x'));
  const std::string other = folder.path("other.db");
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(other.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "CREATE TABLE mail(x)", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(db);
  const std::string before = folder.read("other.db");
  EXPECT_TRUE(names(refused(other), "other.db: is a database, but not of studies"));
  EXPECT_EQ(folder.read("other.db"), before);
  {
    Store store(folder.path("later.db"), "9.9");
    store.run("UPDATE meta SET value = ? WHERE key = 'schema'", {std::to_string(Store::schema + 1)});
  }
  EXPECT_TRUE(names(refused(folder.path("later.db")),
                    fmt::format("has schema {}, made by another version", Store::schema + 1)));
  EXPECT_TRUE(names(refused(folder.path()), "is a directory"));
  EXPECT_TRUE(names(refused(folder.path("no/such/a.db")), "cannot be opened as a database: No such file"));
  EXPECT_TRUE(names(refused(folder.path("none.db"), Store::Mode::existing), "none.db: no such database"));
  EXPECT_FALSE(fs::exists(folder.path("none.db")));
  folder.write("empty.db", "");
  EXPECT_TRUE(names(refused(folder.path("empty.db"), Store::Mode::existing), "holds no study"));
  EXPECT_TRUE(names(refused(""), "needs a name"));
}

TEST(Store, ADamagedDatabaseIsRefusedUntouched) {
  const TemporaryFolder folder;
  {
    Store store(folder.path("a.db"), "1");
    for (int i = 0; i < 200; ++i) put(store, nth(i));
  }
  const std::string whole = folder.read("a.db");
  ASSERT_GT(whole.size(), 100000U);
  // Cut in half; and a page of the middle overwritten.
  folder.write("cut.db", whole.substr(0, whole.size() / 2));
  EXPECT_TRUE(names(refused(folder.path("cut.db")), "cut.db: is damaged"));
  std::string scratched = whole;
  scratched.replace(40960, 4096, std::string(4096, '\x5a'));
  folder.write("scratched.db", scratched);
  EXPECT_TRUE(names(refused(folder.path("scratched.db")), "scratched.db: is damaged"));
  EXPECT_EQ(folder.read("scratched.db"), scratched);
}

TEST(Store, ALockedDatabaseIsWaitedForAndThenRefused) {
  const TemporaryFolder folder;
  Store store(folder.path("a.db"), "1", Store::Mode::create, 50ms);
  put(store, "h1");
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(folder.path("a.db").c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(names(input_error([&] { put(store, "h2"); }), "a.db: is locked by another program"));
  EXPECT_GE(std::chrono::steady_clock::now() - start, 40ms);
  EXPECT_TRUE(names(refused(folder.path("a.db")), "locked"));
  EXPECT_TRUE(store.point("h1"));
  ASSERT_EQ(sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(db);
  put(store, "h2");
  EXPECT_TRUE(store.point("h2"));
}

TEST(Store, AFullDiskLosesNothing) {
  const TemporaryFolder folder;
  int kept = 0;
  {
    Store store(folder.path("a.db"), "1");
    const auto pages = integer_of(store.rows("PRAGMA page_count")[0][0]);
    store.run("PRAGMA max_page_count = " + std::to_string(pages + 40));
    std::string message;
    for (; kept < 1000 && message.empty(); ++kept) {
      try {
        put(store, nth(kept));
      } catch (const InputError& error) {
        message = error.what();
        break;
      }
    }
    EXPECT_TRUE(names(message, "a.db: the disk is full")) << message;
    EXPECT_GT(kept, 5);
    EXPECT_FALSE(store.point(nth(kept)));
  }
  Store store(folder.path("a.db"), "1");
  for (int i = 0; i < kept; ++i) {
    EXPECT_EQ(store.result_rows(nth(i)), rows_of(some_result(0.1))) << i;
  }
  put(store, nth(kept));  // there is room again
}

TEST(Store, AKilledWriterLosesNoFinishedPoint) {
  const TemporaryFolder folder;
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Store store(folder.path("a.db"), "1");
    for (int i = 0; i < 20; ++i) put(store, nth(i));
    store.run("BEGIN IMMEDIATE");  // in the middle of the next one
    store.run("INSERT INTO point_rows(hash, status) VALUES('half', 'ok')");
    static_cast<void>(!::write(pipe[1], "x", 1));
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(pipe[0], &byte, 1), 1);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  close(pipe[0]);
  close(pipe[1]);
  Store store(folder.path("a.db"), "1", Store::Mode::existing, 50ms);
  EXPECT_EQ(integer_of(store.rows("SELECT count(*) FROM points")[0][0]), 20);
  EXPECT_EQ(store.result_rows("h19"), rows_of(some_result(0.1)));
  EXPECT_FALSE(store.point("half"));
  put(store, "h20");
}

}  // namespace
}  // namespace bitspan
