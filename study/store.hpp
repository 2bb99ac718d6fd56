// SPDX-License-Identifier: Apache-2.0
// The database of studies is one SQLite file. A kill at any moment loses no finished point. docs/study.md
// describes its tables.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "study/point.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace bitspan {

// The alternatives are NULL, INTEGER, REAL, TEXT and BLOB. A NaN is written as NULL, and an infinity as the
// text 'inf' or '-inf'.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string, std::vector<std::uint8_t>>;
using Row = std::vector<Cell>;

// Return what a cell holds, whatever kind it has come back as. number_of undoes the writing of NaN and
// infinities.
double number_of(const Cell& cell);
std::int64_t integer_of(const Cell& cell);
std::string text_of(const Cell& cell);

struct PointRow {
  std::string hash, config_hash;
  std::string config;  // TOML; empty where the settings make no legal configuration
  std::string scenes;  // JSON
  bool ok = false;     // false: refused
  std::string message;
  double seconds = 0;
  // The configuration may be kept as what it sets on a base: the base's config_hash, which keep_configuration
  // was given, and JSON (settings_json). Without a base it is kept whole.
  std::string base_hash = {}, settings = {};
};

// What is kept of a measured point.
struct Asked {
  // All metrics over all scenes, the fields' counts and what the registers held; without it, the metrics
  // below and those of MetricRole::cost, but for the estimates of the pixel stages, which are as many as the
  // others.
  bool everything = true;
  std::vector<std::string> metrics = {};  // sorted; these are kept of each scene, too
  // Whether all that `other` asks for is asked for here.
  bool covers(const Asked& other) const;
  bool operator==(const Asked&) const = default;
};
// Returns what asks for both.
Asked both(const Asked& a, const Asked& b);

// A result as the rows of its three tables, without the hash that they begin with.
struct ResultRows {
  std::vector<Row> metrics, fields, registers;
  std::vector<Row> scenes;  // index of the scene, name, value
  bool operator==(const ResultRows&) const = default;
};
ResultRows rows_of(const PointResult& result, const Asked& asked = {});

class Store {
 public:
  enum class Mode { create, existing };
  static constexpr int schema = 4;

  // Opens the file, or makes it (create). Throws InputError where the file is absent (existing), is no
  // database of studies, is damaged, is of another schema, or cannot be written. All functions throw it where
  // another program keeps the file locked for longer than `wait`, or the disk is full. The transaction is
  // then undone, and all before it is kept.
  Store(const std::string& path, std::string_view version, Mode mode = Mode::create,
        std::chrono::milliseconds wait = std::chrono::seconds(5));
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // Run one statement, with its `?` bound to the values in turn. Calls must come from one thread at a time.
  void run(std::string_view sql, const Row& values = {});
  std::vector<Row> rows(std::string_view sql, const Row& values = {});
  // Keeps all that `body` writes or, where it throws, nothing. Nested calls are part of the outermost one.
  void transaction(const std::function<void()>& body);

  std::optional<PointRow> point(std::string_view hash);
  // The same without the configuration, for a look at many points; and what is kept of it.
  struct Known {
    bool ok = false;
    std::string message;
    Asked asked;
    // Whether nothing that is asked for is missing; there is nothing to keep of a refused point.
    bool has(const Asked& other) const { return !ok || asked.covers(other); }
  };
  std::optional<Known> known(std::string_view hash);
  // Returns what was asked as its two columns say it, and writes it of a point that is there.
  Asked asked_of(const Cell& everything, const Cell& metrics);
  void put_asked(std::string_view hash, const Asked& asked);
  // Returns the hashes that begin with the prefix.
  std::vector<std::string> points_like(std::string_view prefix);
  // Replaces what was there by this hash. `result` is null for a refused point.
  void put_point(const PointRow& point, const PointResult* result, const Asked& asked = {});
  void keep_configuration(const std::string& config_hash, const std::string& toml);
  ResultRows result_rows(std::string_view hash);
  // The values of the expressions that were put are among those over all scenes.
  PointMetrics metrics(std::string_view hash);
  // Keeps the value of an expression of a plan at a point.
  void put_expression(std::string_view hash, std::string_view text, double value);

  const std::string& path() const { return path_; }

 private:
  const std::vector<std::string>& scene_names_of(std::string_view hash);
  sqlite3_stmt* bound(std::string_view sql, const Row& values);
  void check_file(std::string_view version, Mode mode);
  void write_known_metrics();
  [[noreturn]] void fail(int code) const;

  struct Close {
    void operator()(sqlite3* db) const;
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::string path_;
  std::chrono::milliseconds wait_;
  std::unique_ptr<sqlite3, Close> db_;
  std::unordered_map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>> statements_;
  std::map<std::string, std::vector<std::string>> scene_names_;    // by the text of a scene set
  std::map<std::string, std::vector<std::string>> asked_metrics_;  // by their text
  int depth_ = 0;                                                  // of nested transactions
};

}  // namespace bitspan
