// SPDX-License-Identifier: Apache-2.0
#include "study/store.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "io/json_depth.hpp"
#include "study/family.hpp"
#include "study/metrics.hpp"
#include "study/settings.hpp"

namespace bitspan {
namespace {

// The areas of one part of the RTL.
#define BITSPAN_AREA_TABLE(name)                                                                           \
  "CREATE TABLE IF NOT EXISTS " name                                                                       \
  "(config_hash TEXT, area_key TEXT, family TEXT, placed INTEGER, status TEXT, message TEXT, tools TEXT, " \
  "luts INTEGER, ffs INTEGER, multipliers INTEGER, memory_bits INTEGER, fmax_mhz REAL, seconds REAL, "     \
  "PRIMARY KEY(config_hash, family, placed))"

// A table that is read by its key alone is WITHOUT ROWID. The others keep the order of their writing.
constexpr auto tables = std::to_array<const char*>({
    "CREATE TABLE IF NOT EXISTS meta(key TEXT PRIMARY KEY, value TEXT)",
    "CREATE TABLE IF NOT EXISTS configurations(config_hash TEXT PRIMARY KEY, config TEXT) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS scene_sets(id INTEGER PRIMARY KEY, scenes TEXT UNIQUE)",
    "CREATE TABLE IF NOT EXISTS asks(id INTEGER PRIMARY KEY, everything INTEGER, metrics TEXT, "
    "UNIQUE(everything, metrics))",
    "CREATE TABLE IF NOT EXISTS point_rows(id INTEGER PRIMARY KEY, hash TEXT UNIQUE, config_hash TEXT, "
    "base_hash TEXT, settings TEXT, scenes INTEGER, asked INTEGER, status TEXT, message TEXT, seconds REAL)",
    "CREATE TABLE IF NOT EXISTS metric_names(id INTEGER PRIMARY KEY, name TEXT UNIQUE)",
    // Scene -1 stands for all together.
    "CREATE TABLE IF NOT EXISTS metric_values(point INTEGER, scene INTEGER, name INTEGER, value REAL, "
    "PRIMARY KEY(point, scene, name)) WITHOUT ROWID",
    "CREATE VIEW IF NOT EXISTS points AS SELECT p.hash AS hash, p.config_hash AS config_hash, "
    "c.config AS config, s.scenes AS scenes, p.status AS status, p.message AS message, p.seconds AS seconds "
    "FROM point_rows p LEFT JOIN scene_sets s ON s.id = p.scenes LEFT JOIN configurations c ON "
    "c.config_hash = p.config_hash",
    "CREATE VIEW IF NOT EXISTS metrics AS SELECT p.hash AS hash, n.name AS name, v.value AS value FROM "
    "point_rows p JOIN metric_values v ON v.point = p.id AND v.scene = -1 JOIN metric_names n ON n.id = "
    "v.name",
    "CREATE VIEW IF NOT EXISTS scene_metrics AS SELECT p.hash AS hash, v.scene AS scene, n.name AS name, "
    "v.value AS value FROM point_rows p JOIN metric_values v ON v.point = p.id AND v.scene >= 0 JOIN "
    "metric_names n ON n.id = v.name",
    "CREATE TABLE IF NOT EXISTS expressions(hash TEXT, text TEXT, value REAL, PRIMARY KEY(hash, text)) "
    "WITHOUT ROWID",
    "CREATE VIEW IF NOT EXISTS point_values AS SELECT hash, name, value FROM metrics UNION ALL SELECT hash, "
    "text, value FROM expressions",
    "CREATE TABLE IF NOT EXISTS known_metrics(name TEXT PRIMARY KEY, i INTEGER, field TEXT, label TEXT, unit "
    "TEXT, "
    "better TEXT, role TEXT, squares_add INTEGER, meaning TEXT)",
    "CREATE TABLE IF NOT EXISTS fields(hash TEXT, stage TEXT, quantity TEXT, unit TEXT, ulp REAL, count "
    "INTEGER)",
    "CREATE INDEX IF NOT EXISTS fields_hash ON fields(hash)",
    "CREATE TABLE IF NOT EXISTS registers(hash TEXT, name TEXT, format TEXT, word INTEGER, int INTEGER, "
    "signed INTEGER, count INTEGER, min REAL, max REAL, used_bits INTEGER, headroom INTEGER, wraps INTEGER, "
    "saturations INTEGER, zeros INTEGER, octaves TEXT)",
    "CREATE INDEX IF NOT EXISTS registers_hash ON registers(hash)",
    "CREATE TABLE IF NOT EXISTS studies(name TEXT PRIMARY KEY, plan TEXT, kind TEXT, base_hash TEXT, "
    "cost TEXT)",
    "CREATE TABLE IF NOT EXISTS axes(study TEXT, axis INTEGER, i INTEGER, key TEXT, base TEXT, "
    "name TEXT, \"offset\" INTEGER, PRIMARY KEY(study, axis, i))",
    "CREATE TABLE IF NOT EXISTS constraints(study TEXT, i INTEGER, metric TEXT, at_most NUMERIC, at_least "
    "NUMERIC, over TEXT, PRIMARY KEY(study, i))",
    "CREATE TABLE IF NOT EXISTS study_metrics(study TEXT, i INTEGER, name TEXT, PRIMARY KEY(study, i))",
    "CREATE TABLE IF NOT EXISTS study_points(study TEXT, i INTEGER, hash TEXT, settings TEXT, holds INTEGER, "
    "PRIMARY KEY(study, i))",
    "CREATE TABLE IF NOT EXISTS search_steps(study TEXT, i INTEGER, hash TEXT, cost REAL, holds INTEGER, "
    "best INTEGER)",
    "CREATE TABLE IF NOT EXISTS certificate(study TEXT, key TEXT, from_value TEXT, to_value TEXT, hash TEXT, "
    "failed TEXT, settings TEXT, combination TEXT)",
    "CREATE TABLE IF NOT EXISTS combinations(study TEXT, i INTEGER, combination TEXT, hash TEXT, cost REAL, "
    "evaluations INTEGER, stopped_by TEXT, minimal INTEGER, failing TEXT, PRIMARY KEY(study, i))",
    "CREATE TABLE IF NOT EXISTS measured_costs(study TEXT, i INTEGER, hash TEXT, estimated REAL, error REAL, "
    "measured REAL, message TEXT, PRIMARY KEY(study, i))",
    "CREATE TABLE IF NOT EXISTS recommended(study TEXT, hash TEXT, reason TEXT, verified TEXT)",
    "CREATE TABLE IF NOT EXISTS findings(study TEXT, hash TEXT, line TEXT)",
    "CREATE TABLE IF NOT EXISTS validation(study TEXT, hash TEXT, scene TEXT, i INTEGER, value REAL, holds "
    "INTEGER)",
    "CREATE TABLE IF NOT EXISTS budget(hash TEXT, quantisation TEXT, metric TEXT, base REAL, without REAL, "
    "alone REAL)",
    "CREATE TABLE IF NOT EXISTS bounds(hash TEXT, place TEXT, unit TEXT, bound REAL, observed REAL)",
    BITSPAN_AREA_TABLE("areas"),
    BITSPAN_AREA_TABLE("pixel_areas"),
    BITSPAN_AREA_TABLE("late_pixel_areas"),
    "CREATE TABLE IF NOT EXISTS pictures(hash TEXT, scene TEXT, name TEXT, png BLOB, "
    "PRIMARY KEY(hash, scene, name))",
    "CREATE TABLE IF NOT EXISTS causes(hash TEXT, scene TEXT, i INTEGER, name TEXT, color TEXT, pixels "
    "INTEGER)",
});

#undef BITSPAN_AREA_TABLE

// Returns the cell of a double. SQLite would change a NaN and the infinities on their way, so they are
// written otherwise. A zero loses its sign, but stays equal.
Cell stored(double value) {
  if (std::isnan(value)) return std::monostate{};
  if (std::isinf(value)) return std::string(value < 0 ? "-inf" : "inf");
  return value;
}

Cell stored(std::uint64_t count) { return static_cast<std::int64_t>(count); }
Cell stored(int value) { return static_cast<std::int64_t>(value); }

std::string format_text(const Format& f) {
  return fmt::format("{}{}.{} {} {}", f.is_signed ? 's' : 'u', f.integer, f.fraction(), to_string(f.rounding),
                     to_string(f.overflow));
}

std::string list_text(std::span<const std::uint64_t> counts) {
  return fmt::format("[{}]", fmt::join(counts, ","));
}

}  // namespace

double number_of(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&cell)) return *real;
  if (const auto* text = std::get_if<std::string>(&cell)) {
    if (*text == "inf") return std::numeric_limits<double>::infinity();
    if (*text == "-inf") return -std::numeric_limits<double>::infinity();
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::int64_t integer_of(const Cell& cell) {
  const auto* integer = std::get_if<std::int64_t>(&cell);
  return integer == nullptr ? 0 : *integer;
}

std::string text_of(const Cell& cell) {
  const auto* text = std::get_if<std::string>(&cell);
  return text == nullptr ? std::string() : *text;
}

bool Asked::covers(const Asked& other) const {
  return (everything || !other.everything) && std::ranges::includes(metrics, other.metrics);
}

Asked both(const Asked& a, const Asked& b) {
  Asked out{a.everything || b.everything, {}};
  std::ranges::set_union(a.metrics, b.metrics, std::back_inserter(out.metrics));
  return out;
}

namespace {

// The metrics of which every point keeps its value.
const std::set<std::string_view>& kept_unasked() {
  static const auto names = [] {
    std::set<std::string_view> out;
    for (const Metric& metric : known_metrics()) {
      const bool of_pixels =
          target_of("estimate", metric.name).value_or(AreaTarget{}).part != AreaPart::spans;
      if (metric.role == MetricRole::cost && !of_pixels) out.insert(metric.name);
    }
    return out;
  }();
  return names;
}

}  // namespace

ResultRows rows_of(const PointResult& result, const Asked& asked) {
  const auto named = [&](const std::string& name) { return std::ranges::binary_search(asked.metrics, name); };
  ResultRows out;
  for (const auto& [name, value] : result.metrics) {
    if (asked.everything || named(name) || kept_unasked().contains(name))
      out.metrics.push_back({name, stored(value)});
  }
  for (std::size_t scene = 0; scene < result.scenes.size(); ++scene) {
    for (const auto& [name, value] : result.scenes[scene].metrics) {
      if (named(name)) out.scenes.push_back({static_cast<std::int64_t>(scene), name, stored(value)});
    }
  }
  if (!asked.everything) return out;
  for (const FieldError& f : result.fields) {
    out.fields.push_back({f.stage, f.quantity, f.unit, stored(f.ulp), stored(f.count)});
  }
  for (const RegisterUse& r : result.registers) {
    out.registers.push_back({r.name, format_text(r.format), stored(r.format.word), stored(r.format.integer),
                             stored(r.format.is_signed ? 1 : 0), stored(r.count), stored(r.min),
                             stored(r.max), stored(r.used_bits), stored(r.headroom), stored(r.wraps),
                             stored(r.saturations), stored(r.zeros), list_text(r.octave)});
  }
  return out;
}

void Store::Close::operator()(sqlite3* db) const { sqlite3_close_v2(db); }
void Store::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

void Store::fail(int code) const {
  const std::string text = db_ ? sqlite3_errmsg(db_.get()) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw InputError(
          fmt::format("{}: is locked by another program, and was for {} s; nothing in it was changed: wait "
                      "for the other, "
                      "or use another --db",
                      path_, std::chrono::duration<double>(wait_).count()));
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      throw InputError(
          fmt::format("{}: is damaged, or no SQLite database ({}); it was left as it is: use another --db, "
                      "or move it away",
                      path_, text));
    case SQLITE_FULL:
      throw InputError(fmt::format(
          "{}: the disk is full ({}); all points finished before are kept, and the same command goes on from "
          "them",
          path_, text));
    case SQLITE_CANTOPEN: {
      const int error_number = db_ ? sqlite3_system_errno(db_.get()) : 0;
      throw InputError(fmt::format("{}: cannot be opened as a database: {}", path_,
                                   error_number != 0 ? std::strerror(error_number) : text.c_str()));
    }
    case SQLITE_READONLY:
      throw InputError(
          fmt::format("{}: cannot be written ({}); expected a file and a folder that can be", path_, text));
    case SQLITE_IOERR: {
      const int error_number = db_ ? sqlite3_system_errno(db_.get()) : 0;
      throw InputError(fmt::format(
          "{}: reading or writing failed ({}{}{}); all points finished before are kept, and the same command "
          "goes on from them",
          path_, text, error_number != 0 ? ": " : "", error_number != 0 ? std::strerror(error_number) : ""));
    }
    default:
      throw InputError(fmt::format("{}: {}", path_, text));
  }
}

Store::Store(const std::string& path, std::string_view version, Mode mode, std::chrono::milliseconds wait)
    : path_(path), wait_(wait) {
  std::error_code error;
  if (path.empty()) throw InputError("a database needs a name");
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a directory; expected a database");
  }
  // SQLite's files beside it have longer names.
  constexpr std::size_t name_limit = 255 - std::string_view("-journal").size();
  if (std::filesystem::path(path).filename().string().size() > name_limit) {
    throw InputError(
        fmt::format("{}: the name is too long; expected at most {} bytes for a database", path, name_limit));
  }
  if (mode == Mode::existing && !std::filesystem::exists(path, error)) {
    throw InputError(path + ": no such database");
  }
  sqlite3* db = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | (mode == Mode::create ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(path.c_str(), &db, flags, nullptr);
  db_.reset(db);  // a handle is to be closed even where the opening failed
  if (code != SQLITE_OK) fail(code);
  sqlite3_busy_timeout(db, static_cast<int>(wait.count()));
  check_file(version, mode);
}

Store::~Store() { statements_.clear(); }

// Checks what is there before anything is written.
void Store::check_file(std::string_view version, Mode mode) {
  const auto check = rows("PRAGMA quick_check(1)");
  if (const std::string result = text_of(check.at(0).at(0)); result != "ok") {
    throw InputError(
        fmt::format("{}: is damaged ({}); it was left as it is: use another --db, or move it away", path_,
                    result.substr(0, result.find('\n'))));
  }
  const auto known = rows("SELECT name FROM sqlite_master WHERE type = 'table'");
  const auto has = [&](const char* name) {
    return std::ranges::any_of(known, [&](const Row& row) { return text_of(row[0]) == name; });
  };
  if (!known.empty() && !has("meta")) {
    throw InputError(path_ + ": is a database, but not of studies; use another --db");
  }
  if (known.empty() && mode == Mode::existing) throw InputError(path_ + ": holds no study");
  if (!known.empty()) {
    const auto found = rows("SELECT value FROM meta WHERE key = 'schema'");
    const std::string value = found.empty() ? "none" : text_of(found[0][0]);
    if (value != std::to_string(schema)) {
      throw InputError(fmt::format(
          "{}: has schema {}, made by another version of bitspan; this one reads schema {}: use another --db",
          path_, value, schema));
    }
  }
  // There is a log beside the file. Readers therefore see finished points while others are written, and a
  // kill leaves the log, from which the next opening goes on.
  static_cast<void>(rows("PRAGMA journal_mode = WAL"));
  run("PRAGMA synchronous = NORMAL");
  if (mode == Mode::existing) return;
  transaction([&] {
    for (const char* sql : tables) run(sql);
    run("INSERT OR IGNORE INTO meta VALUES('schema', ?)", {std::to_string(schema)});
    run("INSERT OR REPLACE INTO meta VALUES('version', ?)", {std::string(version)});
    write_known_metrics();
  });
}

void Store::write_known_metrics() {
  run("DELETE FROM known_metrics");
  std::int64_t i = 0;
  for (const Metric& m : known_metrics()) {
    run("INSERT OR IGNORE INTO metric_names(name) VALUES(?)", {m.name});
    run("INSERT INTO known_metrics VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)",
        {m.name, i++, m.field, m.label, m.unit, std::string(to_string(m.better)),
         std::string(to_string(m.role)), stored(m.squares_add ? 1 : 0), m.meaning});
  }
}

sqlite3_stmt* Store::bound(std::string_view sql, const Row& values) {
  auto& statement = statements_[std::string(sql)];
  if (!statement) {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(db_.get(), sql.data(), static_cast<int>(sql.size()), &made, nullptr);
    if (code != SQLITE_OK) fail(code);
    statement.reset(made);
  }
  sqlite3_stmt* s = statement.get();
  sqlite3_reset(s);  // its result is that of the last use, so it is ignored
  int at = 0;
  for (const Cell& value : values) {
    ++at;
    int code = SQLITE_OK;
    // The row outlives the use of the statement.
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      code = sqlite3_bind_int64(s, at, *integer);
    } else if (const auto* real = std::get_if<double>(&value)) {
      code = sqlite3_bind_double(s, at, *real);
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      code = sqlite3_bind_text64(s, at, text->data(), text->size(), SQLITE_STATIC, SQLITE_UTF8);
    } else if (const auto* blob = std::get_if<std::vector<std::uint8_t>>(&value)) {
      code = sqlite3_bind_blob64(s, at, blob->empty() ? "" : static_cast<const void*>(blob->data()),
                                 blob->size(), SQLITE_STATIC);
    } else {
      code = sqlite3_bind_null(s, at);
    }
    if (code != SQLITE_OK) fail(code);
  }
  return s;
}

std::vector<Row> Store::rows(std::string_view sql, const Row& values) {
  Row bindable = values;
  for (Cell& cell : bindable) {
    if (const auto* real = std::get_if<double>(&cell)) cell = stored(*real);
  }
  sqlite3_stmt* s = bound(sql, bindable);
  std::vector<Row> out;
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(s)) == SQLITE_ROW) {
    Row row;
    for (int c = 0; c < sqlite3_column_count(s); ++c) {
      switch (sqlite3_column_type(s, c)) {
        case SQLITE_INTEGER:
          row.emplace_back(static_cast<std::int64_t>(sqlite3_column_int64(s, c)));
          break;
        case SQLITE_FLOAT:
          row.emplace_back(sqlite3_column_double(s, c));
          break;
        case SQLITE_TEXT: {
          const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(s, c));
          row.emplace_back(std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(s, c))));
          break;
        }
        case SQLITE_BLOB: {
          const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(s, c));
          row.emplace_back(std::vector<std::uint8_t>(bytes, bytes + sqlite3_column_bytes(s, c)));
          break;
        }
        default:
          row.emplace_back(std::monostate{});
      }
    }
    out.push_back(std::move(row));
  }
  if (code != SQLITE_DONE) {
    // Resetting forgets the error's text.
    try {
      fail(code);
    } catch (...) {
      sqlite3_reset(s);
      throw;
    }
  }
  sqlite3_reset(s);
  sqlite3_clear_bindings(s);
  return out;
}

void Store::run(std::string_view sql, const Row& values) { static_cast<void>(rows(sql, values)); }

void Store::transaction(const std::function<void()>& body) {
  if (depth_ > 0) {
    body();
    return;
  }
  run("BEGIN IMMEDIATE");  // takes the lock at once, where waiting for it is safe
  ++depth_;
  try {
    body();
    run("COMMIT");
    --depth_;
  } catch (...) {
    --depth_;
    // SQLite has rolled back already after some errors.
    if (sqlite3_get_autocommit(db_.get()) == 0)
      sqlite3_exec(db_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::optional<PointRow> Store::point(std::string_view hash) {
  const auto found = rows(
      "SELECT config_hash, (SELECT config FROM configurations c WHERE c.config_hash = p.config_hash), "
      "(SELECT scenes FROM scene_sets WHERE id = p.scenes), status, message, seconds, base_hash, settings, "
      "(SELECT config FROM configurations c WHERE c.config_hash = p.base_hash) FROM point_rows p WHERE hash "
      "= ?",
      {std::string(hash)});
  if (found.empty()) return std::nullopt;
  const Row& r = found[0];
  PointRow out{std::string(hash), text_of(r[0]),   text_of(r[1]), text_of(r[2]), text_of(r[3]) == "ok",
               text_of(r[4]),     number_of(r[5]), text_of(r[6]), text_of(r[7])};
  if (out.config.empty() && !out.config_hash.empty()) {
    const Config base = parse_config(text_of(r[8]), path_ + ": base of " + out.hash);
    out.config = to_toml(with_keys(base, parse_settings(out.settings)));
  }
  return out;
}

std::optional<Store::Known> Store::known(std::string_view hash) {
  const auto found = rows(
      "SELECT status, message, everything, metrics FROM point_rows JOIN asks ON asks.id = asked "
      "WHERE hash = ?",
      {std::string(hash)});
  if (found.empty()) return std::nullopt;
  const Row& r = found[0];
  return Known{text_of(r[0]) == "ok", text_of(r[1]), asked_of(r[2], r[3])};
}

Asked Store::asked_of(const Cell& everything, const Cell& metrics) {
  const std::string text = text_of(metrics);
  const auto [at, fresh] = asked_metrics_.try_emplace(text);
  try {
    if (fresh) at->second = nlohmann::json::parse(text).get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception& error) {
    asked_metrics_.erase(at);
    throw InputError(fmt::format("{}: what was asked of a point is unreadable: {}", path_, error.what()));
  }
  return {integer_of(everything) != 0, at->second};
}

void Store::put_asked(std::string_view hash, const Asked& asked) {
  const Cell everything = stored(asked.everything ? 1 : 0);
  const std::string names = nlohmann::json(asked.metrics).dump();
  run("INSERT OR IGNORE INTO asks(everything, metrics) VALUES(?, ?)", {everything, names});
  run("UPDATE point_rows SET asked = (SELECT id FROM asks WHERE everything = ? AND metrics = ?) WHERE hash = "
      "?",
      {everything, names, std::string(hash)});
}

std::vector<std::string> Store::points_like(std::string_view prefix) {
  std::vector<std::string> out;
  for (const Row& row : rows("SELECT hash FROM points WHERE substr(hash, 1, ?) = ? ORDER BY hash",
                             {static_cast<std::int64_t>(prefix.size()), std::string(prefix)})) {
    out.push_back(text_of(row[0]));
  }
  return out;
}

void Store::keep_configuration(const std::string& config_hash, const std::string& toml) {
  run("INSERT OR IGNORE INTO configurations VALUES(?, ?)", {config_hash, toml});
}

void Store::put_point(const PointRow& p, const PointResult* result, const Asked& asked) {
  const ResultRows all = result == nullptr ? ResultRows{} : rows_of(*result, asked);
  transaction([&] {
    for (const char* sql :
         {"DELETE FROM metric_values WHERE point = (SELECT id FROM point_rows WHERE hash = ?)",
          "DELETE FROM fields WHERE hash = ?", "DELETE FROM registers WHERE hash = ?",
          "DELETE FROM point_rows WHERE hash = ?"}) {
      run(sql, {p.hash});
    }
    if (p.base_hash.empty() && !p.config.empty()) keep_configuration(p.config_hash, p.config);
    run("INSERT OR IGNORE INTO scene_sets(scenes) VALUES(?)", {p.scenes});
    run("INSERT INTO point_rows(hash, config_hash, base_hash, settings, scenes, status, message, seconds) "
        "VALUES(?, ?, ?, ?, (SELECT id FROM scene_sets WHERE scenes = ?), ?, ?, ?)",
        {p.hash, p.config_hash, p.base_hash, p.settings, p.scenes, std::string(p.ok ? "ok" : "refused"),
         p.message, p.seconds});
    put_asked(p.hash, asked);
    const auto id = rows("SELECT id FROM point_rows WHERE hash = ?", {p.hash}).at(0).at(0);
    const auto insert_value = [&](const Cell& scene, const Cell& name, const Cell& value) {
      run("INSERT OR IGNORE INTO metric_names(name) VALUES(?)", {name});
      run("INSERT INTO metric_values VALUES(?, ?, (SELECT id FROM metric_names WHERE name = ?), ?)",
          {id, scene, name, value});
    };
    for (const Row& row : all.metrics) insert_value(std::int64_t{-1}, row[0], row[1]);
    for (const Row& row : all.scenes) insert_value(row[0], row[1], row[2]);
    const auto insert = [&](const char* sql, const std::vector<Row>& table) {
      for (const Row& row : table) {
        Row values{p.hash};
        values.insert(values.end(), row.begin(), row.end());
        run(sql, values);
      }
    };
    insert("INSERT INTO fields VALUES(?, ?, ?, ?, ?, ?)", all.fields);
    insert("INSERT INTO registers VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", all.registers);
  });
}

ResultRows Store::result_rows(std::string_view hash) {
  const Row key{std::string(hash)};
  return {
      rows("SELECT name, value FROM metrics WHERE hash = ? ORDER BY name", key),
      rows("SELECT stage, quantity, unit, ulp, count FROM fields WHERE hash = ? ORDER BY rowid", key),
      rows(
          "SELECT name, format, word, int, signed, count, min, max, used_bits, headroom, wraps, saturations, "
          "zeros, octaves FROM registers WHERE hash = ? ORDER BY rowid",
          key),
      rows("SELECT scene, name, value FROM scene_metrics WHERE hash = ? ORDER BY scene, name", key)};
}

PointMetrics Store::metrics(std::string_view hash) {
  PointMetrics out;
  const Row key{std::string(hash)};
  for (const Row& row : rows("SELECT name, value FROM point_values WHERE hash = ?", key)) {
    out.all[text_of(row[0])] = number_of(row[1]);
  }
  const auto values = rows("SELECT scene, name, value FROM scene_metrics WHERE hash = ?", key);
  if (values.empty()) return out;
  for (const std::string& name : scene_names_of(hash)) out.scenes.push_back({name, {}});
  for (const Row& row : values) {
    const auto scene = static_cast<std::size_t>(integer_of(row[0]));
    if (scene < out.scenes.size()) out.scenes[scene].metrics[text_of(row[1])] = number_of(row[2]);
  }
  return out;
}

const std::vector<std::string>& Store::scene_names_of(std::string_view hash) {
  const std::string text =
      text_of(rows("SELECT scenes FROM points WHERE hash = ?", {std::string(hash)}).at(0).at(0));
  const auto [at, fresh] = scene_names_.try_emplace(text);
  if (!fresh) return at->second;
  try {
    check_json_depth(text);
    for (const auto& scene : nlohmann::json::parse(text)) at->second.push_back(scene.at("name"));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: {}: its scenes are unreadable: {}", path_, hash, error.what()));
  }
  return at->second;
}

void Store::put_expression(std::string_view hash, std::string_view text, double value) {
  run("INSERT OR REPLACE INTO expressions VALUES(?, ?, ?)", {std::string(hash), std::string(text), value});
}

}  // namespace bitspan
