// SPDX-License-Identifier: Apache-2.0
#include "golden/stencil.hpp"

#include <bitset>

#include "golden/compare.hpp"
#include "golden/quantize.hpp"

namespace bitspan::golden {
namespace {

using Byte = std::bitset<8>;

int made_by(StencilOp op, int s, int ref) {
  switch (op) {
    case StencilOp::keep:
      return s;
    case StencilOp::zero:
      return 0;
    case StencilOp::replace:
      return ref;
    case StencilOp::increment:
      return s == 255 ? 255 : s + 1;
    case StencilOp::decrement:
      return s == 0 ? 0 : s - 1;
    case StencilOp::invert:
      return 255 - s;
    case StencilOp::increment_wrap:
      return s == 255 ? 0 : s + 1;
    case StencilOp::decrement_wrap:
      return s == 0 ? 255 : s - 1;
  }
  return s;
}

// What a register of the back faces stands for.
unsigned of_face(bool own, std::int32_t back, std::int32_t front) {
  return static_cast<unsigned>(own && back != -1 ? back : front);
}

}  // namespace

bool runs_clockwise(const Config& config, const Triangle& triangle) {
  const Quantizer<Quad> snap(config.coordinate_format());
  const auto x = [&](std::size_t i) { return snap(Quad(triangle.v[i].x)); };
  const auto y = [&](std::size_t i) { return snap(Quad(triangle.v[i].y)); };
  return (x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0)) > 0;
}

StencilRecord stencil(const DrawState& state, bool back, const DepthRecord& depth, std::uint8_t stored) {
  const bool own = back && state.stencil_two_sided;
  const unsigned ref = of_face(own, state.stencil_back_ref, state.stencil_ref);
  const Byte mask(of_face(own, state.stencil_back_mask, state.stencil_mask));
  const Byte write(of_face(own, state.stencil_back_write, state.stencil_write));
  const auto reference = (Byte(ref) & mask).to_ulong();
  const auto value = (Byte(stored) & mask).to_ulong();
  StencilRecord out;
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.back = back ? 1 : 0;
  out.stored = stored;
  out.pass = holds(own ? state.stencil_back_func : state.stencil_func, reference, value) ? 1 : 0;
  StencilOp op = own ? state.stencil_back_pass : state.stencil_pass;
  if (depth.pass == 0) op = own ? state.stencil_back_zfail : state.stencil_zfail;
  if (out.pass == 0) op = own ? state.stencil_back_fail : state.stencil_fail;
  out.op = static_cast<std::int64_t>(op);
  const Byte made(static_cast<unsigned>(made_by(op, stored, static_cast<int>(ref))));
  Byte next(stored);
  for (std::size_t bit = 0; bit < next.size(); ++bit) {
    if (write[bit]) next[bit] = made[bit];
  }
  out.value = static_cast<std::int64_t>(next.to_ulong());
  return out;
}

}  // namespace bitspan::golden
