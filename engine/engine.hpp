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
  virtual const Frame& frame() const = 0;
  virtual const Counters& counters() const = 0;
};

}  // namespace bitspan
