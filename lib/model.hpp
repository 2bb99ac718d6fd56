// SPDX-License-Identifier: Apache-2.0
// What a bs_model is: an engine, the scene it draws, what it delivered, and what was checked of that.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bitspan/bitspan.h"
#include "config/config.hpp"
#include "engine/engine.hpp"
#include "engine/registry.hpp"
#include "engine/rows.hpp"

namespace bitspan::capi {

// The caller's function behind a stage.
struct Override {
  bs_stage_fn function = nullptr;
  void* user = nullptr;
};

// Triangles from `first` on have these numbers of the caller's.
struct DrawNumbers {
  std::int64_t first;
  std::uint64_t frame, draw;
};

// How far the records of one type have been checked.
struct CheckState {
  std::uint64_t forgotten = 0;         // records that bs_clear_records took away since bs_begin
  std::uint64_t checked = 0;           // records that bs_check has been through since bs_begin
  std::vector<std::int64_t> previous;  // the model's last record that was checked
};

struct ModelState {
  Config config;
  const EngineEntry* entry = nullptr;  // of the engine
  std::unique_ptr<Engine> engine;
  RowEngine* rows = nullptr;  // the same engine; null where it takes none
  std::array<Override, record_types> overrides{};
  bool is_current = true;  // the engine has the overrides
  std::string overridden;  // stages of the engine, "" where there are none

  Scene scene;
  Views views;  // of the targets
  bool begun = false;
  std::int64_t triangles = 0;
  std::vector<DrawNumbers> numbers;
  std::optional<PlaneOfRows> plane;  // of the plane rows to come

  bool tracing = true;
  bool untraced = false;  // something was drawn without a trace
  Trace trace;
  std::array<CheckState, record_types> checks;
  std::uint64_t matched = 0, nontrivial = 0;

  // What the caller was given.
  std::string run_text;
  std::vector<double> positions;
  std::atomic_flag in_use{};  // by a call
};

// Makes the engine anew, with the overrides there are.
void make_engine(ModelState& model);

// Compares records from outside with the stage's next ones, counts, and returns whether all are equal; else
// `first` is the first difference.
bool check_records(ModelState& model, RecordType type, const std::int64_t* dut, std::size_t n,
                   bs_divergence& first);
// One line about a difference.
std::string text_of(const bs_divergence& divergence, const ModelState& model);

}  // namespace bitspan::capi
