// SPDX-License-Identifier: Apache-2.0
// Brings the points that several databases hold into one.
#pragma once

#include <cstddef>
#include <string>

#include "study/store.hpp"

namespace bitspan {

struct Merged {
  std::size_t points = 0;  // of the other database
  std::size_t fresh = 0;   // those that `into` did not have
};

// Adds to `into` all points of the database `from`, with what is kept of them, and its studies. Of a study
// that both have, `into` keeps its rows, and learns of each point whether it holds. All of it is kept, or
// nothing. Throws InputError where `from` is no database of studies, where both have a point with different
// results, and where both have a study of one name with different plans or points.
Merged merge_database(Store& into, const std::string& from, std::string_view version);

}  // namespace bitspan
