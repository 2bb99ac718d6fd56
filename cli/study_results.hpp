// SPDX-License-Identifier: Apache-2.0
// The end of `bitspan study`: the search's answer, what is recommended with all that was found out of it, and
// the report.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "study/plan.hpp"
#include "study/search/search.hpp"
#include "study/store.hpp"

namespace bitspan {

// As text: the point, its certificate, or what fails at the widest one.
std::string search_text(const StudyPlan& plan, const SearchResult& result);

// Examines what the study recommends and tells it. True where all views agree and no error is above its
// bound; true too where nothing is recommended, which it says.
bool examine_recommendations(const StudyPlan& plan, const std::vector<Scene>& scenes, Store& store,
                             const std::stop_token& stop);

// The HTML report with its plots in a folder, by python/bitspan_report. Throws ToolError with what it said
// where it fails.
void write_study_report(const std::string& database, const std::string& study, const std::string& folder);

}  // namespace bitspan
