// merge: blends a fragment with the stored colour. docs/numeric-spec.md, "merge" (T5).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/extent.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {

struct MergeStage {
  bool narrow = false;  // the blend fits int64
  Register color_in, alpha, color;
  bool operator==(const MergeStage&) const = default;
};
constexpr MergeStage prepare_merge(const Config& config) {
  MergeStage s;
  s.color_in = make_register(config, FormatId::fog_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  s.color = make_register(config, FormatId::merge_color);
  const Extent color = sum(extent(config.format(FormatId::fog_color)), extent_of_integer(8));
  const Extent share = extent(config.format(FormatId::texture_alpha));
  s.narrow = fits_int64(sum(product(color, share), product(extent_of_integer(8), share)));
  return s;
}

// stored: the pixel's red, green, blue before, codes 0..255; the record holds them after, and z.
template <class Watch = NoObserve>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 3>& stored, MergeRecord& out,
           Watch watch = {});

}  // namespace bitspan::model
