// SPDX-License-Identifier: Apache-2.0
#include "model/stages/merge.hpp"

#include <array>

#include "model/stages/merge-inl.hpp"

namespace bitspan::model {

template <class Watch>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 3>& stored, MergeRecord& out, Watch watch) {
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.z = depth.z;
  namespace text = HWY_NAMESPACE;
  std::array own{fog.r, fog.g, fog.b};
  const bool opaque = texture.a >= text::opaque_alpha(stage);
  for (std::size_t c = 0; c < own.size(); ++c) {
    if (opaque) {
      own[c] = text::replaced(stage, own[c], watch);
    } else if (stage.fits_int64) {
      own[c] = text::blended<std::int64_t>(stage, own[c], stored[c], texture.a, watch);
    } else {
      own[c] = text::blended<int128>(stage, own[c], stored[c], texture.a, watch);
    }
  }
  out.r = own[0];
  out.g = own[1];
  out.b = own[2];
}

template void merge(const MergeStage&, const DepthRecord&, const TextureRecord&, const FogRecord&,
                    const std::array<std::uint8_t, 3>&, MergeRecord&, NoObserve);
template void merge(const MergeStage&, const DepthRecord&, const TextureRecord&, const FogRecord&,
                    const std::array<std::uint8_t, 3>&, MergeRecord&, Observe);

}  // namespace bitspan::model
