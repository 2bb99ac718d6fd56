// SPDX-License-Identifier: Apache-2.0
#include "study/point.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "config/modes.hpp"
#include "engine/range.hpp"
#include "engine/records.hpp"
#include "model/engine_model.hpp"
#include "report/compare.hpp"
#include "report/error.hpp"
#include "report/metrics.hpp"
#include "report/shadow_plan.hpp"
#include "study/area_estimate.hpp"
#include "study/cost.hpp"
#include "study/engines.hpp"
#include "study/oracles.hpp"
#include "study/truths.hpp"

namespace bitspan {
namespace {

// Returns the register that a field's values come from, and none for integers.
std::optional<model::RegisterId> observed_register(const Field& field, const Config& config) {
  using model::RegisterId;
  if (const auto id = register_of(field, config)) return model::id_of(*id);
  switch (field.kind) {
    case FieldKind::coordinate:
      return RegisterId::coordinate;
    case FieldKind::depth_code:
      return RegisterId::depth_z;
    case FieldKind::edge_mantissa:
      return RegisterId::edge_reciprocal;
    case FieldKind::row_mantissa:
      return RegisterId::row_reciprocal;
    case FieldKind::pixel_mantissa:
      return RegisterId::pixel_reciprocal;
    default:  // an integer, or the phase
      return std::nullopt;
  }
}

// Counts the values of a trace by octave.
void note_octaves(const Trace& trace, const Config& config, std::vector<RegisterUse>& registers) {
  struct ObservedField {
    std::size_t field;
    RegisterUse* use;
    int place;  // index of an ulp in RegisterUse::octave, where 2^(i - 64) has i
  };
  std::vector<ObservedField> observed;
  for (int t = 0; t < record_types; ++t) {
    const RecordView view = view_of(trace, static_cast<RecordType>(t));
    if (view.records == 0) continue;
    observed.clear();
    for (std::size_t f = 0; f < view.fields.size(); ++f) {
      if (const auto id = observed_register(view.fields[f], config)) {
        RegisterUse& use = registers[static_cast<std::size_t>(*id)];
        observed.push_back({f, &use, 64 - use.format.fraction()});
      }
    }
    for (std::size_t i = 0; i < view.records; ++i) {
      const std::int64_t* const record = view.values + i * view.fields.size();
      for (const ObservedField& s : observed) {
        const std::int64_t raw = record[s.field];
        if (raw == 0) {
          ++s.use->zeros;
          continue;
        }
        const auto size = static_cast<std::uint64_t>(raw < 0 ? -raw : raw);
        const int octave = static_cast<int>(std::bit_width(size)) - 1 + s.place;
        ++s.use->octave[static_cast<std::size_t>(std::clamp(octave, 0, 127))];
      }
    }
  }
}

void merge(model::FieldStatistics& to, const model::FieldStatistics& s) {
  if (s.count == 0) return;
  to.min = to.count == 0 ? s.min : std::min(to.min, s.min);
  to.max = to.count == 0 ? s.max : std::max(to.max, s.max);
  to.count += s.count;
  to.wraps += s.wraps;
  to.saturations += s.saturations;
}

void finish(RegisterUse& use, const model::FieldStatistics& s) {
  use.count = s.count;
  use.wraps = s.wraps;
  use.saturations = s.saturations;
  if (s.count == 0) return;
  use.min = std::ldexp(static_cast<double>(s.min), -use.format.fraction());
  use.max = std::ldexp(static_cast<double>(s.max), -use.format.fraction());
  use.used_bits = model::used_bits(s, use.format.is_signed) - use.format.fraction();
  use.headroom = use.format.integer - use.used_bits;
}

// Returns the registers of a configuration, with what they held by the statistics.
std::vector<RegisterUse> register_uses(const Config& config,
                                       const std::vector<model::FieldStatistics>& seen) {
  std::vector<RegisterUse> out(model::register_count);
  for (int i = 0; i < model::register_count; ++i) {
    const auto id = static_cast<model::RegisterId>(i);
    RegisterUse& use = out[static_cast<std::size_t>(i)];
    use.name = model::name_of(id);
    use.format = model::format_of(id, config);
    finish(use, seen[static_cast<std::size_t>(i)]);
  }
  return out;
}

void add_field(const ErrorRow& row, Metrics& out) {
  for (const FieldStatistic& s : field_statistics()) {
    const std::string name = row.stage + "." + row.quantity + "." + std::string(s.name);
    const double value = s.value(row.stat);
    out[name] = value;
    if (s.unit.empty()) out[name + "_ulp"] = value / row.ulp;
  }
}

Metrics metrics_of(const ErrorReport& report, const std::vector<RegisterUse>& registers) {
  Metrics out;
  for (const ErrorRow& row : report.rows) {
    if (row.stat.count != 0) add_field(row, out);
  }
  for (const PictureMetric& metric : picture_metrics()) {
    if (const auto value = value_of(metric, report)) out[std::string(metric.name)] = *value;
  }
  double wraps = 0;
  double saturations = 0;
  for (const RegisterUse& use : registers) {
    if (use.count == 0) continue;
    wraps += static_cast<double>(use.wraps);
    saturations += static_cast<double>(use.saturations);
    const std::string name = "register." + use.name;
    out[name + ".used_bits"] = use.used_bits;
    out[name + ".headroom"] = use.headroom;
    out[name + ".wraps"] = static_cast<double>(use.wraps);
    out[name + ".saturations"] = static_cast<double>(use.saturations);
  }
  out["registers.wraps"] = wraps;
  out["registers.saturations"] = saturations;
  out["registers.overflows"] = wraps + saturations;
  return out;
}

constexpr const char* one_view =
    ": a study measures one view, or a picture with one shadow map; expected a scene that no command changes";

// What rays from the light find of the picture. Throws InputError where the scene has no shadow map.
Metrics shadow_metrics(const Config& config, const Scene& scene, const Frame& frame) {
  const auto plan = shadow_plan_of(config, scene);
  if (!plan) throw InputError(scene.name + one_view);
  const VisibilityReport report = judged_shadows(config, *plan, frame, "model");
  return {{"shadow.unexplained", static_cast<double>(report.unexplained)},
          {"shadow.edges", static_cast<double>(report.edges)},
          {"shadow.judged", static_cast<double>(report.compared())}};
}

}  // namespace

Scene lit_for(Scene scene, const Config& config, const LoadLit& lit) {
  if (lit && changes_scene(scene.commands)) return lit(scene, config);
  return scene;
}

PointMeter::PointMeter(std::vector<Scene> scenes, std::size_t truth_bytes, LoadLit lit,
                       const LoadCurves& curves)
    : scenes_(std::move(scenes)),
      truths_(std::make_unique<Truths>(scenes_, truth_bytes)),
      lit_(std::move(lit)) {
  if (scenes_.empty()) throw InputError("a study without scenes: name at least one");
  for (const Scene& scene : scenes_) {
    curves_.push_back(curves ? curves(scene) : std::nullopt);
    if (!changes_scene(scene.commands) || scene.projector) continue;
    throw InputError(scene.name + one_view);
  }
}
PointMeter::~PointMeter() = default;

std::shared_ptr<const Frame> PointMeter::ideal(const Config& config, std::size_t scene) const {
  const auto truth = truths_->kept(config, scene);
  if (!truth) {
    return std::make_shared<const Frame>(drawn("ideal", config, lit_for(scenes_.at(scene), config, lit_)));
  }
  return {truth, &truth->frame};  // the pointer keeps the whole truth alive
}

PointResult PointMeter::measure(const Config& config, bool histograms) const {
  check_config(config, config.name);
  std::vector<std::optional<Scene>> in_passes(scenes_.size());
  for (std::size_t s = 0; s < scenes_.size(); ++s) {
    if (changes_scene(scenes_[s].commands)) in_passes[s] = lit_for(scenes_[s], config, lit_);
    check_scene_range(config, in_passes[s] ? *in_passes[s] : scenes_[s]);
  }
  PointResult out;
  std::vector<model::FieldStatistics> seen(model::register_count);
  std::vector<RegisterUse> octaves = register_uses(config, seen);
  ErrorReport errors;
  const auto engine = make_observed_model(config);
  Trace trace;
  Metrics shadows, curves;
  for (std::size_t s = 0; s < scenes_.size(); ++s) {
    const Scene& scene = in_passes[s] ? *in_passes[s] : scenes_[s];
    std::shared_ptr<const SceneTruth> truth;
    if (!in_passes[s]) truth = truths_->of(config, s);
    ErrorMeter meter(config, scene);
    engine->begin(scene);
    for (std::size_t at = 0; at < scene.triangles.size(); at += SceneTruth::batch) {
      trace.clear();
      draw_scene(*engine, scene, at, std::min(SceneTruth::batch, scene.triangles.size() - at), &trace);
      if (truth) meter.add(truth->batches[at / SceneTruth::batch], static_cast<std::int64_t>(at), trace);
      if (histograms) note_octaves(trace, config, octaves);
    }
    meter.add_pictures(engine->frame(), truth ? truth->frame : drawn("ideal", config, scene));
    if (s == 0) {
      errors = meter.report();
    } else {
      errors.add(meter.report());
    }
    std::vector<model::FieldStatistics> here(model::register_count);
    for (std::size_t i = 0; i < here.size(); ++i) {
      here[i] = engine->statistics().of(static_cast<model::RegisterId>(i));
      merge(seen[i], here[i]);
    }
    out.scenes.push_back({scene.name, metrics_of(meter.report(), register_uses(config, here))});
    if (curves_[s]) {
      const Metrics own = curve_metrics(config, *curves_[s]);
      add_curve_metrics(own, curves);
      out.scenes.back().metrics.insert(own.begin(), own.end());
    }
    if (!in_passes[s]) continue;
    const Metrics own = shadow_metrics(config, scene, engine->frame());
    for (const auto& [name, value] : own) shadows[name] += value;
    out.scenes.back().metrics.insert(own.begin(), own.end());
  }
  if (picture_value(errors, "picture.drawn").value_or(0) == 0) {
    throw InputError(config.name +
                     ": nothing is drawn in any of the scenes, so there is no error to measure");
  }
  for (const ErrorRow& row : errors.rows) {
    if (row.stat.count == 0) continue;
    out.fields.push_back({row.stage, row.quantity, row.unit, row.ulp, row.stat.count, row.stat.max});
  }
  std::vector<RegisterUse> registers = register_uses(config, seen);
  out.metrics = metrics_of(errors, registers);
  out.metrics.merge(shadows);
  out.metrics.merge(curves);
  for (std::size_t i = 0; i < registers.size(); ++i) {
    if (registers[i].count == 0) continue;
    registers[i].zeros = octaves[i].zeros;
    registers[i].octave = octaves[i].octave;
    out.registers.push_back(std::move(registers[i]));
  }
  add_costs(config, out.metrics);
  add_memory(config, scenes_, out.metrics);
  add_timing(config, out.metrics);
  add_estimates(config, out.metrics);
  return out;
}

}  // namespace bitspan
