// SPDX-License-Identifier: Apache-2.0
// merge: blends a fragment with the stored colour. docs/numeric-spec.md, "merge" (T5).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {

struct MergeStage {
  bool fits_int64 = false;  // the blend fits int64
  Register color_in, alpha, color;
  bool operator==(const MergeStage&) const = default;
};
constexpr MergeStage prepare_merge(const Config& config) {
  MergeStage s;
  s.color_in = make_register(config, FormatId::fog_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  s.color = make_register(config, FormatId::merge_color);
  const Grid code = integer_grid(8);
  const Grid color = signed_grid(config.format(FormatId::fog_color)) - code;
  const Grid share = signed_grid(config.format(FormatId::texture_alpha));
  s.fits_int64 = fits_int64(color * share + code * share);
  return s;
}

// stored: the pixel's red, green, blue before, codes 0..255; the record holds them after, and z.
template <class Watch = NoObserve>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 3>& stored, MergeRecord& out,
           Watch watch = {});

}  // namespace bitspan::model
