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
  // Does what the command says, for the triangles from next_index on; it takes no clock. With a trace, the
  // command's records are appended to it.
  //   StateChange  the draw state; begin() gives the configuration's. The record is that of the new state.
  //                Throws InputError where the new state is not legal, or the engine does not have it.
  //   Clear        fills planes of the frame.
  //   Target       draws on target k from here on, with its view; begin() gives target 0. One that has not
  //                been drawn on yet takes the view in force, and is cleared as begin() clears. The draw
  //                state stays. Throws InputError where k is not below target_limit.
  //   ViewChange   the view of the target that is drawn on; begin() gives the scene's. With another size it
  //                is cleared as begin() clears. The constants of another view are delivered as a record of
  //                their own in front of the next records. Throws InputError where the new view is not legal,
  //                or does not fit the configuration.
  //   Copy         makes a plane of a target the texels of a texture, for what is drawn from then on, its mip
  //                chain included. Throws InputError as check_copy does.
  //   Resolve      merges the candidates that the target's pixels hold, as the draw state says; the records
  //                of merge are theirs.
  virtual void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) = 0;
  // Of the target that is drawn on.
  virtual const Frame& frame() const = 0;
  virtual const Counters& counters() const = 0;
};

// The commands in front of `count` triangles of a scene from `first` on, and those behind the scene's last
// triangle where it is among them.
std::span<const DrawCommand> commands_of(const Scene& scene, std::size_t first, std::size_t count);
// Draws `count` triangles of a scene from `first` on, with commands_of() them.
void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count, Trace* trace);
// The same, where triangle `first` has input index first_index.
void draw_scene(Engine& engine, const Scene& scene, std::size_t first, std::size_t count,
                std::int64_t first_index, Trace* trace);

}  // namespace bitspan
