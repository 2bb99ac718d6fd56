// model_paths: what `bitspan config check` says of a configuration.
#include "model/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/simd/engine_vector.hpp"
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

TEST(Paths, WhatLanesCannotHoldIsScalar) {
  Config c = shipped_config("narrow");
  c.format(FormatId::span_h) = {63, 32, true, Rounding::trn, Overflow::sat, false};
  c.format(FormatId::setup_b) = {63, 34, false, Rounding::rnd, Overflow::sat, false};
  ASSERT_NE(model::vector_refusal(c), nullptr);
  for (const StagePath& stage : model::model_paths(c)) EXPECT_EQ(stage.path, "scalar") << stage.stage;
  EXPECT_EQ(model::chosen_form(c, ModelForm::automatic), ModelForm::scalar);
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
