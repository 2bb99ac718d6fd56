// SPDX-License-Identifier: Apache-2.0
// Prints the end of `bitspan study`: the search's answer, what is recommended with all that was found out
// about it, and the report.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "study/plan.hpp"
#include "study/search/search.hpp"
#include "study/store.hpp"
#include "study/sweep.hpp"

namespace bitspan {

// Returns the search's point and its certificate as text, or what fails at the widest point.
std::string search_text(const StudyPlan& plan, const SearchResult& result);

// Synthesises the best points of a search for an estimated cost (measure_best), and returns a table of what
// was estimated and measured; "" where the search does not end so.
std::string measure_text(const StudyPlan& plan, const SearchResult& result, PointRunner& runner, Store& store,
                         const std::stop_token& stop);

// Makes the scenes of a name, as load_scenes.
using LoadScenes = std::function<std::vector<Scene>(const std::string&)>;

// Examines what the study recommends and prints what it finds. Returns true where all views agree, no error
// is above its bound and the constraints hold on the scenes that validate. Returns true, too, where nothing
// is recommended, and prints that. lit, curves: as PointMeter has them.
bool examine_recommendations(const StudyPlan& plan, const std::vector<Scene>& scenes, const LoadScenes& load,
                             const LoadLit& lit, const LoadCurves& curves, Store& store,
                             const std::stop_token& stop);

// Writes the HTML report with its plots into a folder, with python/bitspan_report. Throws ToolError with what
// that program said where it fails. `against` is the database of a study to compare with; "" for none.
void write_study_report(const std::string& database, const std::string& study, const std::string& folder,
                        const std::string& against);

}  // namespace bitspan
