// SPDX-License-Identifier: Apache-2.0
#include "golden/target.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "config/modes.hpp"
#include "golden/mask.hpp"
#include "golden/texel.hpp"

namespace bitspan::golden {
namespace {

constexpr std::size_t alpha = 3;

// Sixteenths of a step; row y mod 4, column x mod 4.
constexpr std::array<std::array<int, 4>, 4> bayer{
    {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}}};

double share_of_step(Dither dither, std::int64_t x, std::int64_t y) {
  const auto at = [&](std::int64_t size) {
    return bayer[static_cast<std::size_t>(y % size)][static_cast<std::size_t>(x % size)];
  };
  switch (dither) {
    case Dither::none:
      return 0;
    case Dither::matrix4:
    case Dither::sst1_4:
      return at(4);
    case Dither::matrix2:
      return at(2);
    case Dither::sst1_2:
      return at(2) + 2;
  }
  unreachable();
}

// The target's own code, of `bits` bits. All numbers are multiples of 1/64 below 2^13, so that doubles hold
// them.
double narrowed(Dither dither, TargetRound round, int bits, double code, std::int64_t x, std::int64_t y) {
  const double d = share_of_step(dither, x, y);
  const double most = std::exp2(bits) - 1;
  // Never a tie: 255 is odd.
  if (dither == Dither::none && round == TargetRound::nearest) return std::round(code * most / 255);
  switch (dither) {
    case Dither::none:
    case Dither::matrix4:
    case Dither::matrix2:
      return std::min(most, std::floor(code * std::exp2(bits - 8) + d / 16));
    case Dither::sst1_4:
    case Dither::sst1_2: {
      const double lowered =
          code * std::exp2(bits - 4) - std::floor(code / 16) + std::floor(code * std::exp2(bits - 12));
      return std::floor((lowered + d) / 16);
    }
  }
  unreachable();
}

}  // namespace

std::int64_t held(const DrawState& state, std::size_t channel, std::int64_t code, std::int64_t x,
                  std::int64_t y) {
  const int bits = target_bits(state.target_format)[channel];
  if (bits == 0) return 255;
  if (bits == 8) return code;
  const Dither dither = channel == alpha ? Dither::none : state.target_dither;
  const double own = narrowed(dither, state.target_round, bits, static_cast<double>(code), x, y);
  return static_cast<std::int64_t>(expanded(static_cast<std::uint64_t>(own), std::exp2(bits)));
}

Clear held(const DrawState& state, Clear clear) {
  DrawState plain = state;
  plain.target_dither = Dither::none;
  const auto byte = [&](std::size_t channel, std::uint8_t code) {
    return static_cast<std::uint8_t>(held(plain, channel, code, 0, 0));
  };
  if (clear.color) {
    for (std::size_t c = 0; c < clear.color->size(); ++c) (*clear.color)[c] = byte(c, (*clear.color)[c]);
  }
  if (clear.alpha) clear.alpha = byte(alpha, *clear.alpha);
  return clear;
}

void clear_masked(Frame& frame, const DrawState& state, const Clear& clear, std::uint32_t farthest) {
  if (clear.stencil) need_stencil(frame);
  const std::bitset<8> kept = ~std::bitset<8>(static_cast<unsigned>(state.stencil_write));
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const auto place = static_cast<std::int64_t>(i);
    if (is_outside_scissor(state, frame.grid().x_of(place), frame.grid().y_of(place))) continue;
    for (std::size_t c = 0; c < 4; ++c) {
      if (!state.color_write || !std::bitset<4>(static_cast<unsigned>(state.color_mask))[c]) continue;
      std::uint8_t& code = frame.color[4 * i + c];
      if (c == alpha) {
        code = clear.alpha.value_or(code);
      } else if (clear.color) {
        code = (*clear.color)[c];
      }
    }
    if (clear.color && state.color_write && !frame.u.empty()) clear_winner(frame, i);
    if (clear.depth && state.depth_write) frame.depth[i] = farthest;
    if (clear.stencil) {
      const std::bitset<8> now =
          (std::bitset<8>(*clear.stencil) & ~kept) | (std::bitset<8>(frame.stencil[i]) & kept);
      frame.stencil[i] = static_cast<std::uint8_t>(now.to_ulong());
    }
  }
}

}  // namespace bitspan::golden
