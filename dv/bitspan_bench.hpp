// SPDX-License-Identifier: Apache-2.0
// What a bench in SystemVerilog needs of the C library, apart from any simulator's interface: models by name,
// a picture in one call, and checks of records of which a design has only some fields. C++17.
#pragma once

#include <bitspan/bitspan.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace bitspan_dv {

constexpr int stage_count = 12;

struct Counts {
  std::uint64_t matched = 0, nontrivial = 0, unchecked = 0, different = 0;
};

// A model and what was checked against it. It stays when it is closed, so that a `final` block may still ask.
struct Bench {
  std::string name;
  bs_config* config = nullptr;
  bs_model* model = nullptr;
  std::array<Counts, stage_count> counts{};
  std::array<std::uint64_t, stage_count> next{};  // record that the next check of the stage is about
  std::string first;                              // the first difference, in one line
};

inline std::vector<std::unique_ptr<Bench>>& benches() {
  static std::vector<std::unique_ptr<Bench>> all;
  return all;
}

inline std::string& error() {
  static std::string text;
  return text;
}

inline bs_status failed(bs_status status, const std::string& text) {
  error() = text;
  return status;
}

// Keeps the library's text where a call failed.
inline bs_status kept(bs_status status) {
  return status == BS_OK || status == BS_DIFFERENT ? status : failed(status, bs_last_error());
}

inline bs_status usable(const Bench* bench) {
  if (bench == nullptr) return failed(BS_BAD_HANDLE, "model: none; expected one that was opened");
  if (bench->model == nullptr) return failed(BS_BAD_HANDLE, bench->name + ": closed; expected an open model");
  return BS_OK;
}

inline bs_status usable(const Bench* bench, int stage) {
  if (bs_stage_name(stage) == nullptr || stage >= stage_count)
    return failed(BS_BAD_INPUT, "stage " + std::to_string(stage) + "; expected 0 to 11");
  return usable(bench);
}

inline Bench* find(const std::string& name) {
  for (const auto& bench : benches())
    if (bench->name == name && bench->model != nullptr) return bench.get();
  error() = name + ": no open model has this name";
  return nullptr;
}

inline int stage_of(const std::string& name) {
  for (int stage = 0; bs_stage_name(stage) != nullptr; ++stage)
    if (name == bs_stage_name(stage)) return stage;
  error() = name + ": no stage has this name";
  return -1;
}

// Closes the model and keeps its counts.
inline bs_status close(Bench* bench) {
  if (const bs_status status = usable(bench); status != BS_OK) return status;
  for (int stage = 0; stage < stage_count; ++stage)
    bench->counts[static_cast<std::size_t>(stage)].unchecked = bs_unchecked(bench->model, stage);
  bs_close(bench->model);
  bs_config_free(bench->config);
  bench->model = nullptr;
  bench->config = nullptr;
  return BS_OK;
}

// Opens a model. settings: "KEY=VALUE;KEY=VALUE", or empty.
inline Bench* open(const std::string& name, const std::string& config, const std::string& settings,
                   const std::string& engine) {
  if (name.empty() || find(name) != nullptr) {
    error() = "name \"" + name + "\"; expected one that no open model has";
    return nullptr;
  }
  auto bench = std::make_unique<Bench>();
  bench->name = name;
  if (kept(bs_config_load(config.c_str(), &bench->config)) != BS_OK) return nullptr;
  bool good = true;
  for (std::size_t at = 0; good && at < settings.size();) {
    const std::size_t end = std::min(settings.find(';', at), settings.size());
    const std::string setting = settings.substr(at, end - at);
    const std::size_t equals = setting.find('=');
    at = end + 1;
    if (equals == std::string::npos) {
      error() = "setting \"" + setting + "\"; expected KEY=VALUE";
      good = false;
    } else {
      good = kept(bs_config_set(bench->config, setting.substr(0, equals).c_str(),
                                setting.substr(equals + 1).c_str())) == BS_OK;
    }
  }
  if (!good || kept(bs_open(bench->config, engine.c_str(), &bench->model)) != BS_OK) {
    bs_config_free(bench->config);
    return nullptr;
  }
  return benches().emplace_back(std::move(bench)).get();
}

// Begins a picture, and draws the scene's triangles where `draws`.
inline bs_status begin(Bench* bench, const std::string& scene_name, int width, int height, bool draws) {
  if (const bs_status status = usable(bench); status != BS_OK) return status;
  bs_scene* scene = nullptr;
  bs_status status = kept(bs_scene_load(scene_name.c_str(), width, height, &scene));
  if (status != BS_OK) return status;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices = nullptr;
  const std::int32_t* textures = nullptr;
  std::size_t count = 0;
  status = kept(bs_scene_get(scene, &desc));
  if (status == BS_OK) status = kept(bs_scene_triangles(scene, &vertices, &textures, &count));
  if (status == BS_OK) status = kept(bs_begin(bench->model, &desc));
  if (status == BS_OK) bench->next = {};
  if (status == BS_OK && draws) status = kept(bs_draw(bench->model, vertices, textures, count, 0, 0));
  bs_scene_free(scene);
  return status;
}

inline bs_status field(Bench* bench, int stage, int column, bs_field_info& out) {
  if (const bs_status status = usable(bench, stage); status != BS_OK) return status;
  out = {};
  out.size = sizeof out;
  return kept(bs_field(bench->config, stage, column, &out));
}

// The column of a field, -1 where the stage has none of that name.
inline int column(Bench* bench, int stage, const std::string& name) {
  bs_field_info info{};
  for (int i = 0; field(bench, stage, i, info) == BS_OK; ++i)
    if (name == info.name) return i;
  if (usable(bench, stage) == BS_OK) error() = name + ": " + bs_stage_name(stage) + " has no such field";
  return -1;
}

// The column of the i-th word of `fields`; -1 where it is no field, -2 behind the last word.
inline int column_of(Bench* bench, int stage, const std::string& fields, int i) {
  std::size_t at = fields.find_first_not_of(' ');
  for (; i > 0 && at != std::string::npos; --i)
    at = fields.find_first_not_of(' ', std::min(fields.find(' ', at), fields.size()));
  if (at == std::string::npos) return -2;
  return column(bench, stage, fields.substr(at, std::min(fields.find(' ', at), fields.size()) - at));
}

inline bs_status records(Bench* bench, int stage, bs_view& out) {
  if (const bs_status status = usable(bench, stage); status != BS_OK) return status;
  out = {};
  out.size = sizeof out;
  return kept(bs_records(bench->model, stage, &out));
}

// Draws a row; what the record has behind the stage's columns is ignored.
inline bs_status row(Bench* bench, int stage, std::vector<std::int64_t> record) {
  bs_view view{};
  if (const bs_status status = records(bench, stage, view); status != BS_OK) return status;
  record.resize(std::min(record.size(), view.columns));
  return kept(bs_row(bench->model, stage, record.data(), record.size(), -1));
}

inline const std::int64_t* record(const bs_view& view, std::uint64_t i) {
  return reinterpret_cast<const std::int64_t*>(static_cast<const char*>(view.base) + i * view.stride);
}

// Columns and number of the stage's records; -1 after a failure.
inline int columns(Bench* bench, int stage) {
  bs_view view{};
  return records(bench, stage, view) == BS_OK ? static_cast<int>(view.columns) : -1;
}

inline std::int64_t record_count(Bench* bench, int stage) {
  bs_view view{};
  return records(bench, stage, view) == BS_OK ? static_cast<std::int64_t>(view.rows) : -1;
}

// Record i of the stage, for an array of `room` values.
inline bs_status fetch(Bench* bench, int stage, std::int64_t i, std::size_t room,
                       std::vector<std::int64_t>& out) {
  bs_view view{};
  if (const bs_status status = records(bench, stage, view); status != BS_OK) return status;
  if (i < 0 || static_cast<std::uint64_t>(i) >= view.rows || room < view.columns) {
    return failed(BS_BAD_INPUT, "record " + std::to_string(i) + " into " + std::to_string(room) +
                                    " values; expected one of " + std::to_string(view.rows) + " into " +
                                    std::to_string(view.columns) + " at least");
  }
  const std::int64_t* values = record(view, static_cast<std::uint64_t>(i));
  out.assign(values, values + view.columns);
  return BS_OK;
}

inline std::string value_text(std::int64_t raw, double value, const bs_field_info& info) {
  if (info.word == 0) return std::to_string(raw);
  std::array<char, 96> text{};
  const std::uint64_t mask = info.word >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << info.word) - 1;
  // A value beyond its word is shown whole.
  const std::int64_t top = raw >> (info.word - (info.is_signed != 0 ? 1 : 0));
  const bool fits = info.word >= 64 || top == 0 || (info.is_signed != 0 && top == -1);
  const std::uint64_t bits = static_cast<std::uint64_t>(raw) & (fits ? mask : ~std::uint64_t{0});
  std::snprintf(text.data(), text.size(), "0x%llx (%.9g %s)", static_cast<unsigned long long>(bits), value,
                info.unit);
  return text.data();
}

// "near: span: record 5, triangle 1, pixel 20 3: u: got 0x1 (0.25 texel), expected 0x3 (0.75 texel)".
inline std::string text_of(Bench& bench, const bs_divergence& d) {
  std::string out = bench.name + ": " + bs_stage_name(d.stage) + ": record " + std::to_string(d.record);
  if (d.triangle >= 0) out += ", triangle " + std::to_string(d.triangle);
  const bool pixel = d.stage >= BS_STAGE_SPAN;
  if (d.x >= 0)
    out += (pixel ? ", pixel " : ", row that begins at pixel ") + std::to_string(d.x) + " " +
           std::to_string(d.y);
  if (d.kind == BS_DIVERGENCE_EXTRA) return out + ": the model has no such record";
  bs_field_info info{};
  field(&bench, d.stage, d.field, info);
  return out + ": " + d.field_name + ": got " + value_text(d.actual, d.actual_value, info) + ", expected " +
         value_text(d.expected, d.expected_value, info);
}

// Checks a stage's next record. Columns whose bit in `present` is 0 are none of the design's: they are not
// compared, and not counted.
inline bs_status check(Bench* bench, int stage, std::vector<std::int64_t> dut, std::uint64_t present) {
  bs_view view{};
  if (const bs_status status = records(bench, stage, view); status != BS_OK) return status;
  if (dut.size() < view.columns)
    return failed(BS_BAD_INPUT, "record of " + std::to_string(dut.size()) + " values; expected " +
                                    std::to_string(view.columns) + " at least");
  dut.resize(view.columns);
  if ((present & ((std::uint64_t{1} << view.columns) - 1)) == 0)
    return failed(BS_BAD_INPUT, "no field is present; expected at least one");
  const auto s = static_cast<std::size_t>(stage);
  const std::uint64_t at = bench->next[s];
  std::uint64_t absent = 0;
  std::uint64_t absent_nontrivial = 0;
  if (at < view.rows) {
    const std::int64_t* expected = record(view, at);
    const std::int64_t* before = at > 0 ? record(view, at - 1) : nullptr;
    for (std::size_t f = 0; f < view.columns; ++f) {
      if ((present >> f & 1U) != 0) continue;
      dut[f] = expected[f];
      ++absent;
      if (expected[f] != 0 && (before == nullptr || expected[f] != before[f])) ++absent_nontrivial;
    }
  }
  const std::uint64_t matched = bs_matched(bench->model);
  const std::uint64_t nontrivial = bs_nontrivial(bench->model);
  bs_divergence first{};
  first.size = sizeof first;
  const bs_status status = kept(bs_check(bench->model, stage, dut.data(), 1, &first));
  if (status != BS_OK && status != BS_DIFFERENT) return status;
  if (at < view.rows) ++bench->next[s];
  Counts& counts = bench->counts[s];
  counts.matched += bs_matched(bench->model) - matched - absent;
  counts.nontrivial += bs_nontrivial(bench->model) - nontrivial - absent_nontrivial;
  if (status == BS_DIFFERENT) {
    ++counts.different;
    if (bench->first.empty()) bench->first = text_of(*bench, first);
  }
  return status;
}

inline Counts counts(const Bench* bench, int stage) {
  if (bench == nullptr || stage < 0 || stage >= stage_count) return {};
  Counts out = bench->counts[static_cast<std::size_t>(stage)];
  if (bench->model != nullptr) out.unchecked = bs_unchecked(bench->model, stage);
  return out;
}

}  // namespace bitspan_dv
