// What a bitspan engine is to its users: triangles in, records and a picture out.
//
// Free of SystemC, Verilator and Python: adapters to them stand behind it (ideal, golden, model, systemc,
// rtl).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// What a run leaves behind; every plane is height * width, rows from the top.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> color;     // RGBA, A always 255
  std::vector<std::uint32_t> depth;    // the stored code
  std::vector<double> u, v;            // texels, of the fragment written last; NaN where none
  std::vector<std::int32_t> triangle;  // input index of that fragment; -1 where none
};

struct Counters {
  std::uint64_t triangles = 0;      // given
  std::uint64_t degenerate = 0;     // no area after snapping: nothing drawn
  std::uint64_t rows = 0;           // spans, or rows of constant depth (q)
  std::uint64_t fragments = 0;      // made by the span stage, uncovered ones included
  std::uint64_t covered = 0;        // fragments that cover their pixel (T)
  std::uint64_t depth_passed = 0;   // fragments nearer than the buffer
  std::uint64_t killed = 0;         // by the transparent code or alpha 0
  std::uint64_t written = 0;        // merged into the frame
  std::uint64_t divides_edge = 0;   // reciprocals or divisions made for edges, or planes
  std::uint64_t divides_row = 0;    // ... for rows
  std::uint64_t divides_pixel = 0;  // ... for pixels, texture coordinates only
  std::int64_t divides_saved = 0;   // const_depth_rows: T - q
  std::uint64_t cycles = 0;         // clocks, of the engines that have a clock
  bool operator==(const Counters&) const = default;
};

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
