// SPDX-License-Identifier: Apache-2.0
// The rules between keys, found one at a time; check_config and the reader turn a violation into InputError.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "config/config.hpp"

namespace bitspan {

struct Violation {
  std::string key;   // full path, such as "reciprocal.pixel.index_bits" or "formats.span.h"
  std::string text;  // what is wrong, and what is legal
};

// The first rule that the configuration breaks; none when it is legal.
std::optional<Violation> first_violation(const Config& config);

// What a start offset is added to, and the register that half an ulp refers to; none for the depth code.
struct OffsetRule {
  const char* key;
  StartOffset StartOffsets::*member;
  FormatId accumulator;
  std::optional<FormatId> kept;
};
std::array<OffsetRule, 7> offset_rules(const Config& config);

// The most bits that fog.depth_bits may have, and fog.zone_bits beside them.
int most_fog_depth_bits(const Config& config);
int most_fog_zone_bits(const Config& config);

}  // namespace bitspan
