// SPDX-License-Identifier: Apache-2.0
#include "study/merge.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace bitspan {
namespace {

// The other database may be of an earlier bitspan, which lacks a table; so its schema is asked.

// Returns its tables of which each row belongs to a study.
std::vector<Row> tables_of_a_study(Store& into) {
  return into.rows(
      "SELECT o.name FROM other.sqlite_master o JOIN pragma_table_info(o.name, 'other') c ON c.name = "
      "'study' "
      "WHERE o.type = 'table'");
}

// Returns its tables of which each row belongs to a point or a configuration by its hash, and whether they
// have a key: rows of one key are the same.
std::vector<Row> tables_of_a_hash(Store& into) {
  return into.rows(
      "SELECT o.name, max(c.pk) > 0 FROM other.sqlite_master o JOIN pragma_table_info(o.name, 'other') c "
      "WHERE o.type = 'table' AND o.name <> 'point_rows' GROUP BY o.name "
      "HAVING sum(c.name IN ('hash', 'config_hash')) > 0 AND sum(c.name = 'study') = 0");
}

// Throws where a query, which gives hash, what, and its values here and there, finds a difference.
void refuse_difference(Store& into, const std::string& from, const char* query) {
  const auto found = into.rows(query);
  if (found.empty()) return;
  const auto text = [](const Cell& cell) {
    return std::holds_alternative<std::string>(cell) ? text_of(cell) : fmt::format("{}", number_of(cell));
  };
  const Row& row = found[0];
  throw InputError(
      fmt::format("{}: {} of point {} is {}, and {} in {}; legal: points measured by the same bitspan", from,
                  text_of(row[1]), text_of(row[0]), text(row[3]), text(row[2]), into.path()));
}

void check_points(Store& into, const std::string& from) {
  for (const char* query :
       {"SELECT hash, 'the status', m.status, o.status FROM other.point_rows o JOIN main.point_rows m USING "
        "(hash) "
        "WHERE m.status IS NOT o.status LIMIT 1",
        "SELECT o.hash, o.name, m.value, o.value FROM other.metrics o JOIN main.metrics m ON m.hash = o.hash "
        "AND "
        "m.name = o.name WHERE m.value IS NOT o.value LIMIT 1",
        "SELECT o.hash, o.name, m.value, o.value FROM other.scene_metrics o JOIN main.scene_metrics m ON "
        "m.hash = "
        "o.hash AND m.scene = o.scene AND m.name = o.name WHERE m.value IS NOT o.value LIMIT 1"}) {
    refuse_difference(into, from, query);
  }
}

// What both asked for of a point is there after the merge.
void join_asks(Store& into) {
  const auto differing = into.rows(
      "SELECT hash, oa.everything, oa.metrics FROM other.point_rows o JOIN main.point_rows m USING (hash) "
      "JOIN "
      "other.asks oa ON oa.id = o.asked JOIN main.asks ma ON ma.id = m.asked WHERE oa.everything <> "
      "ma.everything OR "
      "oa.metrics <> ma.metrics");
  for (const Row& row : differing) {
    const std::string hash = text_of(row[0]);
    into.put_asked(hash, both(into.known(hash)->asked, into.asked_of(row[1], row[2])));
  }
}

void copy_points(Store& into) {
  into.run("INSERT OR IGNORE INTO main.scene_sets(scenes) SELECT scenes FROM other.scene_sets ORDER BY id");
  into.run("INSERT OR IGNORE INTO main.metric_names(name) SELECT name FROM other.metric_names ORDER BY id");
  into.run(
      "INSERT OR IGNORE INTO main.asks(everything, metrics) SELECT everything, metrics FROM other.asks ORDER "
      "BY id");
  join_asks(into);
  into.run(
      "INSERT OR IGNORE INTO main.point_rows(hash, config_hash, base_hash, settings, scenes, asked, status, "
      "message, "
      "seconds) SELECT p.hash, p.config_hash, p.base_hash, p.settings, (SELECT m.id FROM main.scene_sets m "
      "JOIN "
      "other.scene_sets o USING (scenes) WHERE o.id = p.scenes), (SELECT m.id FROM main.asks m JOIN "
      "other.asks o USING "
      "(everything, metrics) WHERE o.id = p.asked), p.status, p.message, p.seconds FROM other.point_rows p "
      "ORDER BY "
      "p.id");
  into.run(
      "INSERT OR IGNORE INTO main.metric_values SELECT mp.id, v.scene, mn.id, v.value FROM other.point_rows "
      "op JOIN "
      "main.point_rows mp USING (hash) JOIN other.metric_values v ON v.point = op.id JOIN other.metric_names "
      "o ON o.id "
      "= v.name JOIN main.metric_names mn ON mn.name = o.name");
  for (const Row& row : tables_of_a_hash(into)) {
    const std::string table = text_of(row[0]);
    into.run(
        integer_of(row[1]) != 0
            ? fmt::format("INSERT OR IGNORE INTO main.{0} SELECT * FROM other.{0}", table)
            : fmt::format("INSERT INTO main.{0} SELECT * FROM other.{0} WHERE hash NOT IN (SELECT hash FROM "
                          "main.{0}) ORDER BY rowid",
                          table));
  }
}

void copy_studies(Store& into, const std::string& from) {
  for (const Row& study : into.rows("SELECT name, plan FROM other.studies")) {
    const Row name{study[0]};
    const auto own = into.rows("SELECT plan FROM main.studies WHERE name = ?", name);
    if (own.empty()) {
      into.run("INSERT INTO main.studies SELECT * FROM other.studies WHERE name = ?", name);
      for (const Row& row : tables_of_a_study(into)) {
        into.run(fmt::format("INSERT INTO main.{0} SELECT * FROM other.{0} WHERE study = ?", text_of(row[0])),
                 name);
      }
      continue;
    }
    const bool other_points =
        !into.rows(
                 "SELECT 1 FROM other.study_points o JOIN main.study_points m USING (study, i) WHERE study = "
                 "? AND "
                 "o.hash <> m.hash AND (SELECT kind FROM main.studies WHERE name = study) = 'sweep' LIMIT 1",
                 name)
             .empty();
    if (own[0][0] != study[1] || other_points) {
      throw InputError(
          fmt::format("{}: its study {} is not that of {}: they differ in {}; legal: another --db", from,
                      text_of(study[0]), into.path(), other_points ? "their points" : "their plans"));
    }
    into.run(
        "UPDATE main.study_points AS m SET holds = (SELECT o.holds FROM other.study_points o WHERE o.study = "
        "m.study "
        "AND o.i = m.i AND o.hash = m.hash) WHERE study = ? AND holds IS NULL",
        name);
  }
}

}  // namespace

Merged merge_database(Store& into, const std::string& from, std::string_view version) {
  std::error_code ignored;
  if (std::filesystem::equivalent(from, into.path(), ignored)) {
    throw InputError(from + ": is the database that the others are merged into; legal: others");
  }
  { const Store checked(from, version, Store::Mode::existing); }
  into.run("ATTACH DATABASE ? AS other", {from});
  const auto count = [&](const char* query) {
    return static_cast<std::size_t>(integer_of(into.rows(query)[0][0]));
  };
  Merged out;
  try {
    into.transaction([&] {
      out.points = count("SELECT count(*) FROM other.point_rows");
      const std::size_t before = count("SELECT count(*) FROM main.point_rows");
      check_points(into, from);
      copy_points(into);
      copy_studies(into, from);
      out.fresh = count("SELECT count(*) FROM main.point_rows") - before;
    });
  } catch (...) {
    into.run("DETACH DATABASE other");
    throw;
  }
  into.run("DETACH DATABASE other");
  return out;
}

}  // namespace bitspan
