// SPDX-License-Identifier: Apache-2.0
// Makes bounds with the words that explain them.
#pragma once

#include <array>
#include <vector>

#include "config/config.hpp"
#include "study/bounds/bounds.hpp"
#include "study/bounds/places.hpp"

namespace bitspan::bounds {

// Returns the bounds. The places are the same for every range of a configuration, also where no pixel is
// covered.
std::vector<Bound> explained(const Config& config, const std::array<PlaceError, place_count>& places,
                             const std::array<WorstCase, place_count>& worst);

}  // namespace bitspan::bounds
