// SPDX-License-Identifier: Apache-2.0
// project and the projected texture: values worked by hand. docs/numeric-spec.md, "project".
#include "model/stages/project.hpp"

#include <gtest/gtest.h>

#include <array>

#include "model/stages/texture_second.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

// Distances 1 to 16 from the eye and from the projector: s_min' = 1/16, s_max' = 1, B = B_p = 65535 / 15 =
// 4369 = A_p.
Config config_of(DepthCode code = DepthCode::inverse) {
  Config c = shipped_config("depth16");
  c.project = ProjectUnit::reciprocal;
  c.depth_code = code;
  return c;
}
Scene scene_of() {
  Scene scene;
  scene.s_min = 1;
  scene.s_max = 16;
  scene.projector = Projector{1, 16};
  scene.textures.push_back({"map.raw", 8, 4, {}, TexelFormat::depth, std::vector<std::uint8_t>(4 * 8 * 4)});
  return scene;
}

class Projected {
 public:
  explicit Projected(const Config& config, const Scene& scene = scene_of()) : config_(config), scene_(scene) {
    const model::Constants constants = model::make_constants(config, scene);
    stage_ = model::prepare_project(config, constants, scene_);
    DrawState state = first_state(config);
    state.texture1 = 0;
    state.texture1_coordinates = TextureCoordinates::project;
    model::set_project(stage_, state, scene_.textures.data());
  }
  // h of the fragment; X, Y and W times h + B.
  ProjectRecord at(double h, double x, double y, double w) const {
    const auto raw = [&](FormatId id, double v) {
      return static_cast<std::int64_t>(std::ldexp(v, config_.format(id).fraction()));
    };
    FragmentRecord fragment{.triangle = 3, .x = 5, .y = 6, .h = raw(FormatId::span_h, h)};
    model::FragmentChannels channels{};
    const std::array values{x, y, w};
    for (std::size_t i = 0; i < 3; ++i) {
      channels[i].channel =
          static_cast<std::int64_t>(LineId::project_x) + static_cast<std::int64_t>(i) - fixed_lines;
      channels[i].w = raw(FormatId::project_value, values[i]);
    }
    ProjectRecord out;
    model::project(stage_, fragment, &channels, out);
    return out;
  }
  double value(std::int64_t raw, FormatId id) const {
    return std::ldexp(static_cast<double>(raw), -config_.format(id).fraction());
  }

 private:
  Config config_;
  Scene scene_;
  model::ProjectStage stage_;
};

// h + B = 17476, and W = 2^13: m = 1, e = 13.
TEST(Project, OneReciprocalGivesColumnRowAndCode) {
  const Projected p(config_of());
  const ProjectRecord r = p.at(17476 - 4369, 5.25 * 8192, 3.5 * 8192, 8192);
  EXPECT_EQ(r.triangle, 3);
  EXPECT_EQ(r.x, 5);
  EXPECT_EQ(r.y, 6);
  EXPECT_EQ(r.recip_e, 13);
  EXPECT_EQ(p.value(r.s, FormatId::span_uv), 5.25);
  EXPECT_EQ(p.value(r.t, FormatId::span_uv), 3.5);
  EXPECT_EQ(p.value(r.ratio, FormatId::project_ratio), 17476.0 / 8192);
  EXPECT_EQ(p.value(r.h, FormatId::project_h), 4369 * (17476.0 / 8192) - 4369);  // 4951.39
  EXPECT_EQ(r.z, 4951);
  EXPECT_EQ(r.inside, 1);
}

TEST(Project, TheOpenGlCodeIsTheRestOfH) {
  const ProjectRecord r = Projected(config_of(DepthCode::opengl)).at(17476 - 4369, 0, 0, 8192);
  EXPECT_EQ(r.z, 60584);  // of 60583.6
}

TEST(Project, IsNothingBehindTheProjector) {
  const Projected p(config_of());
  const ProjectRecord nothing{.triangle = 3, .x = 5, .y = 6};
  EXPECT_EQ(p.at(1000, 8, 8, 0), nothing);
  EXPECT_EQ(p.at(1000, 8, 8, -0x1p-14), nothing);
  EXPECT_NE(p.at(1000, 8, 8, 0x1p-14), nothing);
  Scene without = scene_of();
  without.projector.reset();
  EXPECT_EQ(Projected(config_of(), without).at(1000, 8, 8, 8), nothing);
}

// The texture has 8 columns and 4 rows; span.uv has steps of 1/256.
TEST(Project, InsideIsTheTexturesRectangle) {
  const Projected p(config_of());
  const auto inside = [&](double s, double t) { return p.at(0, s * 4096, t * 4096, 4096).inside; };
  EXPECT_EQ(inside(0, 0), 1);
  EXPECT_EQ(inside(8 - 1.0 / 256, 4 - 1.0 / 256), 1);
  EXPECT_EQ(inside(-1.0 / 256, 1), 0);
  EXPECT_EQ(inside(8, 1), 0);
  EXPECT_EQ(inside(1, -1.0 / 256), 0);
  EXPECT_EQ(inside(1, 4), 0);
}

TEST(Project, TheProjectorsRangeMustFit) {
  Scene scene = scene_of();
  scene.projector = Projector{1, 1e-300};
  EXPECT_THROW(Projected(config_of(), scene), InputError);
  // Without the unit nothing looks at it.
  Config without = config_of();
  without.project = ProjectUnit::none;
  EXPECT_EQ(Projected(without, scene).at(1000, 8, 8, 8), (ProjectRecord{.triangle = 3, .x = 5, .y = 6}));
}

// A register that holds no A makes each code -B, which saturates; the place is as ever.
TEST(Project, AnAOfZeroIsAValue) {
  Config c = config_of();
  c.format(FormatId::distance_a) = {1, -20, false, Rounding::trn, Overflow::wrap, true};
  const ProjectRecord r = Projected(c).at(17476 - 4369, 5.25 * 8192, 3.5 * 8192, 8192);
  EXPECT_EQ(r.recip_e, 13);
  EXPECT_EQ(r.inside, 1);
  EXPECT_EQ(r.h, 0);
}

// ---- What the second unit makes of it

// The map's texel (1, 0) holds the code 4951, all others 0; K is 90, 60, 30.
class Shadow {
 public:
  explicit Shadow(const std::function<void(DrawState&)>& change = {}) : config_(config_of()) {
    image_ = scene_of().textures[0];
    const std::uint32_t word = 4951U << 16;
    for (std::size_t i = 0; i < 4; ++i) image_.raw[4 + i] = static_cast<std::uint8_t>(word >> (8 * i));
    DrawState state = first_state(config_);
    state.texture1 = 0;
    state.texture1_coordinates = TextureCoordinates::project;
    state.texture1_compare = true;
    state.texture1_op = TextureOp::replace;
    state.texture1_red = 90;
    state.texture1_green = 60;
    state.texture1_blue = 30;
    if (change) change(state);
    stage_ = model::prepare_texture_second(config_);
    model::set_texture_second(stage_, state, &image_);
  }
  // Red, green, blue of a fragment at (s, t) with the code z.
  std::array<double, 3> at(double s, double t, std::int64_t z, bool inside = true) const {
    const double one = std::ldexp(1.0, config_.format(FormatId::span_uv).fraction());
    const ProjectRecord projected{.s = static_cast<std::int64_t>(s * one),
                                  .t = static_cast<std::int64_t>(t * one),
                                  .z = z,
                                  .inside = inside ? 1 : 0};
    TextureSecondRecord out;
    const TextureRecord first{.a = std::int64_t{1} << config_.format(FormatId::texture_alpha).fraction()};
    EXPECT_TRUE(model::texture_second(stage_, nullptr, {}, {}, first, &projected, out));
    std::array<double, 3> color{};
    for (std::size_t i = 0; i < 3; ++i) {
      color[i] = std::ldexp(static_cast<double>(std::array{out.r, out.g, out.b}[i]),
                            -config_.format(FormatId::texture_color).fraction());
    }
    return color;
  }

 private:
  Config config_;
  Texture image_;
  model::TextureSecondStage stage_;
};
constexpr std::array<double, 3> white{255, 255, 255}, dark{90, 60, 30};

TEST(ProjectedTexture, IsWhiteWhereNothingIsNearerToTheLight) {
  const Shadow s;
  EXPECT_EQ(s.at(1.5, 0.5, 4951), white);
  EXPECT_EQ(s.at(1.5, 0.5, 4952), white);  // nearer
  EXPECT_EQ(s.at(1.5, 0.5, 4950), dark);
  EXPECT_EQ(s.at(2.5, 0.5, 0), white);  // nothing casts there
}

TEST(ProjectedTexture, TheBiasSaturates) {
  EXPECT_EQ(Shadow([](DrawState& d) { d.texture1_bias = 1; }).at(1.5, 0.5, 4950), white);
  EXPECT_EQ(Shadow([](DrawState& d) { d.texture1_bias = -1; }).at(1.5, 0.5, 4951), dark);
  EXPECT_EQ(Shadow([](DrawState& d) { d.texture1_bias = -5000; }).at(2.5, 0.5, 4950), white);  // 0 is 0
  EXPECT_EQ(Shadow([](DrawState& d) { d.texture1_bias = 1 << 30; }).at(1.5, 0.5, 0), white);
}

TEST(ProjectedTexture, TheFilterWeighsFourComparisons) {
  const Shadow s([](DrawState& d) { d.texture1_filter = TextureFilter::bilinear; });
  // Half a texel off, in one axis and in both.
  EXPECT_EQ(s.at(1.5, 0.5, 4950), dark);
  EXPECT_EQ(s.at(2, 0.5, 4950), (std::array<double, 3>{172.5, 157.5, 142.5}));
  EXPECT_EQ(s.at(2, 1, 4950), (std::array<double, 3>{213.75, 206.25, 198.75}));
}

TEST(ProjectedTexture, OutsideItIsLitOrDark) {
  EXPECT_EQ(Shadow().at(1.5, 0.5, 0, false), white);
  EXPECT_EQ(Shadow([](DrawState& d) { d.texture1_outside = ProjectOutside::dark; }).at(1.5, 0.5, 9999, false),
            dark);
}

TEST(ProjectedTexture, TakesTexelsAsTheyAreWithoutAComparison) {
  const Shadow s([](DrawState& d) { d.texture1_compare = false; });
  EXPECT_EQ(s.at(1.5, 0.5, 0), (std::array<double, 3>{19, 19, 19}));  // 4951 / 256
}

}  // namespace
}  // namespace bitspan
