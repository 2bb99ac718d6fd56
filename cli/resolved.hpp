// SPDX-License-Identifier: Apache-2.0
// The mean of the samples of each pixel, behind the engines: stage `resolve_samples` [H9].
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "report/compare.hpp"

namespace bitspan {

// RGBA of the pixels of which the engine drew k * k samples each. Golden's and the model's are by arithmetic
// of their own; the engines behind the model take the model's. The mean of `ideal` is rounded to the nearest
// code.
std::vector<std::uint8_t> resolved_picture(const Engine& engine, const Config& config, int k);
// The same of a picture that the engine of that name has drawn.
std::vector<std::uint8_t> resolved_picture(std::string_view engine, const Frame& frame, const Config& config,
                                           int k);

struct ResolvedComparison {
  StageCount count;
  std::uint64_t own = 0;  // of its values: by arithmetic of the other engine's own
  std::string first;      // one line; empty without differences
};
// Peak signal to noise over R, G, B of the engine's averaged picture, against that of `ideal`; infinite where
// they are equal.
double resolved_psnr_db(const Engine& engine, const Engine& ideal, const Config& config, int k);
ResolvedComparison compare_resolved(const Engine& reference, const Engine& other, const Config& config,
                                    int k);

}  // namespace bitspan
