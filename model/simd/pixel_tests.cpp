// SPDX-License-Identifier: Apache-2.0
#include "model/simd/pixel_tests.hpp"

#include "model/stages/depth-inl.hpp"

namespace bitspan::model {

bool PixelTests::passes(std::uint32_t z, std::size_t pixel) const {
  const DepthStage& stage = pipeline.depth;
  bool passed =
      HWY_NAMESPACE::depth_word_passes(stage.formats, stage.func, std::int64_t{z}, frame.depth[pixel]);
  if (pipeline.stencil.test) {
    DepthRecord depth;
    depth.pass = passed ? 1 : 0;
    StencilRecord out;
    passed = stencil(pipeline.stencil, back, depth, frame.stencil[pixel], out);
    frame.stencil[pixel] = static_cast<std::uint8_t>(out.value);
    if (out.pass == 0) ++counters.stencil_failed;
  }
  if (passed) ++counters.depth_passed;
  return passed;
}

}  // namespace bitspan::model
