// SPDX-License-Identifier: Apache-2.0
// model_paths: what `bitspan config check` says of a configuration.
#include "model/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/simd/engine_vector.hpp"
#include "model/simd/shipped.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using model::StagePath;

StagePath path(const Config& config, const std::string& stage) {
  const auto all = model::model_paths(config);
  const auto at = std::ranges::find(all, stage, &StagePath::stage);
  EXPECT_NE(at, all.end()) << stage;
  return at == all.end() ? StagePath{} : *at;
}

TEST(Paths, NarrowFormatsTakeNarrowLanes) {
  const Config narrow = shipped_config("narrow");
  EXPECT_EQ(path(narrow, "span").path, "64-bit lanes");
  EXPECT_EQ(path(narrow, "span").widest, "u = u1 + fu m 2^-e");
  EXPECT_EQ(path(narrow, "texture").path, "32-bit lanes");
  EXPECT_EQ(model::chosen_form(narrow, ModelForm::automatic), ModelForm::specialised);
  EXPECT_EQ(model::chosen_form(narrow, ModelForm::scalar), ModelForm::scalar);
}

TEST(Paths, WiderFormatsTakeWiderLanes) {
  Config c = shipped_config("narrow");
  c.format(FormatId::texture_mix).word += 14;  // V_r r beyond 31 bits
  EXPECT_EQ(path(c, "texture").path, "64-bit lanes");
  EXPECT_GT(path(c, "texture").bits, 31);
  c.format(FormatId::span_f).word += 20;  // fu m 2^-e beyond 63 bits, whatever B is
  EXPECT_TRUE(path(c, "span").path.starts_with("64-bit lanes, 128-bit where values are large"));
  EXPECT_EQ(model::chosen_form(c, ModelForm::automatic), ModelForm::vector);
  EXPECT_THROW(model::chosen_form(c, ModelForm::specialised), InputError);
}

// A kernel stays compiled in where only keys change that it does not read.
TEST(Paths, KernelsCompareWhatTheyRead) {
  const Config depth16 = shipped_config("depth16");
  const model::ShippedIndex both = model::shipped_index(depth16);
  ASSERT_TRUE(both.spans >= 0 && both.shades >= 0);
  const auto index = [&](void (*change)(Config&)) {
    Config c = depth16;
    change(c);
    const model::ShippedIndex found = model::shipped_index(c);
    return std::pair(found.spans == both.spans, found.shades == both.shades);
  };
  using Kept = std::pair<bool, bool>;
  EXPECT_EQ(index([](Config& c) { c.timing[0].fifo += 1; }), Kept(true, true));
  EXPECT_EQ(index([](Config& c) { c.memory.latency += 1; }), Kept(true, true));
  EXPECT_EQ(index([](Config& c) { c.subpixel_bits -= 1; }), Kept(true, true));
  EXPECT_EQ(index([](Config& c) { c.fog_depth_bits -= 1; }), Kept(true, true));
  EXPECT_EQ(index([](Config& c) { c.pixel_reciprocal.bits_per_cycle += 1; }), Kept(true, true));
  EXPECT_EQ(index([](Config& c) { c.filter = TextureFilter::bilinear; }), Kept(true, false));
  EXPECT_EQ(index([](Config& c) { c.format(FormatId::span_f).word += 1; }), Kept(false, true));
  EXPECT_EQ(index([](Config& c) { c.depth_code = DepthCode::linear; }), Kept(false, true));
  EXPECT_EQ(index([](Config& c) { c.format(FormatId::span_uv).word -= 1; }), Kept(false, false));
}

TEST(Paths, WhatLanesCannotHoldIsScalar) {
  Config c = shipped_config("narrow");
  c.format(FormatId::span_h) = {63, 32, true, Rounding::trn, Overflow::sat, false};
  c.format(FormatId::setup_b) = {63, 34, false, Rounding::rnd, Overflow::sat, false};
  ASSERT_NE(model::vector_refusal(c), nullptr);
  for (const StagePath& stage : model::model_paths(c)) EXPECT_EQ(stage.path, "scalar") << stage.stage;
  EXPECT_EQ(model::chosen_form(c, ModelForm::automatic), ModelForm::scalar);
}

TEST(Paths, LevelsByGradientsAreInLanes) {
  Config c = shipped_config("narrow");
  c.mip = MipMode::linear;
  c.lod = LodMode::gradient;
  EXPECT_EQ(path(c, "lod").path, "64-bit lanes, 128-bit where values are large");
  EXPECT_EQ(path(c, "setup.gradient").path, "scalar");
  EXPECT_EQ(path(c, "texture").path, "32-bit lanes");
  c.lod = LodMode::zone_s;
  EXPECT_EQ(path(c, "lod").path, "scalar");
  EXPECT_EQ(path(c, "texture").path, "32-bit lanes");
  c.perspective = Perspective::const_depth_rows;
  EXPECT_EQ(path(c, "texture").path, "scalar");
}

TEST(Paths, RowsOfConstantDepthAreScalarUpToTheDepthTest) {
  Config c = shipped_config("narrow");
  c.perspective = Perspective::const_depth_rows;
  EXPECT_EQ(path(c, "plane_walk").path, "scalar");
  EXPECT_EQ(path(c, "depth").path, "scalar");
  EXPECT_EQ(path(c, "merge").path, "32-bit lanes");
}

}  // namespace
}  // namespace bitspan
