// SPDX-License-Identifier: Apache-2.0
// --bands: a picture in bands of rows (engine/bands.hpp).
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan {

// "480,16,1" -> heights of bands in rows, each of them once. Throws InputError otherwise.
std::vector<int> parse_bands(const std::string& list);
// Throws InputError where the scene cannot be drawn in bands of so many rows.
void check_bands(int rows, const Scene& scene);
// The same where the engine of that name draws whole pictures.
void check_band_engine(const std::string& engine);

}  // namespace bitspan
