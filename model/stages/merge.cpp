#include "model/stages/merge.hpp"

#include <algorithm>

#include "model/numeric/extent.hpp"

namespace bitspan::model {
namespace {

template <class Int, class Watch>
std::int64_t blended(const MergeStage& stage, std::int64_t own, std::int64_t stored, std::int64_t alpha,
                     Watch watch) {
  const int grid = std::max(0, stage.color_in.fraction);
  const Int dst = static_cast<Int>(stored) << grid;
  const Int difference = (static_cast<Int>(own) << (grid - stage.color_in.fraction)) - dst;
  const int a_grid = std::max(0, stage.alpha.fraction);
  const Int share = static_cast<Int>(alpha) << (a_grid - stage.alpha.fraction);
  return quantize((dst << a_grid) + difference * share, grid + a_grid, stage.color, watch);
}

}  // namespace

MergeStage prepare_merge(const Config& config) {
  MergeStage s;
  s.color_in = make_register(config, FormatId::fog_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  s.color = make_register(config, FormatId::merge_color);
  const Extent color = sum(extent(config.format(FormatId::fog_color)), extent_of_integer(8));
  const Extent share = extent(config.format(FormatId::texture_alpha));
  s.narrow = fits_int64(sum(product(color, share), product(extent_of_integer(8), share)));
  return s;
}

template <class Watch>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 3>& stored, MergeRecord& out, Watch watch) {
  out.triangle = depth.triangle;
  out.x = depth.x;
  out.y = depth.y;
  out.z = depth.z;
  std::array own{fog.r, fog.g, fog.b};
  const bool opaque = sign_of(value_of(texture.a, stage.alpha) - Exact{1, 0}) >= 0;
  for (std::size_t c = 0; c < own.size(); ++c) {
    if (opaque) {
      own[c] = quantize(own[c], stage.color_in.fraction, stage.color, watch);
    } else if (stage.narrow) {
      own[c] = blended<std::int64_t>(stage, own[c], stored[c], texture.a, watch);
    } else {
      own[c] = blended<int128>(stage, own[c], stored[c], texture.a, watch);
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
