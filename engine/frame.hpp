// SPDX-License-Identifier: Apache-2.0
// The picture of a run, and the only code that clears it and writes pixels of it one by one. Storage, and no
// arithmetic: so golden and the model share it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/records.hpp"
#include "scene/draw_state.hpp"

namespace bitspan {

// A translucent fragment that its pixel holds until a command resolves it.
struct Candidate {
  std::int64_t triangle = 0, z = 0;  // z: the code, or the word of float_dz
  std::int64_t u = 0, v = 0;         // raw, span.uv
  std::int64_t r = 0, g = 0, b = 0;  // raw, fog.color
  std::int64_t a = 0;                // raw, texture.alpha; 0 where the pixel holds none
  bool operator==(const Candidate&) const = default;
};

// Where the pixels of a picture lie in planes of some of its rows.
struct PixelGrid {
  int width = 0;
  int first_row = 0;  // the picture's row that is row 0 of the planes

  std::int64_t place(std::int64_t x, std::int64_t y) const { return (y - first_row) * width + x; }
  std::int64_t x_of(std::int64_t place) const { return place % width; }
  std::int64_t y_of(std::int64_t place) const { return place / width + first_row; }
};

// What a run leaves behind; every plane is height * width, rows from the top.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> color;      // RGBA; A is 255 until the draw state says otherwise
  std::vector<std::uint32_t> depth;     // the stored code
  std::vector<double> u, v;             // texels, of the fragment written last; NaN where none
  std::vector<std::int32_t> triangle;   // input index of that fragment; -1 where none
  std::vector<std::uint8_t> stencil{};  // empty until a stencil test or a clear of the stencil
  std::vector<Candidate> candidates{};  // empty until a pass holds some
  bool full_alpha = true;               // every A is 255
  int first_row = 0;                    // of a band: the picture's row that is row 0; else 0

  PixelGrid grid() const { return {width, first_row}; }
};

// Gives the frame its size, the background, the depth buffer's clear code and no triangle; its row 0 is the
// picture's. winners: with the planes u, v and triangle; else they are empty.
void clear_frame(Frame& frame, int width, int height, const std::array<std::uint8_t, 3>& background,
                 std::uint32_t clear_depth, bool winners = true);

// Clears planes of a frame that has its size. farthest: the depth buffer's clear code.
void clear_planes(Frame& frame, const Clear& clear, std::uint32_t farthest);
// Gives the frame a stencil plane of zeros where it has none.
void need_stencil(Frame& frame);
// The same of candidates.
void need_candidates(Frame& frame);

// The targets of a run but the one that is drawn on. Planes: what an engine has per target, a Frame at least.
template <class Planes>
class Targets {
 public:
  // Puts `planes` away, and takes out those of target k. Returns whether it has been drawn on before: else
  // they are Planes{}, for the caller to clear. Throws InputError where there is no target k.
  bool select(int k, Planes& planes) {
    check_target(k);
    if (k == current_) return true;
    away_[static_cast<std::size_t>(current_)] = std::move(planes);
    current_ = k;
    std::optional<Planes>& kept = away_[static_cast<std::size_t>(k)];
    planes = kept ? std::move(*kept) : Planes{};
    return kept.has_value();
  }
  int current() const { return current_; }
  // Those of target k, which has been drawn on; `planes` are those of the current one.
  const Planes& of(int k, const Planes& planes) const {
    return k == current_ ? planes : away_[static_cast<std::size_t>(k)].value();
  }

 private:
  int current_ = 0;
  std::array<std::optional<Planes>, target_limit> away_;
};

inline std::size_t pixel_of(const Frame& frame, const FragmentRecord& fragment) {
  return static_cast<std::size_t>(frame.grid().place(fragment.x, fragment.y));
}

// The planes of the winner; the frame has them. uv_ulp: the value of 1 in u and v.
inline void write_winner(Frame& frame, std::size_t pixel, std::int64_t u, std::int64_t v,
                         std::int64_t triangle, double uv_ulp) {
  frame.u[pixel] = static_cast<double>(u) * uv_ulp;
  frame.v[pixel] = static_cast<double>(v) * uv_ulp;
  frame.triangle[pixel] = static_cast<std::int32_t>(triangle);
}

// The same of a pixel that shows no triangle.
inline void clear_winner(Frame& frame, std::size_t pixel) {
  frame.u[pixel] = frame.v[pixel] = std::numeric_limits<double>::quiet_NaN();
  frame.triangle[pixel] = -1;
}

// Which planes a fragment is written to.
struct WriteMask {
  bool color = true, depth = true;
  std::int32_t channels = 15;  // of the colour: bit 0 red to bit 3 alpha

  // Whether channel c of the colour is written.
  bool stores(int c) const { return color && (channels >> c & 1) != 0; }
};

// What merge delivered for a fragment. uv_ulp: the value of 1 in the fragment's u and v.
inline void write_fragment(Frame& frame, const FragmentRecord& fragment, const MergeRecord& merged,
                           double uv_ulp, WriteMask mask = {}) {
  const std::size_t pixel = pixel_of(frame, fragment);
  std::uint8_t* const color = frame.color.data() + 4 * pixel;
  if (mask.stores(0)) color[0] = static_cast<std::uint8_t>(merged.r);
  if (mask.stores(1)) color[1] = static_cast<std::uint8_t>(merged.g);
  if (mask.stores(2)) color[2] = static_cast<std::uint8_t>(merged.b);
  if (mask.depth) frame.depth[pixel] = static_cast<std::uint32_t>(merged.z);
  if (mask.color && !frame.u.empty())
    write_winner(frame, pixel, fragment.u, fragment.v, fragment.triangle, uv_ulp);
}

}  // namespace bitspan
