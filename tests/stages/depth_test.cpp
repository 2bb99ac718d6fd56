#include "model/stages/depth.hpp"

#include <gtest/gtest.h>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Depth {
  explicit Depth(DepthCode code, Rounding rounding = Rounding::trn) : config(plain_config()) {
    config.depth_code = code;
    config.depth_rounding = rounding;
    stage = model::prepare_depth(config, model::make_constants(config, worked_scene()));
  }
  DepthRecord operator()(double h, std::int64_t stored) const {
    FragmentRecord f;
    f.triangle = 2;
    f.x = 3;
    f.y = 4;
    f.h = encoded(h, config.format(FormatId::span_h));
    DepthRecord out;
    const bool pass = model::depth(stage, f, stored, out);
    EXPECT_EQ(out.pass, pass ? 1 : 0);
    EXPECT_EQ(out.stored, stored);
    EXPECT_EQ(out.triangle, 2);
    EXPECT_EQ(out.x, 3);
    EXPECT_EQ(out.y, 4);
    return out;
  }
  Config config;
  model::DepthStage stage;
};

TEST(Depth, InverseLargerIsNearer) {
  const Depth depth(DepthCode::inverse);
  EXPECT_EQ(depth.stage.clear, 0);
  EXPECT_EQ(depth(100.75, 0).z, 100);
  EXPECT_EQ(depth(100.75, 99).pass, 1);
  EXPECT_EQ(depth(100.75, 100).pass, 0);  // equal does not pass
  EXPECT_EQ(depth(100.75, 101).pass, 0);
  EXPECT_EQ(depth(-5, 0).z, 0);
  EXPECT_EQ(depth(70000, 0).z, 65535);
  EXPECT_EQ(Depth(DepthCode::inverse, Rounding::rnd)(100.75, 0).z, 101);
}

TEST(Depth, OpenGlSmallerIsNearer) {
  const Depth depth(DepthCode::opengl);
  EXPECT_EQ(depth.stage.clear, 65535);
  EXPECT_EQ(depth(100.75, 65535).z, 65535 - 101);  // floor of 65434.25
  EXPECT_EQ(depth(100.75, 65435).pass, 1);
  EXPECT_EQ(depth(100.75, 65434).pass, 0);
  EXPECT_EQ(depth(0, 65535).pass, 0);
}

// Linear in s: h(2) = 0 gives zmax, h(1.5) = 21845 its half, h(1) = 65535 zero.
TEST(Depth, LinearInDistance) {
  const Depth depth(DepthCode::linear, Rounding::rnd);
  EXPECT_EQ(depth.stage.clear, 65535);
  EXPECT_EQ(depth(0, 65535).z, 65535);
  EXPECT_EQ(depth(65535, 65535).z, 0);
  EXPECT_NEAR(static_cast<double>(depth(21845, 65535).z), 32767.5, 1);
  EXPECT_NE(depth(0, 65535).recip_m, 0);
  EXPECT_EQ(Depth(DepthCode::inverse)(0, 0).recip_m, 0);
  std::int64_t last = 65536;
  for (int h = 0; h <= 65535; h += 257) {
    const std::int64_t z = depth(h, 65535).z;
    const double s = 2 * 65535.0 / (h + 65535.0);
    EXPECT_NEAR(static_cast<double>(z), 65535 * (s - 1), 1);
    EXPECT_LT(z, last);
    last = z;
  }
}

}  // namespace
}  // namespace bitspan
