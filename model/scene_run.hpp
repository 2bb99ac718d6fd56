// SPDX-License-Identifier: Apache-2.0
// What engines that stand on the model's pipeline keep of a run, from begin() to begin(), and what they do
// alike.
#pragma once

#include <cstdint>

#include "engine/engine.hpp"
#include "model/pipeline.hpp"

namespace bitspan::model {

struct SceneRun {
  const Scene* scene = nullptr;
  Pipeline pipeline;
  Frame frame;
  Targets<Frame> targets;
  Counters counters;
  bool constants_delivered = false;  // once per scene

  // After `pipeline` is made for the scene. winners: as for clear_frame.
  void begin(const Scene& s, bool winners);
  // Throws std::logic_error before begin(); `call` is its name.
  void need_begun(const char* call) const;
  // The record of the constants, in front of a scene's first records.
  void deliver_constants(Trace* trace);
  // As Engine's.
  void execute(const Config& config, const DrawCommand& command, std::int64_t next_index, Trace* trace);

 private:
  void run(const Config& config, const StateChange& change, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Clear& clear, std::int64_t next_index, Trace* trace);
  void run(const Config& config, const Target& target, std::int64_t next_index, Trace* trace);
};

}  // namespace bitspan::model
