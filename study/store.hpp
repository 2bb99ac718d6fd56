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
};

// A result as the rows of its three tables, without the hash that they begin with.
struct ResultRows {
  std::vector<Row> metrics, fields, registers;
  bool operator==(const ResultRows&) const = default;
};
ResultRows rows_of(const PointResult& result);

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
  // Returns the hashes that begin with the prefix.
  std::vector<std::string> points_like(std::string_view prefix);
  // Replaces what was there by this hash. `result` is null for a refused point.
  void put_point(const PointRow& point, const PointResult* result);
  ResultRows result_rows(std::string_view hash);
  std::map<std::string, double, std::less<>> metrics(std::string_view hash);

  const std::string& path() const { return path_; }

 private:
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
  int depth_ = 0;  // of nested transactions
};

}  // namespace bitspan
