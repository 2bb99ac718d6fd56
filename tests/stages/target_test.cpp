// SPDX-License-Identifier: Apache-2.0
// Targets, dither, blends and logic operations of merge over every code: golden and the model against a
// definition of this file's own.
#include "golden/target.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "golden/merge.hpp"
#include "model/stages/merge.hpp"
#include "tests/stages/worked.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using Codes = std::array<int, 4>;  // red, green, blue, alpha

template <class E>
std::vector<E> all_of() {
  std::vector<E> out;
  for (std::size_t i = 0; i < enum_names<E>.size(); ++i) out.push_back(static_cast<E>(i));
  return out;
}

// The stage merge of both views in one draw state.
class Merging {
 public:
  explicit Merging(const DrawState& state) : state_(state) {
    model::set_blend(stage_, model::blend_of(state));
  }

  // What is stored for a fragment of these codes over others at pixel (x, y); a: alpha, raw. The views agree.
  Codes operator()(const Codes& fragment, std::int64_t a, const Codes& below, int x, int y) {
    FogRecord fog{};
    fog.x = x;
    fog.y = y;
    fog.r = std::int64_t{fragment[0]} << stage_.color_in.fraction;
    fog.g = std::int64_t{fragment[1]} << stage_.color_in.fraction;
    fog.b = std::int64_t{fragment[2]} << stage_.color_in.fraction;
    TextureRecord texture{};
    texture.x = x;
    texture.y = y;
    texture.a = a;
    DepthRecord depth{};
    depth.x = x;
    depth.y = y;
    std::array<std::uint8_t, 4> stored{};
    for (std::size_t c = 0; c < 4; ++c) stored[c] = static_cast<std::uint8_t>(below[c]);
    MergeRecord color;
    model::merge(stage_, depth, texture, fog, stored, color);
    MergeAlphaRecord alpha{0, x, y, -1};
    if (stage_.changes_alpha) alpha = model::merged_alpha(stage_, texture, stored[3]);

    const auto at = 4 * static_cast<std::size_t>(y * width + x);
    for (std::size_t c = 0; c < 4; ++c) picture_[at + c] = stored[c];
    colors_.clear();
    alphas_.clear();
    const std::array<const TextureRecord*, 1> textures{&texture};
    const std::array<const DepthRecord*, 1> depths{&depth};
    golden_({&fog, 1}, textures, depths, state_, picture_, {width}, colors_, alphas_);
    EXPECT_EQ(colors_.at(0), color);
    EXPECT_EQ(alphas_.empty() ? -1 : alphas_[0].a, alpha.a);
    return {static_cast<int>(color.r), static_cast<int>(color.g), static_cast<int>(color.b),
            static_cast<int>(alpha.a)};
  }
  std::int64_t opaque() const { return std::int64_t{1} << stage_.alpha.fraction; }

 private:
  static constexpr int width = 8;
  DrawState state_;
  Config config_ = shipped_config("depth16");
  model::MergeStage stage_ = model::prepare_merge(config_);
  golden::MergeStage golden_ = golden::make_merge({}, config_);
  std::vector<std::uint8_t> picture_ = std::vector<std::uint8_t>(4 * width * width);
  std::vector<MergeRecord> colors_;
  std::vector<MergeAlphaRecord> alphas_;
};

// ---------------------------------------------------------------- definitions

// The places of a 4 x 4 block as x + 4 y, the one with the smallest d first.
constexpr std::array<int, 16> by_rank{0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};
int rank_of(int x, int y) {
  for (int d = 0; d < 16; ++d) {
    if (by_rank[static_cast<std::size_t>(d)] == x % 4 + 4 * (y % 4)) return d;
  }
  return -1;
}
int sixteenths(Dither dither, int x, int y) {
  constexpr std::array<int, 4> pairs{0, 8, 12, 4};  // row by row
  const auto pair = static_cast<std::size_t>(x % 2 + 2 * (y % 2));
  if (dither == Dither::none) return 0;
  if (dither == Dither::matrix2) return pairs[pair];
  if (dither == Dither::sst1_2) return pairs[pair] + 2;
  return rank_of(x, y);
}
// The code of n bits: the largest one that is not above the exact value, in 1/4096 of its step.
int plain_code(int bits, int code, int d) {
  const int exact = code * (16 << bits) + 256 * d;
  int out = 0;
  while (out + 1 < 1 << bits && 4096 * (out + 1) <= exact) ++out;
  return out;
}
// The SST-1's table: the level in sixteenths of a step rises with each code by 16 2^n / 256, but by one less
// at each multiple of 16 that is not one of 2^(12-n). Of the 16 places, as many as the level has sixteenths
// beyond a whole step hold the next code, those with the largest d first.
int table_code(int bits, int code, int d) {
  int level = 0;
  for (int v = 1; v <= code; ++v) {
    level += 1 << (bits - 4);
    if (v % 16 == 0 && v % (1 << (12 - bits)) != 0) --level;
  }
  const int next = level % 16;
  return level / 16 + (d >= 16 - next ? 1 : 0);
}
// The bits repeated, as a text.
int expanded(int bits, int code) {
  int out = 0;
  for (int bit = 0; bit < 8; ++bit) out = 2 * out + (code >> (bits - 1 - bit % bits) & 1);
  return out;
}

Codes widths_of(TargetFormat format) {
  switch (format) {
    case TargetFormat::rgba8888:
      return {8, 8, 8, 8};
    case TargetFormat::rgb565:
      return {5, 6, 5, 0};
    case TargetFormat::argb1555:
      return {5, 5, 5, 1};
    case TargetFormat::argb4444:
      return {4, 4, 4, 4};
    case TargetFormat::rgb332:
      return {3, 3, 2, 0};
  }
  return {};
}
// The code of n bits whose share of the largest one is the nearest to code / 255.
int nearest_code_of(int bits, int code) {
  const int most = (1 << bits) - 1;
  int out = 0;
  for (int k = 1; k <= most; ++k) {
    if (std::abs(255 * k - code * most) < std::abs(255 * out - code * most)) out = k;
  }
  return out;
}
int held(TargetFormat format, Dither dither, std::size_t channel, int code, int x, int y) {
  const int bits = widths_of(format)[channel];
  if (bits == 0) return 255;
  if (bits == 8) return code;
  if (channel == 3) return expanded(bits, plain_code(bits, code, 0));
  const int d = sixteenths(dither, x, y);
  const bool by_table = dither == Dither::sst1_4 || dither == Dither::sst1_2;
  // The tables are of 5 and 6 bits.
  if (by_table && bits >= 5) return expanded(bits, table_code(bits, code, d));
  if (by_table) {
    const int lowered = (code << bits >> 4) - code / 16;  // code 2^(n-12) is below 1
    return expanded(bits, (lowered + d) / 16);
  }
  return expanded(bits, plain_code(bits, code, d));
}

// ---------------------------------------------------------------- tests

// The four corners of the SST-1's tables, and a place at which the plain formula differs.
TEST(Target, ByHand) {
  DrawState state = first_state({});
  state.target_format = TargetFormat::rgb565;
  const auto red = [&](Dither dither, int code, int x, int y) {
    state.target_dither = dither;
    Merging merging(state);
    return merging({code, 0, 0, 0}, merging.opaque(), {}, x, y)[0];
  };
  EXPECT_EQ(red(Dither::none, 15, 0, 0), 8);        // 1 of 31
  EXPECT_EQ(red(Dither::matrix4, 15, 1, 0), 16);    // 1 + 7/8 + 8/16
  EXPECT_EQ(red(Dither::matrix4, 15, 0, 0), 8);     // 1 + 7/8
  EXPECT_EQ(red(Dither::matrix4, 255, 0, 3), 255);  // 31 + 7/8 + 15/16, saturated
  EXPECT_EQ(red(Dither::matrix2, 12, 3, 2), 16);    // 1 + 1/2 + 8/16
  EXPECT_EQ(red(Dither::matrix2, 11, 3, 2), 8);     // 1 + 3/8 + 8/16
  EXPECT_EQ(red(Dither::sst1_4, 17, 2, 1), 16);     // level 33 of 16ths, d = 14: 47
  EXPECT_EQ(red(Dither::matrix4, 17, 2, 1), 24);    // 2 + 1/8 + 14/16
  EXPECT_EQ(red(Dither::sst1_4, 17, 0, 3), 24);     // d = 15
  EXPECT_EQ(red(Dither::sst1_2, 7, 0, 0), 8);       // 14 + 2
  EXPECT_EQ(red(Dither::sst1_4, 7, 0, 0), 0);
  // Green has 6 bits, and the target no alpha.
  state.target_dither = Dither::none;
  Merging merging(state);
  EXPECT_EQ(merging({0, 15, 15, 0}, merging.opaque(), {0, 0, 0, 7}, 0, 0), (Codes{0, 12, 8, 255}));
  state.target_format = TargetFormat::argb1555;
  state.blend_alpha_src = BlendFactor::one;
  state.blend_alpha_dst = BlendFactor::zero;
  state.blend_src = BlendFactor::one;
  state.blend_dst = BlendFactor::zero;
  Merging one_bit(state);
  EXPECT_EQ(one_bit({0, 0, 0, 0}, one_bit.opaque() / 2, {}, 0, 0)[3], 255);  // 255/2 + 1/2: 128
  EXPECT_EQ(one_bit({0, 0, 0, 0}, one_bit.opaque() / 2 - 8, {}, 0, 0)[3], 0);
}

// All codes, colours and alpha, of fragments and of clears; what is held stays.
TEST(Target, RoundsToTheNearestCode) {
  int raised = 0, lowered = 0;
  for (const TargetFormat format : all_of<TargetFormat>()) {
    DrawState state = first_state({});
    state.target_format = format;
    state.target_round = TargetRound::nearest;
    Merging merging(state);
    DrawState dithered = state;
    dithered.target_dither = Dither::matrix4;
    Merging dithering(dithered);
    model::MergeStage stage = model::prepare_merge(shipped_config("depth16"));
    model::set_blend(stage, model::blend_of(state));
    for (int code = 0; code < 256; ++code) {
      const Codes got = merging({code, code, code, 0}, merging.opaque(), {0, 0, 0, code}, 3, 2);
      const Codes by_matrix = dithering({code, code, code, 0}, merging.opaque(), {0, 0, 0, code}, 3, 2);
      const auto byte = static_cast<std::uint8_t>(code);
      Clear clear;
      clear.color = {byte, byte, byte};
      clear.alpha = byte;
      const Clear stored = golden::held(state, clear);
      ASSERT_EQ(stored, model::held(stage, clear));
      for (std::size_t c = 0; c < 4; ++c) {
        const int bits = widths_of(format)[c];
        const int want = bits == 0 ? 255 : expanded(bits, nearest_code_of(bits, code));
        ASSERT_EQ(c < 3 ? (*stored.color)[c] : *stored.alpha, want) << to_string(format) << " " << code;
        if (c == 3 && format == TargetFormat::rgba8888) continue;  // it has no record
        ASSERT_EQ(got[c], want) << to_string(format) << " channel " << c << " code " << code;
        // A dither has its own way; alpha has none.
        ASSERT_EQ(by_matrix[c], c == 3 ? want : held(format, Dither::matrix4, c, code, 3, 2));
        if (want > code) ++raised;
        if (want < code) ++lowered;
        ASSERT_EQ(bits == 0 ? 255 : expanded(bits, nearest_code_of(bits, want)), want);
      }
    }
  }
  EXPECT_GT(raised, 500);
  EXPECT_GT(lowered, 500);
}

// 256 codes at 16 places in each format with each dither: all colours, and alpha.
TEST(Target, EveryCodeAtEveryPlace) {
  std::uint64_t compared = 0;
  std::uint64_t raised = 0;
  for (const TargetFormat format : all_of<TargetFormat>()) {
    for (const Dither dither : all_of<Dither>()) {
      DrawState state = first_state({});
      state.target_format = format;
      state.target_dither = dither;
      Merging merging(state);
      DrawState kept = state;  // the fragment leaves the stored codes
      kept.blend_src = BlendFactor::zero;
      kept.blend_dst = BlendFactor::one;
      Merging keeping(kept);
      for (int place = 0; place < 16; ++place) {
        const int x = place % 4 + 4 * (place & 1);
        const int y = place / 4 + 4 * (place >> 3);
        for (int code = 0; code < 256; ++code) {
          const Codes got = merging({code, code, code, 0}, merging.opaque(), {0, 0, 0, code}, x, y);
          for (std::size_t c = 0; c < 4; ++c, ++compared) {
            if (c == 3 && format == TargetFormat::rgba8888) continue;  // it has no record
            const int want = held(format, dither, c, code, x, y);
            ASSERT_EQ(got[c], want) << to_string(format) << " " << to_string(dither) << " channel " << c
                                    << " code " << code << " at " << x << ", " << y;
            raised += want > code ? 1 : 0;
          }
          // The golden and the model's clears, which have no dither.
          if (place > 0 || dither != Dither::matrix4) continue;
          const auto byte = static_cast<std::uint8_t>(code);
          Clear clear;
          clear.color = {byte, byte, byte};
          clear.alpha = byte;
          model::MergeStage stage = model::prepare_merge(shipped_config("depth16"));
          model::set_blend(stage, model::blend_of(state));
          const Clear stored = golden::held(state, clear);
          ASSERT_EQ(stored, model::held(stage, clear));
          for (std::size_t c = 0; c < 3; ++c)
            ASSERT_EQ((*stored.color)[c], held(format, Dither::none, c, code, 0, 0));
          ASSERT_EQ(*stored.alpha, held(format, Dither::none, 3, code, 0, 0));
          // What is held stays, where there is no dither.
          DrawState plain = kept;
          plain.target_dither = Dither::none;
          Merging again(plain);
          const Codes below{(*stored.color)[0], (*stored.color)[1], (*stored.color)[2], *stored.alpha};
          const Codes after = again({9, 9, 9, 0}, merging.opaque(), below, 0, 0);
          for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(after[c], below[c]);
          if (is_narrow(format)) {
            ASSERT_EQ(after[3], below[3]);
          }
        }
      }
    }
  }
  EXPECT_EQ(compared, 5U * 5 * 16 * 256 * 4);
  EXPECT_GT(raised, 50000U);
}

// The plain formula gives another code than the SST-1's in as many entries of its table as are known.
TEST(Target, TheSst1IsNotThePlainFormula) {
  int other = 0;
  for (int code = 0; code < 256; ++code) {
    for (int place = 0; place < 16; ++place) {
      const int x = place % 4;
      const int y = place / 4;
      other += held(TargetFormat::rgb565, Dither::sst1_4, 0, code, x, y) !=
                       held(TargetFormat::rgb565, Dither::matrix4, 0, code, x, y)
                   ? 1
                   : 0;
    }
  }
  EXPECT_EQ(other, 1736);
}

// The colour that comes out in a narrow target is read back by the next fragment.
TEST(Target, LogicWorksOnTheExpandedCodes) {
  DrawState state = first_state({});
  state.target_format = TargetFormat::rgb565;
  state.logic_op = LogicOp::exclusive_or;
  Merging merging(state);
  // 1000'0100 XOR 0000'1111 = 1000'1011, of which five bits stay: 10001, and 100010 of green.
  EXPECT_EQ(merging({0x0f, 0x0f, 0, 0}, merging.opaque(), {0x84, 0x84, 0, 255}, 0, 0),
            (Codes{0x8c, 0x8a, 0, 255}));
}

// c(n), in 1/256.
int share(int code) { return code + (code >= 128 ? 1 : 0); }

// 256 pairs of factors, 65,536 pairs of codes; without $BITSPAN_LONG some of them. Three pairs per fragment.
TEST(Target, EveryPairOfFactors) {
  const bool whole = is_long_run();
  const int step = whole ? 1 : 9;
  const auto factors = all_of<BlendFactor>();
  std::uint64_t compared = 0;
  std::uint64_t inside = 0;
  for (const BlendFactor by_src : factors) {
    for (const BlendFactor by_dst : factors) {
      DrawState state = first_state({});
      state.blend_src = by_src;
      state.blend_dst = by_dst;
      state.blend_red = 200;
      state.blend_green = 90;
      state.blend_blue = 17;
      state.blend_alpha = 140;
      Merging merging(state);
      const auto one = static_cast<int>(merging.opaque());
      ASSERT_EQ(one % 256, 0);
      const int unit = one / 256;  // all factors are multiples of 1/one
      for (int src = 0; src < 256; src += step) {
        const int a = (src * 37 + 11) % (one + 1);
        for (int dst = 0; dst < 256; dst += 3 * step) {
          const int dst_alpha = (src * 5 + dst) % 256;
          Codes below{dst, std::min(dst + step, 255), std::min(dst + 2 * step, 255), dst_alpha};
          const Codes got = merging({src, src, src, 0}, a, below, src % 8, dst % 8);
          for (std::size_t c = 0; c < 3; ++c, ++compared) {
            const std::array<int, 3> constant{200, 90, 17};
            const auto factor = [&](BlendFactor f) {
              // The names stand in pairs of X and 1 - X behind `zero` and `one`; the last two stand alone.
              const int n = static_cast<int>(f);
              if (n == 0) return 0;
              if (n == 1) return one;
              if (n == 14) return std::min(a, one - unit * share(dst_alpha));
              if (n == 15) return one / 2;
              const std::array<int, 6> of{
                  unit * share(src),       unit * share(below[c]),    a,
                  unit * share(dst_alpha), unit * share(constant[c]), unit * share(140)};
              const int x = of[static_cast<std::size_t>(n / 2 - 1)];
              return n % 2 == 0 ? x : one - x;
            };
            const int sum = src * factor(by_src) + below[c] * factor(by_dst);
            const int want = std::min(255, (2 * sum + one) / (2 * one));  // half up
            ASSERT_EQ(got[c], want) << to_string(by_src) << " " << to_string(by_dst) << " src " << src
                                    << " dst " << below[c] << " a " << a;
            inside += want > 0 && want < 255 ? 1 : 0;
          }
        }
      }
    }
  }
  const std::uint64_t sources = whole ? 256 : 29;
  const std::uint64_t fragments = whole ? 86 : 10;
  EXPECT_EQ(compared, 256 * sources * fragments * 3);
  EXPECT_GT(inside, compared / 3);
}

// 16 operations on 65,536 pairs of codes, by the results for (S', D) = (0, 0), (0, 1), (1, 0), (1, 1).
TEST(Target, EveryLogicOperation) {
  const std::array<std::pair<std::string_view, std::string_view>, 16> results{{{"clear", "0000"},
                                                                               {"and", "0001"},
                                                                               {"and_reverse", "0010"},
                                                                               {"copy", "0011"},
                                                                               {"and_inverted", "0100"},
                                                                               {"noop", "0101"},
                                                                               {"xor", "0110"},
                                                                               {"or", "0111"},
                                                                               {"nor", "1000"},
                                                                               {"equiv", "1001"},
                                                                               {"invert", "1010"},
                                                                               {"or_reverse", "1011"},
                                                                               {"copy_inverted", "1100"},
                                                                               {"or_inverted", "1101"},
                                                                               {"nand", "1110"},
                                                                               {"set", "1111"}}};
  std::uint64_t compared = 0;
  for (const auto& [name, result] : results) {
    const std::string_view wanted_name = name;
    const std::string_view wanted = result;
    DrawState state = first_state({});
    for (const LogicOp op : all_of<LogicOp>()) {
      if (to_string(op) == wanted_name) state.logic_op = op;
    }
    ASSERT_NE(state.logic_op, LogicOp::none) << wanted_name;
    Merging merging(state);
    const auto of = [&](int src, int dst) {
      int out = 0;
      for (int bit = 0; bit < 8; ++bit) {
        const auto row = static_cast<std::size_t>(2 * (src >> bit & 1) + (dst >> bit & 1));
        out |= wanted[row] == '1' ? 1 << bit : 0;
      }
      return out;
    };
    for (int src = 0; src < 256; ++src) {
      // The code that alpha stands for.
      const std::int64_t a = src * merging.opaque() / 256;
      const auto as = static_cast<int>((510 * a + merging.opaque()) / (2 * merging.opaque()));
      for (int dst = 0; dst < 256; dst += 2, compared += 2) {
        const Codes below{dst, dst + 1, 255 - dst, dst};
        const Codes got = merging({src, src, 255 - src, 0}, a, below, 0, 0);
        ASSERT_EQ(got, (Codes{of(src, dst), of(src, dst + 1), of(255 - src, 255 - dst), of(as, dst)}))
            << wanted_name << " " << src << " " << dst;
      }
    }
  }
  EXPECT_EQ(compared, 16U * 65536);
}

}  // namespace
}  // namespace bitspan
