// SPDX-License-Identifier: Apache-2.0
// Measures points on all cores, and keeps each in the database as soon as it is done. run_sweep does so for
// all points of a plan.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"
#include "study/claims.hpp"
#include "study/expression.hpp"
#include "study/plan.hpp"
#include "study/settings.hpp"
#include "study/store.hpp"

namespace bitspan {

// This is part of every point's hash. Raise it whenever a metric changes its meaning or its value.
inline constexpr int measurement_version = 2;

// Returns 32 hexadecimal digits (FNV-1a of 128 bits) over everything of a scene that determines a picture.
// The names of the scene and of its textures are left out.
std::string scene_hash(const Scene& scene);

// Returns the scene with all distances s between s_min and s_max stretched, evenly in log s, to s_min ..
// s_min * ratio. The fog's distance is stretched with them. What is seen stays in its place; only the depths
// spread out or close up. The picture is the same for any ratio, up to where triangles cross. ratio > 1.
// Throws InputError for a scene with a projector or in passes.
Scene with_s_ratio(Scene scene, double ratio);

// Returns the scenes as a point's row has them: [{"name": "demo", "width": 640, "height": 480, "hash": ...}],
// with "s_ratio" where they were stretched.
std::string scenes_json(const std::vector<Scene>& scenes, std::optional<double> s_ratio);

// Returns the ratio in such a text, and none where the scenes were left as they are. Throws InputError where
// the text is unreadable.
std::optional<double> s_ratio_of(std::string_view scenes_json);

// Returns 32 hexadecimal digits over all that determines what is measured.
std::string point_hash(const Config& config, const std::vector<Scene>& scenes, std::string_view version);

// Measures a configuration on the scenes that it was made for. It is called from several threads. An
// InputError that it throws is a refusal of the point.
using Measure = std::function<PointResult(const Config&)>;
using MakeMeter = std::function<Measure(std::vector<Scene>)>;

struct Point {
  std::string hash;
  std::optional<Config> config;  // none: the settings make no legal one
  std::string refusal;           // why there is no configuration
  std::optional<double> s_ratio;
  std::vector<KeySetting> settings;  // of the configuration, on the base
  bool whole = false;                // everything is kept of it, as the report shows it
};

enum class PointState {
  ok,
  refused,
  missing,  // not reached: stopped, or beyond the limit
};

struct Evaluated {
  PointState state = PointState::missing;
  bool known = false;   // the point was in the database, or another program put it there meanwhile
  std::string message;  // of a refusal
};

// Every count-th point of a study, from the index-th on; the others are for other programs.
struct Shard {
  std::size_t index = 0, count = 1;
  bool whole() const { return count == 1; }
};

struct RunOptions {
  int threads = 0;                                                         // 0: all cores
  std::size_t limit = std::numeric_limits<std::size_t>::max();             // of points measured anew
  Shard shard = {};                                                        // of a sweep
  std::stop_token stop = {};                                               // what runs is finished
  std::function<void(std::size_t done, std::size_t total)> progress = {};  // of the points measured anew
};

class PointRunner {
 public:
  // `version` is bitspan's. `asked` says what is kept of each point. A meter is made where the first point
  // needs it, and is kept for the scenes of the latest points only.
  PointRunner(Config base, std::vector<Scene> scenes, MakeMeter make_meter, Store& store, std::string version,
              Asked asked = {});

  Point prepare(const std::vector<KeySetting>& settings);
  // The same for many, on all cores.
  std::vector<Point> prepare_all(const std::vector<std::vector<KeySetting>>& settings);
  // Measures the points that the database does not have, and no point twice; what another program is
  // measuring is waited for. `finished` gets each index once, the known points first, and never two at a
  // time. What `finished` or the database throws ends the run; the points committed until then stay.
  std::vector<Evaluated> run(const std::vector<Point>& points, const RunOptions& options,
                             const std::function<void(std::size_t, const Evaluated&)>& finished = {});

 private:
  const Measure& meter_of(std::optional<double> s_ratio);

  Config base_;
  MakeMeter make_meter_;
  Store& store_;
  Claims claims_;
  std::string version_;
  Asked asked_;
  std::string base_hash_;
  struct Stretched {
    std::vector<Scene> scenes;
    std::string digest;  // point_hash, but for the configuration
    std::string json;
  };
  Stretched& stretched(std::optional<double> s_ratio);
  std::map<std::optional<double>, Stretched> stretched_;
  std::optional<double> meter_ratio_;
  Measure meter_;
};

// Returns what is kept of a plan's points: the metrics that it names, those of its constraints and its
// cost; everything where it names no metric.
Asked asked_of(const StudyPlan& plan);

// Writes what the database says of the study itself: its plan with axes, constraints and metrics.
// `base_hash` is the hash of the base's point.
void put_study(const StudyPlan& plan, const std::string& base_hash, Store& store);

// Adds the values of a point's expressions to its metrics, and keeps them in the database.
void keep_expressions(const std::string& hash, std::vector<Expression>& expressions, PointMetrics& metrics,
                      Store& store);

// Of the points of the shard.
struct SweepResult {
  std::size_t points = 0;
  std::size_t known = 0;     // those that were in the database before
  std::size_t refused = 0;   // among those reached
  std::size_t missing = 0;   // not reached
  std::size_t holding = 0;   // measured, and all constraints hold
  std::size_t measured = 0;  // in this run, refused ones included
  bool finished() const { return missing == 0; }
};

// Measures all points of the plan, and its base, and no point twice. The base belongs to the first shard. The
// study's rows in the database are written anew, those of other shards, too. Throws InputError where every
// point of a whole study is refused, and where the points lack a metric that the plan names.
SweepResult run_sweep(const StudyPlan& plan, PointRunner& runner, Store& store, const RunOptions& options);

// Writes the points of the study that are in the database, of a sweep or a search, as CSV (RFC 4180). The
// first line is the header; one line per point follows. The columns are i, the keys that vary, status, holds,
// the metrics of the plan (or all), seconds, config_hash, hash, message, and the command that measures the
// point again: `replay`, a blank, its hash. A named axis has a column of its own before its keys.
void write_csv(const StudyPlan& plan, Store& store, const std::string& replay,
               const std::function<void(std::string_view)>& write);
// The same with a line per point and scene: the column `scene` is behind i, and the metrics are of that scene
// alone. What is not measured by scene, as costs, is of the point, and so are status and what follows the
// metrics. A refused point has no line.
void write_scenes_csv(const StudyPlan& plan, Store& store, const std::string& replay,
                      const std::function<void(std::string_view)>& write);

// Returns one line per difference: "metric span.u.max: stored 0.25, measured 0.5".
std::vector<std::string> differences(const ResultRows& stored, const ResultRows& measured);

}  // namespace bitspan
