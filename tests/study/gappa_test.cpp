// SPDX-License-Identifier: Apache-2.0
// Gappa proves the bounds that study/bounds.hpp states, and refuses half of them.
#include "study/bounds/gappa.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "scene/demo.hpp"
#include "study/bounds/bounds.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"
#include "tests/support/tool_error.hpp"

namespace bitspan {
namespace {

// Triangles without slivers: nothing saturates.
InputRange calm_range() {
  InputRange r;
  r.width = 640;
  r.height = 480;
  r.s_min = 1;
  r.s_max = 1000;
  r.s = {1, 1000};
  r.x = {0, 640};
  r.y = {0, 480};
  r.u = r.v = {-128, 128};
  r.shortest_edge = 1;
  r.shortest_row = 1;
  r.longest_row = 640;
  r.inverse_s_gradient = 0.002;
  r.u_gradient = 4;
  r.v_gradient = 2;
  return r;
}

void expect_proved(const Config& config, const InputRange& range, std::string_view place) {
  const double claim = gappa_claim(config, range, place);
  ASSERT_GT(claim, 0) << place;
  const GappaVerdict verdict = prove_with_gappa(config, range, place);
  EXPECT_TRUE(verdict.proved) << config.name << " " << place << "\n"
                              << verdict.output << gappa_scripts(config, range, place).front();
  EXPECT_FALSE(prove_with_gappa(config, range, place, claim / 2).proved)
      << config.name << " " << place << ": half the bound";
}

class ShippedProofs : public testing::TestWithParam<std::tuple<int, std::string_view>> {};

TEST_P(ShippedProofs, OfTheStatedBoundAndNotOfHalf) {
  const Config config = shipped_config(shipped_names[static_cast<std::size_t>(std::get<0>(GetParam()))]);
  expect_proved(config, calm_range(), std::get<1>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Places, ShippedProofs,
                         testing::Combine(testing::Range(0, 3), testing::ValuesIn(gappa_places())),
                         [](const auto& info) {
                           std::string name =
                               shipped_names[static_cast<std::size_t>(std::get<0>(info.param))] + "_" +
                               std::string(std::get<1>(info.param));
                           for (char& c : name) {
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           }
                           return name;
                         });

// The other forms of the same stages: accumulators coarser than their steps, exact quotients, all roundings.
TEST(Gappa, ProvesOtherRoundingsWidthsAndForms) {
  for (int mode = 0; mode < rounding_modes; ++mode) {
    Config config = shipped_config("depth16");
    config.edge_slope = SlopeForm::reciprocal;
    config.row_slope = mode % 2 == 0 ? RowSlope::divide : RowSlope::reciprocal;
    const auto rounding = static_cast<Rounding>(mode);
    for (const FormatId id :
         {FormatId::edge_h_step, FormatId::edge_h_acc, FormatId::edge_h, FormatId::span_h_step,
          FormatId::span_h, FormatId::span_f_step, FormatId::span_f, FormatId::span_uv}) {
      config.format(id).rounding = rounding;
    }
    config.format(FormatId::span_h).word -= 4;  // an addition a pixel rounds
    config.format(FormatId::edge_h_acc).word -= 1;
    config.format(FormatId::edge_h).word -= 3;
    config.pixel_reciprocal.output.rounding = rounding;
    for (const std::string_view place : {"edge.h", "span.h", "span.uv"}) {
      SCOPED_TRACE(std::string(to_string(rounding)));
      expect_proved(config, calm_range(), place);
    }
  }
}

TEST(Gappa, ProvesTheRestoringUnitAParabolaAndMoreNewtonSteps) {
  Config config = shipped_config("depth16");
  Reciprocal& unit = config.pixel_reciprocal;
  unit = config.row_reciprocal;
  unit.pipelined = true;
  expect_proved(config, calm_range(), "reciprocal.pixel");
  EXPECT_EQ(gappa_scripts(config, calm_range(), "reciprocal.pixel").size(), 1U);
  unit.kind = ReciprocalKind::lut_newton;
  unit.operand_bits = 30;
  unit.index_bits = 3;
  unit.table_bits = 8;
  unit.internal_bits = 34;
  for (unit.steps = 0; unit.steps <= 3; ++unit.steps) {
    SCOPED_TRACE(unit.steps);
    expect_proved(config, calm_range(), "reciprocal.pixel");
  }
  unit.kind = ReciprocalKind::lut_quadratic;
  unit.steps = 0;
  unit.index_bits = 4;
  unit.table_bits = 17;
  expect_proved(config, calm_range(), "reciprocal.pixel");
}

// A triangle as a scene has it, by its own ranges.
TEST(Gappa, ProvesTheBoundOfATriangleOfTheDemo) {
  const Config config = shipped_config("depth20");
  int proved = 0;
  for (const InputRange& range : triangle_ranges(config, demo_scene(320, 240))) {
    if (!range.covers || range.longest_row < 40 || range.inverse_s_gradient < 1e-4) continue;
    if (!bound_hypotheses(config, range).span.adds_up) continue;
    expect_proved(config, range, "span.h");
    expect_proved(config, range, "span.uv");
    if (++proved == 2) return;
  }
  FAIL() << "the demo has no such triangle any more: " << proved;
}

// Narrower arithmetic than what the bound is of: the script is of the configuration, not of the bound alone.
TEST(Gappa, RefusesTheBoundOfAWiderConfiguration) {
  const Config wide = shipped_config("depth16");
  struct Cut {
    FormatId id;
    std::string_view place;
  };
  for (const Cut& cut : {Cut{FormatId::span_h_step, "span.h"}, Cut{FormatId::span_f_step, "span.f"},
                         Cut{FormatId::span_uv, "span.uv"}, Cut{FormatId::edge_uv, "edge.uv"}}) {
    Config narrow = wide;
    narrow.format(cut.id).word -= 2;
    EXPECT_FALSE(
        prove_with_gappa(narrow, calm_range(), cut.place, gappa_claim(wide, calm_range(), cut.place)).proved)
        << cut.place;
  }
  Config narrow = wide;
  narrow.pixel_reciprocal.output.word -= 1;
  EXPECT_FALSE(prove_with_gappa(narrow, calm_range(), "reciprocal.pixel",
                                gappa_claim(wide, calm_range(), "reciprocal.pixel"))
                   .proved);
}

TEST(Gappa, SaysWhatItHasNoScriptFor) {
  const Config config = shipped_config("depth16");
  expect_refusal([&] { gappa_scripts(config, calm_range(), "span.shade"); },
                 "no script for span.shade; legal: reciprocal.pixel, edge.h_acc,");
  const InputRange any;  // slivers: slopes saturate
  expect_refusal([&] { gappa_scripts(config, any, "span.h"); },
                 "span.h: in this range a register may saturate");
  Config other = config;
  other.perspective = Perspective::hyperbolic;
  expect_refusal([&] { gappa_scripts(other, calm_range(), "span.h"); }, "perspective.mode");
  other = config;
  other.pixel_reciprocal.normalize = false;
  other.pixel_reciprocal.output = {24, 1, false, Rounding::rnd, Overflow::sat, false};
  expect_refusal([&] { gappa_scripts(other, calm_range(), "reciprocal.pixel"); }, "normalize is false");
}

TEST(Gappa, WhatGappaDoesNotAcceptOrCannotBeRunIsAnError) {
  EXPECT_NE(
      tool_error([] { check_with_gappa("this is no script"); }).find("gappa: does not accept the script"),
      std::string::npos);
  EXPECT_TRUE(check_with_gappa("{ x in [0,1] -> x + 1 in [1,2] }").proved);
  const GappaVerdict wrong = check_with_gappa("{ x in [0,1] -> x + 1 in [1,1.5] }");
  EXPECT_FALSE(wrong.proved);
  EXPECT_NE(wrong.output.find("not satisfied"), std::string::npos);
  const Environment path("PATH", "/nonexistent");
  EXPECT_NE(
      tool_error([] { check_with_gappa("{ x in [0,1] -> x in [0,1] }"); }).find("gappa: is not installed"),
      std::string::npos);
}

}  // namespace
}  // namespace bitspan
