// SPDX-License-Identifier: Apache-2.0
// What engines that stand on the model's pipeline keep of a run, from begin() to begin(), and what they do
// alike.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/bands.hpp"
#include "engine/drawn_scene.hpp"
#include "engine/engine.hpp"
#include "model/pipeline.hpp"

namespace bitspan::model {

struct SceneRun {
  DrawnScene scene;
  Pipeline pipeline;
  Frame frame;
  Targets<Frame> targets;
  std::optional<Band> band;  // none: whole pictures
  Counters counters;
  bool constants_delivered = false;  // once per view
  Statistics* statistics = nullptr;  // of what is computed for a view, where they are wanted

  // After `pipeline` is made for the scene; `band` is set. winners: as for clear_frame.
  void begin(const Scene& s, bool winners);
  // Throws std::logic_error before begin(); `call` is its name.
  void need_begun(const char* call) const;
  // The record of the constants, in front of a view's first records.
  void deliver_constants(Trace* trace);
  // As Engine's.
  void execute(const Config& config, const DrawCommand& command, std::int64_t next_index, Trace* trace);

 private:
  void run(const Config& config, const StateChange& change, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Clear& clear, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Target& target, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const ViewChange& change, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Copy& copy, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Resolve& resolve, std::int64_t next_index, Trace* trace);
  // Tells the pipeline which rows of target k are drawn.
  void take_rows(int k);
  // Prepares what the scene has become since that version.
  void update(const Config& config, std::uint64_t since);
};

}  // namespace bitspan::model
