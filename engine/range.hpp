// SPDX-License-Identifier: Apache-2.0
// Are the formats wide enough for a scene? Asked once before a run.
#pragma once

#include <cstdint>
#include <memory>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// How the triangles are looked at; the verdict and its text are the same.
enum class RangeBy : std::uint8_t {
  bounds,    // intervals around all of them first, which mostly decide
  triangles  // one after the other
};

// Throws InputError naming the field, the range it has, the range it needs, the integer bits that hold it,
// and the key that allows the overflow. Checks the fields that the configured modes use, over the values of
// the ideal surface inside the triangles (vertices quantised, slopes exact). Not checked: slope registers (an
// edge may be one 2^-subpixel_bits high), normals and what light makes of them, whose parts are at most 1 or
// stop at the register's end, and what rounding of slopes, or the half pixel between a row of
// constant depth and a pixel centre, carries an accumulator past those values. Expects a configuration that
// check_config accepts and finite vertices with s in [s_min, s_max].
void check_scene_range(const Config& config, const Scene& scene, RangeBy by = RangeBy::bounds);

// The same of a scene that comes in pieces. By bounds, the range in the text is that of the pieces in doubt.
class PiecewiseRange {
 public:
  // Needs the scene's view and name alone. The configuration must outlive the check.
  PiecewiseRange(const Config& config, const Scene& scene, RangeBy by);
  ~PiecewiseRange();
  PiecewiseRange(const PiecewiseRange&) = delete;
  PiecewiseRange& operator=(const PiecewiseRange&) = delete;
  // Looks at the piece behind those before it: its triangles, and its commands. Returns whether the formats
  // are wide enough so far. May throw where they are not.
  bool add(const Scene& piece);
  // Throws where they are not, for any piece.
  void finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bitspan
