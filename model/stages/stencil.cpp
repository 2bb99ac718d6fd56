// SPDX-License-Identifier: Apache-2.0
#include "model/stages/stencil.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/compare.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {
namespace {

std::int64_t applied(StencilOp op, std::int64_t stored, std::int64_t ref) {
  switch (op) {
    case StencilOp::keep:
      return stored;
    case StencilOp::zero:
      return 0;
    case StencilOp::replace:
      return ref;
    case StencilOp::increment:
      return std::min<std::int64_t>(stored + 1, 255);
    case StencilOp::decrement:
      return std::max<std::int64_t>(stored - 1, 0);
    case StencilOp::invert:
      return ~stored & 255;
    case StencilOp::increment_wrap:
      return (stored + 1) & 255;
    case StencilOp::decrement_wrap:
      return (stored - 1) & 255;
  }
  unreachable();
}

}  // namespace

StencilStage prepare_stencil(const DrawState& state) {
  StencilStage s;
  s.test = state.stencil_test;
  StencilSide& front = s.side[0];
  front = {state.stencil_func, state.stencil_fail, state.stencil_zfail, state.stencil_pass,
           state.stencil_ref,  state.stencil_mask, state.stencil_write};
  const auto own = [](std::int64_t value, std::int64_t of_front) { return value < 0 ? of_front : value; };
  s.side[1] = state.stencil_two_sided ? StencilSide{state.stencil_back_func,
                                                    state.stencil_back_fail,
                                                    state.stencil_back_zfail,
                                                    state.stencil_back_pass,
                                                    own(state.stencil_back_ref, front.ref),
                                                    own(state.stencil_back_mask, front.mask),
                                                    own(state.stencil_back_write, front.write)}
                                      : front;
  return s;
}

bool is_back_face(const SetupStage& stage, const Triangle& triangle) {
  std::array<std::int64_t, 3> x{};
  std::array<std::int64_t, 3> y{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = quantize(exact_of(triangle.v[i].x), stage.coordinate, NoObserve{});
    y[i] = quantize(exact_of(triangle.v[i].y), stage.coordinate, NoObserve{});
  }
  return int128(x[1] - x[0]) * (y[2] - y[0]) - int128(x[2] - x[0]) * (y[1] - y[0]) > 0;
}

bool stencil(const StencilStage& stage, bool back, const DepthRecord& depth, std::uint8_t stored,
             StencilRecord& out) {
  const StencilSide& side = stage.side[back ? 1 : 0];
  const bool pass = compares<std::int64_t>(side.func, side.ref & side.mask, stored & side.mask);
  const StencilOp op = !pass ? side.fail : depth.pass == 0 ? side.zfail : side.pass;
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.back = back ? 1 : 0;
  out.stored = stored;
  out.pass = pass ? 1 : 0;
  out.op = static_cast<std::int64_t>(op);
  out.value = (stored & ~side.write) | (applied(op, stored, side.ref) & side.write);
  return pass && depth.pass == 1;
}

}  // namespace bitspan::model
