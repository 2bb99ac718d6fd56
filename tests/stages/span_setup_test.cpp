// SPDX-License-Identifier: Apache-2.0
#include "model/stages/span_setup.hpp"

#include <gtest/gtest.h>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct SpanSetup {
  explicit SpanSetup(const Config& c = plain_config())
      : config(c), stage(model::prepare_span_setup(c, model::make_constants(c, worked_scene()))) {}
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  std::int64_t raw(double v, FormatId id) const { return encoded(v, config.format(id)); }

  // From x = 1.25 to 9.25, first centre 1.5; h 0 to 800; u 2 to 18; red 0 to 1.
  RowRecord row() const {
    RowRecord r;
    r.triangle = 5;
    r.y = 11;
    r.x_first = 1;
    r.x_last = 8;
    r.l_x = raw(1.25, FormatId::edge_x);
    r.r_x = raw(9.25, FormatId::edge_x);
    r.r_h = raw(800, FormatId::edge_h);
    r.l_u = raw(2, FormatId::edge_uv);
    r.r_u = raw(18, FormatId::edge_uv);
    r.r_r = raw(1, FormatId::edge_shade);
    return r;
  }
  Config config;
  model::SpanSetupStage stage;
};

TEST(SpanSetup, DeltaF) {
  const SpanSetup setup;
  SpanRecord s;
  EXPECT_EQ(model::span_setup(setup.stage, setup.row(), s), 7);
  EXPECT_EQ(s.triangle, 5);
  EXPECT_EQ(s.x, 1);
  EXPECT_EQ(s.y, 11);
  EXPECT_EQ(s.count, 8);
  EXPECT_EQ(s.recip_m, 0);
  EXPECT_EQ(s.recip_e, 0);
  EXPECT_EQ(setup.value(s.h_step, FormatId::span_h_step), 100);
  EXPECT_EQ(setup.value(s.h, FormatId::span_h), 25);  // a quarter of a pixel in
  const double diff = 16.0 * (800 + 65535);
  EXPECT_EQ(setup.value(s.fu_diff, FormatId::span_f_diff), diff);
  EXPECT_EQ(setup.value(s.fu_step0, FormatId::span_f_step), diff / 8);
  EXPECT_EQ(s.fu_step1, s.fu_step0);
  EXPECT_EQ(setup.value(s.fu, FormatId::span_f), diff / 32);
  EXPECT_EQ(setup.value(s.u1, FormatId::edge_uv), 2);
  EXPECT_EQ(s.fv_diff, 0);
  EXPECT_EQ(setup.value(s.r_step0, FormatId::span_shade_step), 1.0 / 8);
  EXPECT_EQ(s.r_step1, s.r_step0);
  EXPECT_EQ(setup.value(s.r, FormatId::span_shade_acc), 1.0 / 32);
  EXPECT_EQ(s.phase, 0);
}

TEST(SpanSetup, StartOffsetsAreAdded) {
  Config c = plain_config();
  c.start_offset.span_h = {true, 0};  // half a code
  c.start_offset.span_f = {false, 0.25};
  c.start_offset.span_shade = {true, 0};  // half an ulp of span.shade
  const SpanSetup setup(c);
  SpanRecord s;
  model::span_setup(setup.stage, setup.row(), s);
  EXPECT_EQ(setup.value(s.h, FormatId::span_h), 25.5);
  EXPECT_EQ(setup.value(s.fu, FormatId::span_f), 16.0 * 66335 / 32 + 0.25);
  // 1/32 + 2^-21, to 2^-20: up.
  EXPECT_EQ(s.r, setup.raw(1.0 / 32, FormatId::span_shade_acc) + 1);
}

TEST(SpanSetup, Hyperbolic) {
  Config c = plain_config();
  c.perspective = Perspective::hyperbolic;
  const SpanSetup setup(c);
  SpanRecord s;
  model::span_setup(setup.stage, setup.row(), s);
  const double gl = 2.0 * 65535;
  const double gr = 18.0 * 66335;
  EXPECT_EQ(setup.value(s.fu_diff, FormatId::span_f_diff), gr);
  EXPECT_EQ(s.u1, 0);
  EXPECT_EQ(setup.value(s.fu_step0, FormatId::span_f_step), (gr - gl) / 8);
  EXPECT_EQ(setup.value(s.fu, FormatId::span_f), gl + (gr - gl) / 32);
}

TEST(SpanSetup, Affine) {
  Config c = plain_config();
  c.perspective = Perspective::affine;
  const SpanSetup setup(c);
  SpanRecord s;
  EXPECT_EQ(model::span_setup(setup.stage, setup.row(), s), 7);
  EXPECT_EQ(s.fu_diff, 0);
  EXPECT_EQ(s.u1, 0);
  EXPECT_EQ(setup.value(s.fu_step0, FormatId::span_uv_step), 2);
  EXPECT_EQ(setup.value(s.fu, FormatId::span_uv_acc), 2.5);
}

// L = 8 has an exact reciprocal: one divide, the same values. L = 12 has not.
TEST(SpanSetup, OneReciprocalServesAllSlopes) {
  Config c = plain_config();
  c.row_slope = RowSlope::reciprocal;
  c.row_reciprocal.output = {5, 1, false, Rounding::trn, Overflow::sat, false};
  const SpanSetup setup(c);
  RowRecord row = setup.row();
  SpanRecord s;
  EXPECT_EQ(model::span_setup(setup.stage, row, s), 1);
  EXPECT_EQ(s.recip_m, 16);
  EXPECT_EQ(s.recip_e, 3);
  EXPECT_EQ(setup.value(s.h_step, FormatId::span_h_step), 100);
  row.r_x = setup.raw(13.25, FormatId::edge_x);
  model::span_setup(setup.stage, row, s);
  EXPECT_EQ(s.recip_m, 10);  // 2/3 in sixteenths, down
  EXPECT_EQ(setup.value(s.h_step, FormatId::span_h_step), 800 * 10.0 / 16 / 8);
  EXPECT_EQ(setup.value(s.r_step0, FormatId::span_shade_step), 10.0 / 128);
}

TEST(SpanSetup, NoLengthNoStepsNoDivide) {
  for (const RowSlope form : {RowSlope::divide, RowSlope::reciprocal}) {
    Config c = plain_config();
    c.row_slope = form;
    const SpanSetup setup(c);
    for (const double end : {1.25, 1.0}) {
      RowRecord row = setup.row();
      row.r_x = setup.raw(end, FormatId::edge_x);
      row.l_h = setup.raw(300, FormatId::edge_h);
      SpanRecord s;
      EXPECT_EQ(model::span_setup(setup.stage, row, s), 0);
      EXPECT_EQ(s.recip_m, 0);
      EXPECT_EQ(s.recip_e, 0);
      EXPECT_EQ(s.h_step, 0);
      EXPECT_EQ(s.fu_step0, 0);
      EXPECT_EQ(s.r_step0, 0);
      EXPECT_EQ(setup.value(s.h, FormatId::span_h), 300);
      EXPECT_EQ(setup.value(s.fu_diff, FormatId::span_f_diff), 16.0 * 66335);  // formed all the same
    }
  }
}

// Clipped on the left: the pre-step is long, the values are those of the same line.
TEST(SpanSetup, ClippedRowsStartInTheMiddle) {
  const SpanSetup setup;
  RowRecord row = setup.row();
  row.l_x = setup.raw(-100, FormatId::edge_x);
  row.r_x = setup.raw(28, FormatId::edge_x);
  row.x_first = 0;
  SpanRecord s;
  model::span_setup(setup.stage, row, s);
  EXPECT_EQ(setup.value(s.h, FormatId::span_h), 800.0 / 128 * 100.5);
}

// q = h + B = 131070 = 2^17 (1 - 2^-16 - 2^-17): the whole row by one reciprocal.
TEST(SpanSetup, ConstantDepthRows) {
  Config c = plain_config();
  c.perspective = Perspective::const_depth_rows;
  const SpanSetup setup(c);
  PlaneRowRecord row;
  row.triangle = 5;
  row.major_first = 7;
  row.minor_first = 3;
  row.count = 4;
  row.phase = 77;
  row.h = setup.raw(65535, FormatId::span_h);
  row.gu = setup.raw(131070.0 * 12, FormatId::span_f);
  row.gu_step0 = setup.raw(131070.0, FormatId::span_f_step);
  row.gu_step1 = setup.raw(-131070.0 * 2, FormatId::span_f_step);
  row.g = 1;
  row.g_step0 = 2;
  row.g_step1 = 3;
  model::PlaneGeometry geometry;
  SpanRecord s;
  EXPECT_EQ(model::span_setup(setup.stage, row, geometry, s), 1);
  EXPECT_EQ(s.x, 7);
  EXPECT_EQ(s.y, 3);
  EXPECT_EQ(s.count, 4);
  EXPECT_EQ(s.phase, 77);
  EXPECT_EQ(s.recip_e, 16);
  EXPECT_EQ(s.h, row.h);
  EXPECT_EQ(s.h_step, 0);
  EXPECT_NEAR(setup.value(s.fu, FormatId::span_uv_acc), 12, 1e-6);
  EXPECT_NEAR(setup.value(s.fu_step0, FormatId::span_uv_step), 1, 1e-6);
  EXPECT_NEAR(setup.value(s.fu_step1, FormatId::span_uv_step), -2, 1e-6);
  EXPECT_EQ(s.g, 1);
  EXPECT_EQ(s.g_step0, 2);
  EXPECT_EQ(s.g_step1, 3);
  geometry.along_y = true;
  model::span_setup(setup.stage, row, geometry, s);
  EXPECT_EQ(s.x, 3);
  EXPECT_EQ(s.y, 7);
}

}  // namespace
}  // namespace bitspan
