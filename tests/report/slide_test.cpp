// SPDX-License-Identifier: Apache-2.0
// A slide on a scene: column and row of each pixel by the route of matrices, in double. [T14]
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "scene/demo.hpp"
#include "scene/shadow.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Vertices are off by half a step of the subpixel grid, so that it is fine here; a texel is about a pixel
// wide.
TEST(Slide, LiesWhereTheMatrixRouteLaysIt) {
  Config config = shipped_config("depth20");
  config.project = ProjectUnit::reciprocal;
  config.subpixel_bits = 10;
  SlideOptions slide;
  slide.image = {"slide.png", 128, 96, std::vector<std::uint8_t>(std::size_t{4} * 128 * 96, 200)};
  slide.projector = {-6, -12, 4};
  slide.at = {0, 2, 26};
  slide.degrees = 50;
  const Scene scene = with_slide(demo_scene(160, 120), slide);
  Viewpoint projector;
  look_at(projector, slide.projector, slide.at, slide.up);
  const double focal = 96 / 2.0 / std::tan(radians(25));

  const auto engine = make_engine("model", config);
  engine->begin(scene);
  Trace trace;
  draw_scene(*engine, scene, 0, scene.triangles.size(), &trace);
  const std::vector<Face> faces = faces_of(scene);
  double worst = 0;
  std::size_t inside = 0, wrong_inside = 0;
  for (const ProjectRecord& r : trace.project) {
    const Vec3 p = in_view(point_at(scene, faces[static_cast<std::size_t>(r.triangle)],
                                    static_cast<double>(r.x) + 0.5, static_cast<double>(r.y) + 0.5),
                           projector);
    const double s = 64 + focal * p.x / p.z;
    const double t = 48 + focal * p.y / p.z;
    // Far outside, and where the projector only grazes a surface, a subpixel is many texels.
    const auto within = [&](double margin) {
      return p.z > 1 && s > -margin && s < 128 + margin && t > -margin && t < 96 + margin;
    };
    wrong_inside += (within(-1) && r.inside == 0) || (!within(1) && r.inside == 1) ? 1U : 0U;
    if (r.inside == 0 || !within(0)) continue;
    ++inside;
    const double ulp = std::ldexp(1.0, -config.format(FormatId::span_uv).fraction());
    worst = std::max(
        {worst, std::abs(static_cast<double>(r.s) * ulp - s), std::abs(static_cast<double>(r.t) * ulp - t)});
  }
  std::printf("%zu fragments in the slide, at most %.4f texels off\n", inside, worst);
  EXPECT_GT(inside, 4000U);
  EXPECT_EQ(wrong_inside, 0U);
  EXPECT_LT(worst, 0.25);
}

}  // namespace
}  // namespace bitspan
