// SPDX-License-Identifier: Apache-2.0
#include "model/stages/candidate.hpp"

#include <gtest/gtest.h>

#include <array>

#include "golden/candidate.hpp"
#include "golden/compare.hpp"
#include "model/stages/texture.hpp"
#include "tests/stages/worked.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// A fragment at a code, by the model; golden says the same.
CandidateRecord comes(const Config& config, std::int64_t triangle, std::int64_t z, Candidate& held) {
  const FragmentRecord fragment{.triangle = triangle, .x = 5, .y = 6, .u = 10 * triangle, .v = -triangle};
  const DepthRecord depth{.triangle = triangle, .x = 5, .y = 6, .z = z};
  const TextureRecord texture{.triangle = triangle, .a = 7};
  const FogRecord fog{.triangle = triangle, .r = triangle + 1, .g = triangle + 2, .b = triangle + 3};
  Candidate of_golden = held;
  CandidateRecord out;
  model::candidate(model::depth_formats(config), fragment, depth, texture, fog, held, out);
  EXPECT_EQ(out, golden::candidate(config, fragment, depth, texture, fog, of_golden));
  EXPECT_EQ(held, of_golden);
  return out;
}

TEST(Candidate, IsTheFarthestThatCame) {
  const Config config = shipped_config("depth16");
  ASSERT_EQ(config.depth_code, DepthCode::inverse);
  Candidate held;
  EXPECT_EQ(comes(config, 1, 500, held), (CandidateRecord{1, 5, 6, 500, 0, 1}));
  EXPECT_EQ(held, (Candidate{1, 500, 10, -1, 2, 3, 4, 7}));
  // Nearer, and as far: the first one stays.
  EXPECT_EQ(comes(config, 2, 501, held), (CandidateRecord{2, 5, 6, 501, 500, 0}));
  EXPECT_EQ(comes(config, 3, 500, held), (CandidateRecord{3, 5, 6, 500, 500, 0}));
  EXPECT_EQ(held.triangle, 1);
  EXPECT_EQ(comes(config, 4, 499, held), (CandidateRecord{4, 5, 6, 499, 500, 1}));
  EXPECT_EQ(held, (Candidate{4, 499, 40, -4, 5, 6, 7, 7}));
  // A code of 0 is held as any other: alpha tells whether a pixel holds one.
  EXPECT_EQ(comes(config, 5, 0, held).taken, 1);
  EXPECT_EQ(comes(config, 6, 1, held), (CandidateRecord{6, 5, 6, 1, 0, 0}));
}

TEST(Candidate, IsFartherByEveryCode) {
  for (const DepthCode code :
       {DepthCode::inverse, DepthCode::opengl, DepthCode::linear, DepthCode::w_float, DepthCode::float_dz}) {
    Config config = shipped_config("depth16");
    config.depth_code = code;
    const bool small_is_far = code == DepthCode::inverse;
    Candidate held;
    comes(config, 1, 1600, held);
    EXPECT_EQ(comes(config, 2, 1700, held).taken, small_is_far ? 0 : 1) << to_string(code);
    EXPECT_EQ(comes(config, 3, 1500, held).taken, small_is_far ? 1 : 0) << to_string(code);
  }
}

// The low four bits of a word say how z changes, and have no part in how far it is.
TEST(Candidate, OfFloatDzIsFartherByZAlone) {
  Config config = shipped_config("depth16");
  config.depth_code = DepthCode::float_dz;
  Candidate held;
  comes(config, 1, 1600, held);
  EXPECT_EQ(comes(config, 2, 1615, held).taken, 0);
  EXPECT_EQ(comes(config, 3, 1616, held).taken, 1);
}

// What merge takes of a candidate is what came.
TEST(Candidate, KeepsWhatMergeTakes) {
  const model::HeldFragment out = model::held_fragment({9, 77, 1, 2, 3, 4, 5, 6}, 11, 12);
  EXPECT_EQ(out.fragment, (FragmentRecord{.triangle = 9, .x = 11, .y = 12, .u = 1, .v = 2}));
  EXPECT_EQ(out.depth, (DepthRecord{.triangle = 9, .x = 11, .y = 12, .z = 77}));
  EXPECT_EQ(out.texture, (TextureRecord{.triangle = 9, .x = 11, .y = 12, .a = 6}));
  EXPECT_EQ(out.fog, (FogRecord{.triangle = 9, .x = 11, .y = 12, .r = 3, .g = 4, .b = 5}));
}

// Which alphas a pass takes: opaque from 1 on, the others between 0 and 1.
TEST(Candidate, APassTakesAlphas) {
  const Config config = shipped_config("depth16");
  model::TextureStage stage = model::prepare_texture(config);
  const std::int64_t one = std::int64_t{1} << stage.alpha.fraction;
  struct Case {
    std::int64_t a;
    bool opaque, candidate;
  };
  for (const auto& [a, opaque, candidate] : {Case{0, false, false},
                                             {1, false, true},
                                             {one - 1, false, true},
                                             {one, true, false},
                                             {one + 1, true, false}}) {
    const double value = static_cast<double>(a) / static_cast<double>(one);
    for (const auto& [pass, takes] : {std::pair{TranslucencyPass::all, true},
                                      {TranslucencyPass::opaque, opaque},
                                      {TranslucencyPass::candidate, candidate}}) {
      stage.pass = pass;
      EXPECT_EQ(model::passes_alpha_test(stage, a), takes) << a;
      EXPECT_EQ(golden::takes_alpha(pass, value), takes) << a;
    }
  }
}

}  // namespace
}  // namespace bitspan
