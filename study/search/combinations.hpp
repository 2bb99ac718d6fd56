// SPDX-License-Identifier: Apache-2.0
// Searches every combination of the categories for itself. To the inner search, which knows widths only, an
// axis of categories has one value.
#pragma once

#include <functional>
#include <vector>

#include "study/search/search.hpp"

namespace bitspan::searching {

// A search over the axes within the limits of the plan.
using InnerSearch = std::function<SearchResult(const SearchPlan&, const std::vector<Axis>&,
                                               const std::function<void(const SearchProgress&)>&)>;

// Returns the axes with the one value of each category that the point has.
std::vector<Axis> narrowed(std::vector<Axis> axes, const SearchPoint& point);
// Returns the point of such axes as one of all axes.
SearchPoint widened(const std::vector<Axis>& axes, SearchPoint inner, const SearchPoint& point);
// Does so to the points of a certificate.
void widen(const std::vector<Axis>& axes, Certificate& certificate, const SearchPoint& point);

// Runs the inner search for each combination, in the order of a grid. Each gets an equal part of the
// evaluations and seconds that are left, and what it leaves goes to the later ones. Returns the cheapest
// result, the earliest among equals, with the comparison of all.
SearchResult search_combinations(const SearchPlan& plan, const std::vector<Axis>& axes,
                                 const InnerSearch& inner,
                                 const std::function<void(const SearchProgress&)>& progress);

}  // namespace bitspan::searching
