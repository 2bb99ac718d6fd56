// SPDX-License-Identifier: Apache-2.0
#include "study/sweep.hpp"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <thread>
#include <type_traits>

#include "config/fnv.hpp"
#include "io/json_depth.hpp"
#include "scene/tri_stream.hpp"
#include "study/expression.hpp"
#include "study/metrics.hpp"

namespace bitspan {
namespace {

// Returns the digest of all that a point is measured with but its configuration.
std::string digest_of(const std::vector<Scene>& scenes, std::string_view version) {
  Fnv128 h;
  h.text("bitspan point");
  h.text(version);
  h.number(measurement_version);
  // A point measured before a metric was declared is measured again.
  for (const Metric& metric : known_metrics()) h.text(metric.name);
  h.number(static_cast<std::uint64_t>(scenes.size()));
  for (const Scene& scene : scenes) h.text(scene_hash(scene));
  return h.hex();
}

std::string hash_of(std::string_view digest, std::string_view what, std::string_view text) {
  Fnv128 h;
  h.text(digest);
  h.text(what);
  h.text(text);
  return h.hex();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string csv_number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string cell_text(const Cell& cell) {
  if (std::holds_alternative<std::monostate>(cell)) return "nothing";
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return fmt::format("{}", number_of(cell));
}

std::string value_json(const KeyValue& value) {
  return std::visit([](const auto& v) { return nlohmann::json(v).dump(); }, value);
}

}  // namespace

std::string scene_hash(const Scene& scene) {
  Fnv128 h;
  h.number(scene.width);
  h.number(scene.height);
  h.number(scene.s_min);
  h.number(scene.s_max);
  h.number(scene.focal);
  for (const std::uint8_t code : scene.background) h.byte(code);
  h.byte(scene.fog ? 1 : 0);
  if (scene.fog) {
    for (const std::uint8_t code : scene.fog->color) h.byte(code);
    h.number(scene.fog->distance);
  }
  if (scene.projector) {
    h.text("projector");
    h.number(scene.projector->s_min);
    h.number(scene.projector->s_max);
  }
  if (scene.light) {
    h.text(scene.light->is_point ? "light at" : "light from");
    for (const double part : scene.light->place) h.number(part);
    h.number(scene.light->ambient);
    h.number(scene.light->specular);
    h.number(scene.light->exponent);
  }
  h.number(static_cast<std::uint64_t>(scene.textures.size()));
  for (const Texture& texture : scene.textures) {
    h.number(texture.width);
    h.number(texture.height);
    for (const std::uint8_t code : texture.rgba) h.byte(code);
    if (texture.format == TexelFormat::rgba8888) continue;
    h.byte(static_cast<std::uint8_t>(texture.format));
    for (const std::uint8_t byte : texture.raw) h.byte(byte);
    for (const std::int16_t value : texture.table) h.number(static_cast<std::uint64_t>(value));
  }
  h.number(static_cast<std::uint64_t>(scene.triangles.size()));
  for (const Triangle& triangle : scene.triangles) {
    h.number(triangle.texture);
    for (const Vertex& v : triangle.v) {
      for (const double value : {v.x, v.y, v.s, v.u, v.v}) h.number(value);
      for (const double value : v.c) h.number(value);
      for (const GivenAttribute& given : given_attributes) {
        if (given.is_given(triangle.v)) h.number(v.*given.member);
      }
    }
  }
  for (const DrawCommand& command : scene.commands) {
    h.number(static_cast<std::uint64_t>(command.before));
    h.text(command_text(command));
  }
  return h.hex();
}

Scene with_s_ratio(Scene scene, double ratio) {
  if (scene.projector || changes_scene(scene.commands)) {
    throw InputError(fmt::format("{}: {} would move what is projected; expected scenes without a projector",
                                 scene.name, s_ratio_key));
  }
  if (ratio == scene.s_max / scene.s_min) return scene;
  const double power = std::log(ratio) / std::log(scene.s_max / scene.s_min);
  const double s_max = scene.s_min * ratio;
  const auto stretched = [&](double s) { return scene.s_min * std::pow(s / scene.s_min, power); };
  for (Triangle& triangle : scene.triangles) {
    for (Vertex& v : triangle.v) v.s = std::clamp(stretched(v.s), scene.s_min, s_max);
  }
  if (scene.fog) scene.fog->distance = stretched(scene.fog->distance);
  scene.s_max = s_max;
  return scene;
}

std::string scenes_json(const std::vector<Scene>& scenes, std::optional<double> s_ratio) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Scene& scene : scenes) {
    nlohmann::ordered_json one{
        {"name", scene.name}, {"width", scene.width}, {"height", scene.height}, {"hash", scene_hash(scene)}};
    if (s_ratio) one["s_ratio"] = *s_ratio;
    out.push_back(std::move(one));
  }
  return out.dump();
}

std::optional<double> s_ratio_of(std::string_view scenes_json) {
  try {
    check_json_depth(scenes_json);
    const auto scenes = nlohmann::json::parse(scenes_json);
    if (scenes.at(0).contains("s_ratio")) return scenes[0]["s_ratio"].get<double>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(std::string("a point's scenes are unreadable: ") + error.what());
  }
  return std::nullopt;
}

std::string point_hash(const Config& config, const std::vector<Scene>& scenes, std::string_view version) {
  return hash_of(digest_of(scenes, version), "configuration", config_hash(config));
}

PointRunner::PointRunner(Config base, std::vector<Scene> scenes, MakeMeter make_meter, Store& store,
                         std::string version, Asked asked)
    : base_(std::move(base)),
      make_meter_(std::move(make_meter)),
      store_(store),
      claims_(store.path()),
      version_(std::move(version)),
      asked_(std::move(asked)),
      base_hash_(config_hash(base_)) {
  store_.keep_configuration(base_hash_, to_toml(base_));
  if (scenes.empty()) throw InputError("a study without scenes: name at least one");
  Stretched& own = stretched_[std::nullopt];
  own.digest = digest_of(scenes, version_);
  own.json = scenes_json(scenes, std::nullopt);
  own.scenes = std::move(scenes);
}

PointRunner::Stretched& PointRunner::stretched(std::optional<double> s_ratio) {
  const auto found = stretched_.find(s_ratio);
  if (found != stretched_.end()) return found->second;
  Stretched made;
  for (const Scene& scene : stretched_.at(std::nullopt).scenes) {
    made.scenes.push_back(with_s_ratio(scene, *s_ratio));
  }
  made.digest = digest_of(made.scenes, version_);
  made.json = scenes_json(made.scenes, s_ratio);
  return stretched_.emplace(s_ratio, std::move(made)).first->second;
}

const Measure& PointRunner::meter_of(std::optional<double> s_ratio) {
  if (!meter_ || meter_ratio_ != s_ratio) {
    meter_ = nullptr;  // frees the room of the previous meter first
    meter_ = make_meter_(stretched(s_ratio).scenes);
    meter_ratio_ = s_ratio;
  }
  return meter_;
}

Point PointRunner::prepare(const std::vector<KeySetting>& settings) {
  return std::move(prepare_all({settings})[0]);
}

std::vector<Point> PointRunner::prepare_all(const std::vector<std::vector<KeySetting>>& settings) {
  std::vector<Point> out(settings.size());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    for (const KeySetting& s : settings[i]) {
      if (s.path != s_ratio_key) {
        out[i].settings.push_back(s);
      } else if (const auto* integer = std::get_if<std::int64_t>(&s.value)) {
        out[i].s_ratio = static_cast<double>(*integer);
      } else {
        out[i].s_ratio = std::get<double>(s.value);
      }
    }
    static_cast<void>(stretched(out[i].s_ratio));
  }
  tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t i) {
    Point& point = out[i];
    const std::string& digest = stretched_.at(point.s_ratio).digest;
    try {
      point.config = with_keys(base_, point.settings);
      point.hash = hash_of(digest, "configuration", config_hash(*point.config));
    } catch (const InputError& error) {
      point.refusal = error.what();
      point.hash = hash_of(digest, "settings of " + base_hash_, settings_json(point.settings));
    }
  });
  return out;
}

std::vector<Evaluated> PointRunner::run(const std::vector<Point>& points, const RunOptions& options,
                                        const std::function<void(std::size_t, const Evaluated&)>& finished) {
  std::vector<Evaluated> out(points.size());
  const auto finish = [&](std::size_t i, Evaluated result) {
    out[i] = std::move(result);
    if (finished) finished(i, out[i]);
  };
  // `waiting` has, by hash, the indices that wait for the point, and what they ask for. `todo` has the first
  // of each, in their order, with the points of equally stretched scenes together.
  struct Waiting {
    std::vector<std::size_t> points;
    Asked asked;
  };
  std::map<std::string, Waiting, std::less<>> waiting;
  std::vector<std::size_t> todo;
  const auto answer = [&](const std::vector<std::size_t>& same, const Store::Known& row) {
    for (const std::size_t i : same) {
      finish(i, {row.ok ? PointState::ok : PointState::refused, true, row.message});
    }
  };
  // A transaction each for so many: one alone takes as long as the look, and other programs wait for it.
  constexpr std::size_t looks = 200;
  for (std::size_t from = 0; from < points.size(); from += looks) {
    store_.transaction([&] {
      for (std::size_t i = from; i < std::min(from + looks, points.size()); ++i) {
        const Point& p = points[i];
        const Asked asked{asked_.everything || p.whole, asked_.metrics};
        if (const auto found = waiting.find(p.hash); found != waiting.end()) {
          found->second.points.push_back(i);
          found->second.asked = both(found->second.asked, asked);
        } else if (const auto row = store_.known(p.hash); row && row->has(asked)) {
          answer({i}, *row);
        } else {
          waiting[p.hash] = {{i}, asked};
          todo.push_back(i);
        }
      }
    });
  }
  std::ranges::stable_sort(todo, {}, [&](std::size_t i) { return points[i].s_ratio; });
  todo.resize(std::min(todo.size(), options.limit));

  std::mutex mutex;  // guards the database, `finished` and progress
  std::size_t done = 0;
  const auto tell = [&] {
    ++done;
    if (options.progress) options.progress(done, todo.size());
  };
  // Whether another program has measured a point since the look above.
  const auto known_meanwhile = [&](std::size_t i) {
    const std::lock_guard lock(mutex);
    Waiting& all = waiting.at(points[i].hash);
    const auto row = store_.known(points[i].hash);
    if (!row) return false;
    if (!row->has(all.asked)) {
      all.asked = both(row->asked, all.asked);  // what was kept for another study stays
      return false;
    }
    store_.transaction([&] { answer(all.points, *row); });
    tell();
    return true;
  };
  const auto keep = [&](std::size_t i, const PointRow& row, const PointResult* result) {
    const std::lock_guard lock(mutex);
    const Waiting& all = waiting.at(row.hash);
    store_.put_point(row, result, all.asked);
    store_.transaction([&] {
      for (const std::size_t same : all.points) {
        finish(same, {row.ok ? PointState::ok : PointState::refused, same != i, row.message});
      }
    });
    tell();
  };
  const auto measure = [&](std::size_t i, const Measure& meter, const std::string& json) {
    const Point& p = points[i];
    PointRow row{p.hash, "", "", json, false, p.refusal, 0};
    if (!p.config) {
      keep(i, row, nullptr);
      return;
    }
    row.config_hash = config_hash(*p.config);
    row.base_hash = base_hash_;
    row.settings = settings_json(p.settings);
    const auto start = std::chrono::steady_clock::now();
    try {
      const PointResult result = meter(*p.config);
      row.ok = true;
      row.seconds = seconds_since(start);
      keep(i, row, &result);
    } catch (const InputError& error) {
      if (row.ok) throw;  // the database threw it
      row.message = error.what();
      row.seconds = seconds_since(start);
      keep(i, row, nullptr);
    }
  };

  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  tbb::task_arena arena(threads);
  std::atomic<bool> failed{false};
  // Measures `now`, and returns what other programs are measuring.
  const auto measure_all = [&](std::span<const std::size_t> now, const Measure& meter,
                               const std::string& json) {
    std::vector<std::size_t> claimed;
    // Each worker takes the next point in order, so that a run that is stopped leaves the rest.
    std::atomic<std::size_t> next{0};
    const auto take_next = [&](std::size_t i) {
      const std::string& hash = points[i].hash;
      if (!claims_.take(hash)) {
        const std::lock_guard lock(mutex);
        claimed.push_back(i);
        return;
      }
      try {
        if (!known_meanwhile(i)) measure(i, meter, json);
      } catch (...) {
        claims_.give_back(hash);
        throw;
      }
      claims_.give_back(hash);
    };
    arena.execute([&] {
      tbb::parallel_for(0, threads, [&](int) {
        while (!failed && !options.stop.stop_requested()) {
          const std::size_t at = next++;
          if (at >= now.size()) break;
          try {
            // A point that waits for tasks of its own must not start another point meanwhile.
            tbb::this_task_arena::isolate([&] { take_next(now[at]); });
          } catch (...) {
            failed = true;
            throw;
          }
        }
      });
    });
    std::ranges::sort(claimed);
    return claimed;
  };
  for (auto first = todo.begin(); first != todo.end() && !options.stop.stop_requested();) {
    const auto s_ratio = points[*first].s_ratio;
    const auto last =
        std::find_if(first, todo.end(), [&](std::size_t i) { return points[i].s_ratio != s_ratio; });
    const std::string& json = stretched(s_ratio).json;
    const Measure& meter = meter_of(s_ratio);
    auto left = measure_all(std::span(first, last), meter, json);
    while (!left.empty() && !options.stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      left = measure_all(left, meter, json);
    }
    first = last;
  }
  return out;
}

Asked asked_of(const StudyPlan& plan) {
  Asked out{plan.metrics.empty(), plan.metrics};
  std::ranges::copy(judged_metrics(plan), std::back_inserter(out.metrics));
  for (std::size_t i = out.metrics.size(); i-- > 0;) {  // an estimate is shown with its ±
    if (std::string error = plus_minus_of(out.metrics[i]); find_metric(error) != nullptr)
      out.metrics.push_back(std::move(error));
  }
  std::ranges::sort(out.metrics);
  out.metrics.erase(std::unique(out.metrics.begin(), out.metrics.end()), out.metrics.end());
  return out;
}

void put_study(const StudyPlan& plan, const std::string& base_hash, Store& store) {
  const auto index = [](std::size_t i) { return static_cast<std::int64_t>(i); };
  const auto limit = [](const std::optional<double>& value) { return value ? Cell(*value) : Cell(); };
  store.transaction([&] {
    for (const char* table : {"axes", "constraints", "study_metrics"}) {
      store.run(fmt::format("DELETE FROM {} WHERE study = ?", table), {plan.name});
    }
    store.run("INSERT OR REPLACE INTO studies VALUES(?, ?, ?, ?, ?)",
              {plan.name, plan.text, std::string(plan.search ? "search" : "sweep"), base_hash,
               plan.search ? plan.search->cost : plan.cost});
    for (std::size_t a = 0; a < plan.axes.size(); ++a) {
      const std::vector<std::string>& keys = plan.axes[a].keys;
      for (std::size_t k = 0; k < keys.size(); ++k) {
        const Cell base = keys[k] == s_ratio_key ? Cell() : value_json(value_of_key(plan.base, keys[k]));
        const auto& offsets = plan.axes[a].offsets;
        store.run("INSERT INTO axes VALUES(?, ?, ?, ?, ?, ?, ?)",
                  {plan.name, index(a), index(k), keys[k], base, plan.axes[a].name,
                   offsets.empty() ? Cell() : Cell(offsets[k])});
      }
    }
    for (std::size_t i = 0; i < plan.constraints.size(); ++i) {
      const Constraint& c = plan.constraints[i];
      store.run("INSERT INTO constraints VALUES(?, ?, ?, ?, ?, ?)",
                {plan.name, index(i), c.metric, limit(c.at_most), limit(c.at_least),
                 std::string(c.over == Over::worst ? "worst" : "pooled")});
    }
    for (std::size_t i = 0; i < plan.metrics.size(); ++i) {
      store.run("INSERT INTO study_metrics VALUES(?, ?, ?)", {plan.name, index(i), plan.metrics[i]});
    }
  });
}

void keep_expressions(const std::string& hash, std::vector<Expression>& expressions, PointMetrics& metrics,
                      Store& store) {
  add_expressions(expressions, metrics);
  for (const Expression& e : expressions) {
    if (const auto found = metrics.all.find(e.text()); found != metrics.all.end()) {
      store.put_expression(hash, e.text(), found->second);
    }
  }
}

SweepResult run_sweep(const StudyPlan& plan, PointRunner& runner, Store& store, const RunOptions& options) {
  auto settings = points_of(plan);
  const std::size_t count = settings.size();
  settings.emplace_back();  // the base
  std::vector<Point> points = runner.prepare_all(settings);
  points.back().whole = true;

  store.transaction([&] {
    put_study(plan, points[count].hash, store);
    // A row that stands keeps what is known of it, for other programs that are at the same study.
    store.run("DELETE FROM study_points WHERE study = ? AND i >= ?",
              {plan.name, static_cast<std::int64_t>(count)});
    for (std::size_t i = 0; i < count; ++i) {
      store.run(
          "INSERT INTO study_points VALUES(?, ?, ?, ?, NULL) ON CONFLICT(study, i) DO UPDATE SET "
          "hash = excluded.hash, settings = excluded.settings, holds = CASE hash WHEN excluded.hash "
          "THEN holds END",
          {plan.name, static_cast<std::int64_t>(i), points[i].hash, settings_json(settings[i])});
    }
  });

  std::vector<std::size_t> numbers;  // of the shard's points
  std::vector<Point> own;
  for (std::size_t i = 0; i <= count; ++i) {
    if ((i == count ? 0 : i % options.shard.count) != options.shard.index) continue;
    numbers.push_back(i);
    own.push_back(std::move(points[i]));
  }

  SweepResult out;
  out.points = numbers.size() - (options.shard.index == 0 ? 1 : 0);
  bool checked = false;  // the metrics' names, on the first point; a later point may lack some
  std::string refusal;
  std::vector<Expression> expressions = expressions_of(plan);
  const auto finished = [&](std::size_t k, const Evaluated& e) {
    const bool is_base = numbers[k] == count;
    bool holds = false;
    if (e.state == PointState::ok) {
      PointMetrics metrics = store.metrics(own[k].hash);
      if (!checked && !is_base) check_metrics(plan, metrics.all);
      checked = checked || !is_base;
      keep_expressions(own[k].hash, expressions, metrics, store);
      holds = all_hold(plan.constraints, metrics);
    }
    if (!e.known) ++out.measured;
    if (is_base) return;
    if (e.known) ++out.known;
    if (e.state == PointState::refused && refusal.empty()) refusal = e.message;
    out.refused += e.state == PointState::refused ? 1 : 0;
    out.holding += holds ? 1 : 0;
    store.run("UPDATE study_points SET holds = ? WHERE study = ? AND i = ?",
              {static_cast<std::int64_t>(holds ? 1 : 0), plan.name, static_cast<std::int64_t>(numbers[k])});
  };
  const auto evaluated = runner.run(own, options, finished);
  out.missing = static_cast<std::size_t>(
      std::count_if(evaluated.begin(), evaluated.begin() + static_cast<std::ptrdiff_t>(out.points),
                    [](const Evaluated& e) { return e.state == PointState::missing; }));
  if (out.refused == count) {
    throw InputError(
        fmt::format("{}: not one of {} points can be measured; the first: {}", plan.name, count, refusal));
  }
  return out;
}

namespace {

void write_rows(const StudyPlan& plan, Store& store, const std::string& replay, bool by_scene,
                const std::function<void(std::string_view)>& write) {
  const auto rows = store.rows(
      "SELECT i, holds, hash, status, message, seconds, config_hash, settings FROM study_points JOIN points "
      "USING (hash) WHERE study = ? ORDER BY i",
      {plan.name});
  std::vector<std::string> metrics = plan.metrics;
  if (metrics.empty()) {
    for (const Row& row : store.rows("SELECT DISTINCT name FROM study_points JOIN metrics USING (hash) "
                                     "WHERE study = ? ORDER BY name",
                                     {plan.name})) {
      metrics.push_back(text_of(row[0]));
    }
  }
  for (const Expression& expression : expressions_of(plan)) metrics.push_back(expression.text());
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (const std::string& cell : cells) text.append(text.empty() ? "" : ",").append(csv_cell(cell));
    write(text.append("\r\n"));
  };
  // The first stands in front of the keys, two more in front of the metrics, the others behind them.
  constexpr std::span columns(csv_columns);
  std::vector<std::string> cells{std::string(columns[0])};
  if (by_scene) cells.emplace_back(scene_column);
  std::map<std::string, std::string, std::less<>> base;  // values of the keys that vary
  for (const Axis& axis : plan.axes) {
    if (!axis.name.empty()) cells.push_back(axis.name);
    for (const std::string& key : axis.keys) {
      cells.push_back(key);
      base[key] = key == s_ratio_key ? "" : to_string(value_of_key(plan.base, key));
    }
  }
  cells.insert(cells.end(), columns.begin() + 1, columns.begin() + 3);
  cells.insert(cells.end(), metrics.begin(), metrics.end());
  cells.insert(cells.end(), columns.begin() + 3, columns.end());
  line(cells);
  for (const Row& row : rows) {
    auto values = base;
    const auto settings = parse_settings(text_of(row[7]));
    for (const KeySetting& s : settings) values[s.path] = to_string(s.value);
    const std::string hash = text_of(row[2]);
    PointMetrics measured = store.metrics(hash);
    if (!by_scene) measured.scenes = {{}};
    for (const SceneMetrics& scene : measured.scenes) {
      for (const auto& [name, value] : scene.metrics) measured.all.erase(name);
    }
    for (SceneMetrics& scene : measured.scenes) {
      scene.metrics.insert(measured.all.begin(), measured.all.end());
      cells = {std::to_string(integer_of(row[0]))};
      if (by_scene) cells.push_back(scene.scene);
      for (const Axis& axis : plan.axes) {
        if (!axis.name.empty()) cells.push_back(axis_text(axis, settings));
        for (const std::string& key : axis.keys) cells.push_back(values[key]);
      }
      cells.insert(cells.end(), {text_of(row[3]), std::to_string(integer_of(row[1]))});
      for (const std::string& metric : metrics) {
        const auto found = scene.metrics.find(metric);
        cells.push_back(found == scene.metrics.end() ? std::string() : csv_number(found->second));
      }
      cells.insert(cells.end(), {csv_number(number_of(row[5])), text_of(row[6]), hash, text_of(row[4]),
                                 fmt::format("{} {}", replay, hash)});
      line(cells);
    }
  }
}

}  // namespace

void write_csv(const StudyPlan& plan, Store& store, const std::string& replay,
               const std::function<void(std::string_view)>& write) {
  write_rows(plan, store, replay, false, write);
}

void write_scenes_csv(const StudyPlan& plan, Store& store, const std::string& replay,
                      const std::function<void(std::string_view)>& write) {
  write_rows(plan, store, replay, true, write);
}

std::vector<std::string> differences(const ResultRows& stored, const ResultRows& measured) {
  std::vector<std::string> out;
  const auto compare = [&](const std::vector<Row>& a, const std::vector<Row>& b, std::size_t keys,
                           const char* what, std::initializer_list<const char*> columns) {
    const auto name_of = [&](const Row& row) {
      std::string name = what;
      for (std::size_t k = 0; k < keys; ++k)
        name += fmt::format("{}{}", k == 0 ? " " : ".", cell_text(row[k]));
      return name;
    };
    std::map<std::string, std::pair<const Row*, const Row*>> pairs;
    for (const Row& row : a) pairs[name_of(row)].first = &row;
    for (const Row& row : b) pairs[name_of(row)].second = &row;
    for (const auto& [name, pair] : pairs) {
      if (pair.first == nullptr || pair.second == nullptr) {
        out.push_back(name + ": only " + (pair.first == nullptr ? "measured" : "stored"));
        continue;
      }
      for (std::size_t c = keys; c < pair.first->size(); ++c) {
        const Cell& x = (*pair.first)[c];
        const Cell& y = (*pair.second)[c];
        if (x == y) continue;
        const std::string column = columns.begin()[c - keys];
        out.push_back(fmt::format("{}{}: stored {}, measured {}", name, column.empty() ? "" : " " + column,
                                  cell_text(x), cell_text(y)));
      }
    }
  };
  compare(stored.metrics, measured.metrics, 1, "metric", {""});
  compare(stored.scenes, measured.scenes, 2, "scene", {""});
  compare(stored.fields, measured.fields, 2, "field", {"unit", "ulp", "count"});
  compare(stored.registers, measured.registers, 1, "register",
          {"format", "word", "int", "signed", "count", "min", "max", "used_bits", "headroom", "wraps",
           "saturations", "zeros", "octaves"});
  return out;
}

}  // namespace bitspan
