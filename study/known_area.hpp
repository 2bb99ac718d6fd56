// SPDX-License-Identifier: Apache-2.0
// Areas that the database of a study keeps.
#pragma once

#include <stop_token>

#include "study/area.hpp"
#include "study/store.hpp"

namespace bitspan {

// Returns the area, which is measured once for all configurations that have the same RTL. Throws as
// measure_area does, but for a missing nextpnr, which is `failed`.
AreaResult known_area(const Config& config, AreaTarget target, bool place, Store& store,
                      const std::stop_token& stop);

}  // namespace bitspan
