// SPDX-License-Identifier: Apache-2.0
// span: along a span, one fragment per call. docs/numeric-spec.md, "span" (T1; N3; N1 and N2).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/grid.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/numeric/adder.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/plane_walk.hpp"

namespace bitspan::model {

// h + B on its grid: (h << h_up) + b.
struct InverseDepth {
  int h_up = 0, fraction = 0;
  int128 b = 0;
};
InverseDepth make_inverse_depth(const Config& config, const Constants& constants);
// Exponents that the reciprocal of h + B can deliver: from its least ulp, or from B where h is never
// negative, to its highest bit.
Exponents pixel_exponents(const Config& config, const InverseDepth& q);

// What the stage computes by, as far as the configuration alone says it.
struct SpanFormats {
  Perspective perspective = Perspective::delta_f;
  int h_up = 0, q_fraction = 0;  // of h + B, as in InverseDepth
  ReciprocalFormats reciprocal;  // R_pixel
  Adder h, f, shade_acc;
  int u1_fraction = 0;
  Register uv, shade;
  bool operator==(const SpanFormats&) const = default;
};
constexpr SpanFormats span_formats(const Config& config) {
  const bool linear = has_linear_texture(config.perspective);
  const auto adder = [&](FormatId acc, FormatId step) {
    return make_adder(make_register(config, acc), make_register(config, step));
  };
  SpanFormats s;
  s.perspective = config.perspective;
  const int h_fraction = config.format(FormatId::span_h).fraction();
  s.q_fraction = std::max(h_fraction, config.format(FormatId::setup_b).fraction());
  s.h_up = s.q_fraction - h_fraction;
  s.reciprocal = reciprocal_formats(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.h = adder(FormatId::span_h, FormatId::span_h_step);
  s.f = linear ? adder(FormatId::span_uv_acc, FormatId::span_uv_step)
               : adder(FormatId::span_f, FormatId::span_f_step);
  s.shade_acc = adder(FormatId::span_shade_acc, FormatId::span_shade_step);
  s.u1_fraction = config.format(FormatId::edge_uv).fraction();
  s.uv = make_register(config, FormatId::span_uv);
  s.shade = make_register(config, FormatId::span_shade);
  return s;
}

struct SpanStage {
  SpanFormats formats;
  bool fits_int64 = false;        // every intermediate fits 63 bits
  bool shade_fits_int64 = false;  // a shade's accumulator does, also on the grid of the shade
  // delta_f: bits that f m and u1 take beyond their own, on every grid on the way to u (`fits_int64` asks the
  // same of the formats; these let it be asked of the values at hand).
  int product_growth = 0, base_growth = 0;
  // delta_f: f m 2^-e always has more fraction bits than u1 and u, though not too many for a shift of 64-bit
  // lanes.
  bool aligned = false;
  InverseDepth q;
  ReciprocalUnit reciprocal;  // R_pixel
  int divides_per_fragment = 0;
  int subspan_bits = 0;  // 0: every fragment is exact
};
SpanStage prepare_span(const Config& config, const Constants& constants);

// The registers on the next fragment of a span.
struct SpanState {
  std::int64_t triangle = 0, x = 0, y = 0;
  std::int64_t left = 0;  // fragments to come: finished where 0
  std::int64_t h = 0, fu = 0, fv = 0, phase = 0;
  std::array<std::int64_t, 4> shade{};
  std::int64_t u1 = 0, v1 = 0, h_step = 0;
  std::array<std::int64_t, 2> fu_step{}, fv_step{};  // step0, step1
  std::array<std::array<std::int64_t, 4>, 2> shade_step{};
  std::int64_t k = 0, one = 1;  // digital line: phase + k against 1; never steps where k = 0, phase = 0
  bool along_y = false;
  const Coverage* coverage = nullptr;  // none: every fragment is covered
  // Of the fragment delivered last.
  int divides = 0;
  // Where subspans are on: linear fragments to come, and u and v of the exact ones at both ends.
  int linear_left = 0;
  std::array<std::int64_t, 2> near{}, far{};
};
inline bool finished(const SpanState& state) { return state.left == 0; }

// geometry: of a line, and in const_depth_rows; else null. It must outlive the state.
SpanState start_span(const SpanRecord& span, const PlaneGeometry* geometry);

// One fragment, and steps the registers to the next; not to be called when finished.
template <class Watch = NoObserve>
void span(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch = {});

}  // namespace bitspan::model
