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
  s.ref = state.stencil_ref;
  s.mask = state.stencil_mask;
  s.write = state.stencil_write;
  s.side[0] = {state.stencil_func, state.stencil_fail, state.stencil_zfail, state.stencil_pass};
  s.side[1] = state.stencil_two_sided ? StencilSide{state.stencil_back_func, state.stencil_back_fail,
                                                    state.stencil_back_zfail, state.stencil_back_pass}
                                      : s.side[0];
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
  const bool pass = compares<std::int64_t>(side.func, stage.ref & stage.mask, stored & stage.mask);
  const StencilOp op = !pass ? side.fail : depth.pass == 0 ? side.zfail : side.pass;
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.back = back ? 1 : 0;
  out.stored = stored;
  out.pass = pass ? 1 : 0;
  out.op = static_cast<std::int64_t>(op);
  out.value = (stored & ~stage.write) | (applied(op, stored, stage.ref) & stage.write);
  return pass && depth.pass == 1;
}

}  // namespace bitspan::model
