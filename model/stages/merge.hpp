// merge: blends a fragment with the stored colour. docs/numeric-spec.md, "merge" (T5).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/quantize.hpp"

namespace bitspan::model {

struct MergeStage {
  bool narrow = false;  // the blend fits int64
  Register color_in, alpha, color;
};
MergeStage prepare_merge(const Config& config);

// stored: the pixel's red, green, blue before, codes 0..255; the record holds them after, and z.
template <class Watch = NoObserve>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 3>& stored, MergeRecord& out,
           Watch watch = {});

}  // namespace bitspan::model
