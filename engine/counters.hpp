// SPDX-License-Identifier: Apache-2.0
// The events that an engine counts since begin(), in one list.
#pragma once

#include <cstdint>
#include <string_view>

namespace bitspan {

// The lists read as tables.
// clang-format off

// X(type, name, compared, meaning). compared: whether all engines count the same; else it is the engine's own.
#define BITSPAN_COUNTERS(X)                                                                                     \
  X(std::uint64_t, triangles,     true,  "triangles given")                                                     \
  X(std::uint64_t, degenerate,    true,  "triangles without area after snapping: nothing drawn")                \
  X(std::uint64_t, rows,          true,  "spans, or rows of constant depth (q)")                                \
  X(std::uint64_t, fragments,     true,  "fragments made by the span stage, uncovered ones included")           \
  X(std::uint64_t, covered,       true,  "fragments that cover their pixel (T)")                                \
  X(std::uint64_t, masked,        true,  "covered fragments outside the scissor or the stipple")                \
  X(std::uint64_t, stencil_failed, true, "fragments that failed the stencil test")                              \
  X(std::uint64_t, depth_passed,  true,  "fragments that passed the depth test, and the stencil test")                                \
  X(std::uint64_t, killed,        true,  "fragments killed by the transparent code, alpha 0 or the alpha test")                 \
  X(std::uint64_t, candidates,    true,  "fragments that might have been held as their pixel's candidate")       \
  X(std::uint64_t, written,       true,  "fragments merged into the frame")                                     \
  X(std::uint64_t, divides_edge,  true,  "reciprocals or divisions made for edges, or planes")                  \
  X(std::uint64_t, divides_row,   true,  "reciprocals or divisions made for rows")                              \
  X(std::uint64_t, divides_pixel, true,  "reciprocals or divisions made for pixels, texture coordinates only")  \
  X(std::int64_t,  divides_saved, true,  "const_depth_rows: T - q")                                             \
  X(std::uint64_t, cycles,        false, "clocks, of the engines that have a clock")

// clang-format on

struct Counters {
#define BITSPAN_COUNTER(type, name, compared, meaning) type name = 0;
  BITSPAN_COUNTERS(BITSPAN_COUNTER)
#undef BITSPAN_COUNTER
  bool operator==(const Counters&) const = default;

  Counters& operator+=(const Counters& other) {
#define BITSPAN_COUNTER(type, name, compared, meaning) name += other.name;
    BITSPAN_COUNTERS(BITSPAN_COUNTER)
#undef BITSPAN_COUNTER
    return *this;
  }
};

struct CounterInfo {
  std::string_view name;
  bool compared;
  std::string_view meaning;
};

// Calls visit(info, member pointer) for each counter in the order of the list.
template <class Visit>
void for_each_counter(Visit visit) {
#define BITSPAN_COUNTER(type, name, compared, meaning) \
  visit(CounterInfo{#name, compared, meaning}, &Counters::name);
  BITSPAN_COUNTERS(BITSPAN_COUNTER)
#undef BITSPAN_COUNTER
}

}  // namespace bitspan
