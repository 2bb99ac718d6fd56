// span: along a span, a fragment a call. docs/numeric-spec.md, "span" (T1; N3; N1 and N2).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/plane_walk.hpp"

namespace bitspan::model {

// acc = Q(acc + step): how far each is shifted onto the common grid.
struct Adder {
  Register acc;
  int acc_up = 0, step_up = 0, fraction = 0;
};
Adder make_adder(const Register& acc, const Register& step);

// h + B on its grid: (h << h_up) + b.
struct InverseDepth {
  int h_up = 0, fraction = 0;
  int128 b = 0;
};
InverseDepth make_inverse_depth(const Config& config, const Constants& constants);

struct SpanStage {
  Perspective perspective = Perspective::delta_f;
  bool narrow = false;  // every intermediate fits int64
  InverseDepth q;
  ReciprocalUnit reciprocal;  // R_pixel
  Adder h, f, shade_acc;
  int u1_fraction = 0;
  Register uv, shade;
  int divides_per_fragment = 0;
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
};
inline bool finished(const SpanState& state) { return state.left == 0; }

// geometry: const_depth_rows only, else null; it must outlive the state.
SpanState start_span(const SpanRecord& span, const PlaneGeometry* geometry);

// One fragment, and steps the registers to the next; not to be called when finished.
template <class Watch = NoObserve>
void span(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch = {});

}  // namespace bitspan::model
