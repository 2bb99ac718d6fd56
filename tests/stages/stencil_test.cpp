// SPDX-License-Identifier: Apache-2.0
#include "model/stages/stencil.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "golden/stencil.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

// 8 functions x 8 operations on every pair of four-bit values, in each of the three cases.
TEST(Stencil, Exhaustively) {
  DrawState state = first_state({});
  state.stencil_test = true;
  std::uint64_t failed = 0;
  for (int func = 0; func < 8; ++func) {
    for (int op = 0; op < 8; ++op) {
      state.stencil_func = static_cast<CompareFunc>(func);
      state.stencil_fail = static_cast<StencilOp>(op);
      state.stencil_zfail = static_cast<StencilOp>((op + 3) % 8);
      state.stencil_pass = static_cast<StencilOp>((op + 5) % 8);
      for (const int mask : {255, 15, 5}) {
        state.stencil_mask = mask;
        state.stencil_write = 255 - 16 * (mask & 5);
        for (int ref = 0; ref < 256; ref += ref == 15 ? 225 : 1) {
          state.stencil_ref = ref;
          for (int value = 0; value < 256; value += value == 15 ? 225 : 1) {
            for (const int z : {0, 1}) {
              const DepthRecord depth{.triangle = 1, .x = 2, .y = 3, .pass = z};
              StencilRecord out;
              const auto stored = static_cast<std::uint8_t>(value);
              const bool passes = model::stencil(model::prepare_stencil(state), false, depth, stored, out);
              const StencilRecord expected = golden::stencil(state, false, depth, stored);
              ASSERT_EQ(out, expected) << func << " " << op << " " << ref << " " << value;
              ASSERT_EQ(passes, expected.pass == 1 && z == 1);
              failed += out.pass == 0 ? 1 : 0;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(failed, 10000U);
}

// Every function and operation on all states of four bits: reference, stored value and mask, with the other
// four bits of each at either end, against a definition of its own.
TEST(Stencil, EveryStateOfFourBits) {
  constexpr std::array<const char*, 8> funcs{"", "<", "=", "<=", ">", "<>", ">=", "<=>"};
  DrawState state = first_state({});
  state.stencil_test = true;
  std::uint64_t compared = 0;
  for (std::size_t func = 0; func < funcs.size(); ++func) {
    state.stencil_func = static_cast<CompareFunc>(func);
    for (int op = 0; op < 8; ++op) {
      state.stencil_fail = state.stencil_zfail = state.stencil_pass = static_cast<StencilOp>(op);
      for (int bits = 0; bits < 4096; ++bits) {
        for (const int high : {0, 0xf0}) {
          const int ref = high | (bits & 15);
          const int value = high | (bits >> 4 & 15);
          const int mask = bits >> 8;
          state.stencil_ref = ref;
          state.stencil_mask = mask;
          StencilRecord out;
          const DepthRecord depth{.pass = 1};
          model::stencil(model::prepare_stencil(state), false, depth, static_cast<std::uint8_t>(value), out);
          ASSERT_EQ(out, golden::stencil(state, false, depth, static_cast<std::uint8_t>(value)));
          const int order = (ref & mask) - (value & mask);
          const char sign = order < 0 ? '<' : order > 0 ? '>' : '=';
          ASSERT_EQ(out.pass == 1, std::string_view(funcs[func]).find(sign) != std::string_view::npos)
              << funcs[func] << " " << ref << " " << value << " " << mask;
          const std::array<int, 8> made{value,
                                        0,
                                        ref,
                                        std::min(value + 1, 255),
                                        std::max(value - 1, 0),
                                        ~value & 255,
                                        (value + 1) & 255,
                                        (value + 255) & 255};
          ASSERT_EQ(out.value, made[static_cast<std::size_t>(op)]) << op << " " << value;
          ++compared;
        }
      }
    }
  }
  EXPECT_EQ(compared, 8U * 8 * 4096 * 2);
}

TEST(Stencil, ByHand) {
  DrawState state = first_state({});
  state.stencil_ref = 0x0f;
  state.stencil_mask = 0x3c;
  state.stencil_write = 0xf0;
  state.stencil_func = CompareFunc::less;  // 0x0c < stored & 0x3c
  state.stencil_fail = StencilOp::invert;
  state.stencil_pass = StencilOp::increment;
  const DepthRecord depth{.pass = 1};
  EXPECT_EQ(golden::stencil(state, false, depth, 0x1f).pass, 1);
  EXPECT_EQ(golden::stencil(state, false, depth, 0x1f).value,
            0x2f);  // 0x20, of which the upper four bits are written
  EXPECT_EQ(golden::stencil(state, false, depth, 0xcd).pass, 0);
  EXPECT_EQ(golden::stencil(state, false, depth, 0xcd).value, 0x3d);
  state.stencil_two_sided = true;
  state.stencil_back_func = CompareFunc::never;
  state.stencil_back_fail = StencilOp::replace;
  state.stencil_write = 0xff;
  EXPECT_EQ(golden::stencil(state, true, depth, 0x1f).value, 0x0f);
}

// Each of the three alone, over the front's values and in a one-sided state, where none of them counts.
TEST(Stencil, BackFacesTakeTheirOwnReferenceAndMasks) {
  DrawState state = first_state({});
  state.stencil_test = state.stencil_two_sided = true;
  state.stencil_ref = 0x35;
  state.stencil_mask = 0x0f;
  state.stencil_write = 0xf0;
  state.stencil_func = state.stencil_back_func = CompareFunc::equal;
  state.stencil_pass = state.stencil_back_pass = StencilOp::replace;
  state.stencil_fail = state.stencil_back_fail = StencilOp::invert;
  const DepthRecord depth{.pass = 1};
  const auto expect = [&](bool back, std::uint8_t stored, int pass, int value) {
    StencilRecord out;
    model::stencil(model::prepare_stencil(state), back, depth, stored, out);
    EXPECT_EQ(out, golden::stencil(state, back, depth, stored));
    EXPECT_EQ(out.pass, pass) << int{stored};
    EXPECT_EQ(out.value, value) << int{stored};
  };
  // 5 = 5: the upper half of 0x35 is written.
  expect(false, 0x85, 1, 0x35);
  expect(true, 0x85, 1, 0x35);
  state.stencil_back_ref = 0x46;  // 6 is not 5: the upper half of 0x7a
  expect(true, 0x85, 0, 0x75);
  expect(true, 0x86, 1, 0x46);
  expect(false, 0x85, 1, 0x35);
  state.stencil_back_mask = 0xff;
  expect(true, 0x86, 0, 0x76);
  expect(true, 0x46, 1, 0x46);
  state.stencil_back_write = 0x01;
  expect(true, 0x86, 0, 0x87);  // the lowest bit of 0x79
  state.stencil_back_mask = 0;
  state.stencil_back_ref = 0;
  expect(true, 0xff, 1, 0xfe);
  state.stencil_two_sided = false;
  expect(true, 0x85, 1, 0x35);
}

TEST(Stencil, FacingFollowsTheOrderOfInput) {
  const Config config = shipped_config("depth16");
  Triangle t;
  t.v[0].x = 1;
  t.v[0].y = 1;
  t.v[1].x = 9;
  t.v[1].y = 1;
  t.v[2].x = 1;
  t.v[2].y = 9;
  EXPECT_TRUE(golden::runs_clockwise(config, t));
  std::swap(t.v[0], t.v[2]);
  EXPECT_FALSE(golden::runs_clockwise(config, t));
  std::swap(t.v[1], t.v[2]);
  EXPECT_TRUE(golden::runs_clockwise(config, t));
}

}  // namespace
}  // namespace bitspan
