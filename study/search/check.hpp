// SPDX-License-Identifier: Apache-2.0
// Checks what a search gets. Each function throws InputError, which names the key.
#pragma once

#include <vector>

#include "study/search/search.hpp"

namespace bitspan::searching {

void check_axes(const std::vector<Axis>& axes);
void check_constraints(const std::vector<Constraint>& constraints);
void check_plan(const SearchPlan& plan);

}  // namespace bitspan::searching
