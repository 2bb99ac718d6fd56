// SPDX-License-Identifier: Apache-2.0
// The points of a study as a CSV file lists them (RFC 4180).
#pragma once

#include <string>
#include <vector>

#include "study/plan.hpp"

namespace bitspan {

// Returns one axis per key, with one value per point. The first line of the file names the keys; the columns
// of results that a study writes are passed over. A blank cell is the base's value. At most points_limit
// points. Throws InputError, with file, line and column, for what is no key or no value of it.
std::vector<Axis> read_points(const std::string& path, const Config& base);

}  // namespace bitspan
