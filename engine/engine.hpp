// SPDX-License-Identifier: Apache-2.0
// What a bitspan engine is to its users: triangles in, records and a picture out.
//
// Free of SystemC, Verilator and Python: adapters to them stand behind it (ideal, golden, model, systemc,
// rtl).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "config/config.hpp"
#include "engine/counters.hpp"
#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "scene/scene.hpp"

namespace bitspan {

class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::string_view name() const = 0;
  // Clears the frame and the counters and computes the constants for this scene. The scene must outlive the
  // run. Throws InputError where the scene's range does not fit the configuration.
  virtual void begin(const Scene& scene) = 0;
  // Draws triangles in order; first_index is the input index of triangles[0]. With a trace, every record is
  // appended to it. All records of these triangles have been delivered when it returns.
  virtual void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) = 0;
  // Changes the draw state for the triangles from next_index on; begin() gives the configuration's. With a
  // trace, the record of the new state is appended to it. Throws InputError where the new state is not legal,
  // or the engine does not have it.
  virtual void set(const StateChange& change, std::int64_t next_index, Trace* trace) = 0;
  // Clears planes of the frame. It takes no clock.
  virtual void clear(const Clear& clear) = 0;
  // Draws on target k from here on; begin() gives target 0. One that has not been drawn on yet is as begin()
  // clears it. The draw state stays. It takes no clock. Throws InputError where k is not below target_limit.
  virtual void target(int k) = 0;
  // Of the target that is drawn on.
  virtual const Frame& frame() const = 0;
  virtual const Counters& counters() const = 0;
};

// Sets, clears or takes another target, as the command says; next_index and trace as Engine::set takes them.
void execute(Engine& engine, const DrawCommand& command, std::int64_t next_index, Trace* trace);
// Draws `count` triangles of a scene from `first` on, with the commands in front of them, and those behind
// the scene's last triangle where it is among them.
void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count, Trace* trace);
// The same, where triangle `first` has input index first_index.
void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count,
                std::int64_t first_index, Trace* trace);

}  // namespace bitspan
