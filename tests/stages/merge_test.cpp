// SPDX-License-Identifier: Apache-2.0
#include "model/stages/merge.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "golden/merge.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

MergeRecord merged(const Config& c, double colour, double alpha, std::array<std::uint8_t, 4> stored) {
  DepthRecord z;
  z.triangle = 1;
  z.x = 2;
  z.y = 3;
  z.z = 4;
  TextureRecord t;
  t.a = encoded(alpha, c.format(FormatId::texture_alpha));
  FogRecord f;
  f.r = f.g = f.b = encoded(colour, c.format(FormatId::fog_color));
  MergeRecord out;
  model::merge(model::prepare_merge(c), z, t, f, stored, out);
  EXPECT_EQ(out.triangle, 1);
  EXPECT_EQ(out.x, 2);
  EXPECT_EQ(out.y, 3);
  EXPECT_EQ(out.z, 4);
  return out;
}

TEST(Merge, OpaqueReplaces) {
  const MergeRecord r = merged(plain_config(), 99.5, 1, {1, 2, 3});
  EXPECT_EQ(r.r, 100);  // half up
  EXPECT_EQ(r.g, 100);
  EXPECT_EQ(merged(plain_config(), 255.9375, 1, {}).r, 255);  // saturates
}

TEST(Merge, TranslucentBlends) {
  const MergeRecord r = merged(plain_config(), 100, 0.25, {0, 100, 200});
  EXPECT_EQ(r.r, 25);
  EXPECT_EQ(r.g, 100);
  EXPECT_EQ(r.b, 175);
}

// Alpha that can pass 1 does not extrapolate.
TEST(Merge, AlphaAboveOneIsOpaque) {
  Config c = plain_config();
  c.format(FormatId::texture_alpha) = {12, 2, false, Rounding::rnd, Overflow::sat, false};
  EXPECT_EQ(merged(c, 100, 1.5, {200, 0, 0}).r, 100);
  EXPECT_EQ(merged(c, 100, 0.5, {200, 0, 0}).r, 150);
}

TEST(Merge, RoundingIsTheFormats) {
  Config c = plain_config();
  c.format(FormatId::merge_color).rounding = Rounding::trn;
  EXPECT_EQ(merged(c, 99.9375, 1, {}).r, 99);
  EXPECT_EQ(merged(c, 3, 0.5, {0, 0, 0}).r, 1);
}

TEST(Merge, NarrowAndWideAgree) {
  const Config c = shipped_config("depth16");
  const auto stage = model::prepare_merge(c);
  ASSERT_TRUE(stage.fits_int64);
  auto wide = stage;
  wide.fits_int64 = false;
  std::mt19937_64 random(61);
  for (int i = 0; i < 50000; ++i) {
    TextureRecord t;
    t.a = static_cast<std::int64_t>(random() % 1025);
    FogRecord f;
    f.r = static_cast<std::int64_t>(random() % 4096);
    f.g = static_cast<std::int64_t>(random() % 4096);
    const std::array<std::uint8_t, 4> stored{static_cast<std::uint8_t>(random()),
                                             static_cast<std::uint8_t>(random()),
                                             static_cast<std::uint8_t>(random())};
    MergeRecord a;
    MergeRecord b;
    model::merge(stage, {}, t, f, stored, a);
    model::merge(wide, {}, t, f, stored, b);
    ASSERT_EQ(a, b);
  }
}

// Any blend, in the model and in golden.
struct Merged {
  MergeRecord color;
  std::int64_t alpha = -1;
};
struct Fragment {
  std::int64_t color = 0, alpha = 0;  // raw
};

Merged by_model(const Config& config, const DrawState& state, Fragment f,
                std::array<std::uint8_t, 4> stored) {
  model::MergeStage stage = model::prepare_merge(config);
  model::set_blend(stage, model::blend_of(state));
  TextureRecord texture{};
  texture.a = f.alpha;
  FogRecord fog{};
  fog.r = fog.g = fog.b = f.color;
  Merged out;
  model::merge(stage, DepthRecord{}, texture, fog, stored, out.color);
  if (stage.changes_alpha) out.alpha = model::merged_alpha(stage, texture, stored[3]).a;
  return out;
}
Merged by_golden(const golden::MergeStage& stage, const DrawState& state, Fragment f,
                 std::array<std::uint8_t, 4> stored) {
  TextureRecord texture{};
  texture.a = f.alpha;
  FogRecord fog{};
  fog.r = fog.g = fog.b = f.color;
  const DepthRecord depth{};
  const std::array<const TextureRecord*, 1> textures{&texture};
  const std::array<const DepthRecord*, 1> depths{&depth};
  std::vector<MergeRecord> out;
  std::vector<MergeAlphaRecord> alphas;
  stage({&fog, 1}, textures, depths, state, stored, {1}, out, alphas);
  return {out.at(0), alphas.empty() ? -1 : alphas.at(0).a};
}

TEST(Merge, BlendsByHand) {
  const Config config = shipped_config("depth16");
  const int fraction = config.format(FormatId::fog_color).fraction();
  const int a_fraction = config.format(FormatId::texture_alpha).fraction();
  const auto golden = golden::make_merge({}, config);
  const auto check = [&](BlendFactor src, BlendFactor dst, BlendOp op, std::int64_t expected) {
    DrawState state = first_state(config);
    state.blend_src = src;
    state.blend_dst = dst;
    state.blend_op = op;
    state.blend_red = 128;
    const Fragment f{std::int64_t{100} << fraction, (std::int64_t{1} << a_fraction) / 4};
    EXPECT_EQ(by_model(config, state, f, {200, 0, 0, 64}).color.r, expected);
    EXPECT_EQ(by_golden(golden, state, f, {200, 0, 0, 64}).color.r, expected);
  };
  using enum BlendFactor;
  check(one, one, BlendOp::add, 255);  // 300, saturated
  check(one, zero, BlendOp::add, 100);
  check(zero, one, BlendOp::add, 200);
  check(one, one, BlendOp::subtract, 0);
  check(one, one, BlendOp::reverse_subtract, 100);
  check(zero, zero, BlendOp::min, 100);
  check(zero, zero, BlendOp::max, 200);
  check(src_alpha, zero, BlendOp::add, 25);
  check(zero, one_minus_src_alpha, BlendOp::add, 150);
  check(zero, dst_alpha, BlendOp::add, 50);           // c(64) = 1/4
  check(constant_color, zero, BlendOp::add, 50);      // c(128) = 129/256: 50.39
  check(zero, src_color, BlendOp::add, 78);           // 200 * 100/256 = 78.1
  check(src_alpha_saturate, zero, BlendOp::add, 25);  // a < 1 - 1/4
  check(half, half, BlendOp::add, 150);               // with a factor of 127 or 129 of 256: 148.8, 151.2
  check(half, zero, BlendOp::add, 50);
  check(half, half, BlendOp::subtract, 0);
  check(half, half, BlendOp::reverse_subtract, 50);
  check(zero, half, BlendOp::add, 100);
}

// Every pair of factors and every operation on both channels, over a lattice of operands.
TEST(Merge, GoldenEqualsModelInEveryBlend) {
  const Config config = shipped_config("depth16");
  const int a_fraction = config.format(FormatId::texture_alpha).fraction();
  const auto golden = golden::make_merge({}, config);
  Random random(7);
  const auto factors = static_cast<std::int64_t>(enum_names<BlendFactor>.size());
  std::uint64_t compared = 0;
  for (std::int64_t src = 0; src < factors; ++src) {
    for (std::int64_t dst = 0; dst < factors; ++dst) {
      for (int i = 0; i < 120; ++i) {
        DrawState state = first_state(config);
        state.blend_src = static_cast<BlendFactor>(src);
        state.blend_dst = static_cast<BlendFactor>(dst);
        state.blend_op = static_cast<BlendOp>(i % 5);
        state.blend_alpha_src = static_cast<BlendFactor>(dst);
        state.blend_alpha_dst = static_cast<BlendFactor>(src);
        state.blend_alpha_op = static_cast<BlendOp>(i / 5 % 5);
        state.blend_red = static_cast<std::int32_t>(random.integer(0, 255));
        state.blend_alpha = static_cast<std::int32_t>(random.integer(0, 255));
        const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
        const std::array<std::uint8_t, 4> stored{byte(), byte(), byte(), byte()};
        const Fragment f{random.integer(0, (1 << config.format(FormatId::fog_color).word) - 1),
                         random.integer(0, std::int64_t{1} << a_fraction)};
        const Merged a = by_model(config, state, f, stored);
        const Merged b = by_golden(golden, state, f, stored);
        ASSERT_EQ(a.color, b.color) << src << " " << dst << " " << i;
        ASSERT_EQ(a.alpha, b.alpha) << src << " " << dst << " " << i;
        compared += a.color.r != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(compared, 10000U);
}

TEST(Merge, GoldenEqualsModelInEveryLogicOperation) {
  const Config config = shipped_config("depth16");
  const int fraction = config.format(FormatId::fog_color).fraction();
  const auto golden = golden::make_merge({}, config);
  for (std::size_t op = 1; op < enum_names<LogicOp>.size(); ++op) {
    DrawState state = first_state(config);
    state.logic_op = static_cast<LogicOp>(op);
    for (int src = 0; src < 256; src += 3) {
      for (int dst = 0; dst < 256; dst += 5) {
        const auto d = static_cast<std::uint8_t>(dst);
        const Fragment f{std::int64_t{src} << fraction, 1};
        const Merged a = by_model(config, state, f, {d, d, d, d});
        ASSERT_EQ(a.color, by_golden(golden, state, f, {d, d, d, d}).color) << to_string(state.logic_op);
      }
    }
  }
  DrawState state = first_state(config);
  state.logic_op = LogicOp::exclusive_or;
  EXPECT_EQ(by_model(config, state, {std::int64_t{0xf0} << fraction, 0}, {0x3c, 0, 0, 0}).color.r, 0xcc);
  state.logic_op = LogicOp::and_reverse;
  EXPECT_EQ(by_model(config, state, {std::int64_t{0xf0} << fraction, 0}, {0x3c, 0, 0, 0}).color.r, 0xc0);
}

}  // namespace
}  // namespace bitspan
