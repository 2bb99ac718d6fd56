// SPDX-License-Identifier: Apache-2.0
#include "cli/study_results.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "io/data_folder.hpp"
#include "io/message.hpp"
#include "report/table.hpp"
#include "study/measured_cost.hpp"
#include "study/recommend.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

// Returns one line per key, and one per named axis, which has its keys beside it.
std::string point_text(const std::vector<Axis>& axes, const SearchPoint& point) {
  std::string out;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    std::vector<std::string> keys;
    for (const KeySetting& s : settings_of({axes[a]}, {point[a]})) {
      keys.push_back(fmt::format("{} = {}", s.path, to_string(s.value)));
    }
    if (axes[a].name.empty()) {
      out += fmt::format("  {}\n", fmt::join(keys, "\n  "));
    } else {
      out += fmt::format("  {} = {} ({})\n", axes[a].name, axis_text(axes[a], axes[a].values[point[a]]),
                         comma_list(keys));
    }
  }
  return out;
}

// Shows a status line on standard error, which the next one replaces.
void tell(const std::string& what) {
  if (::isatty(STDERR_FILENO) != 0) say("\r\033[K" + (what.empty() ? "" : what + " ..."));
}

// Returns a table that compares the combinations of categories, and "" where there are none.
std::string combinations_text(const StudyPlan& plan, const SearchResult& result) {
  if (result.combinations.empty()) return "";
  std::vector<std::vector<std::string>> rows{
      {"combination", plan.search->cost, "evaluations", "stopped by", "certificate", "what fails"}};
  for (const Combination& c : result.combinations) {
    rows.push_back({c.text, c.found ? cost_text(c.cost, c.cost_error) : "-", fmt::format("{}", c.evaluations),
                    std::string(to_string(c.stopped_by)),
                    !c.found                   ? "-"
                    : c.certificate.minimal()  ? "minimal"
                    : c.certificate.complete() ? "not minimal"
                                               : "incomplete",
                    c.failing});
  }
  return "combinations:\n" + text_table(rows);
}

}  // namespace

std::string search_text(const StudyPlan& plan, const SearchResult& result) {
  std::string out;
  if (!result.found) {
    out = fmt::format("{}: nothing found in {} evaluations; the widest point{} fails:\n", plan.name,
                      result.evaluations, result.combinations.empty() ? "" : " of every combination");
    for (const std::string& line : result.failing) out += "  " + line + "\n";
    return out;
  }
  out = fmt::format("{}: {} = {} after {} evaluations ({}):\n{}", plan.name, plan.search->cost,
                    cost_text(result.cost, result.cost_error), result.evaluations,
                    to_string(result.stopped_by), point_text(plan.axes, result.point));
  out += ends_with_synthesis(plan) ? "certificate of the least estimate:\n" : "certificate:\n";
  return out + to_text(result.certificate) + combinations_text(plan, result);
}

std::string measure_text(const StudyPlan& plan, const SearchResult& result, PointRunner& runner, Store& store,
                         const std::stop_token& stop) {
  const MeasuredCosts costs = measure_best(plan, result, runner, store, tell, stop);
  tell("");
  if (costs.points.empty()) return "";
  std::vector<std::vector<std::string>> rows{{"point", "estimated", "measured", "difference", ""}};
  for (const MeasuredCost& c : costs.points) {
    const bool failed = std::isnan(c.measured);
    rows.push_back({c.hash.substr(0, 8), cost_text(c.estimated, c.error),
                    failed ? "-" : fmt::format("{:.6g}", c.measured),
                    failed ? "-" : fmt::format("{:+.1f} %", 100 * (c.measured / c.estimated - 1)),
                    failed                    ? c.message
                    : c.point == result.point ? "the least estimate"
                                              : ""});
  }
  std::string out = fmt::format("measured {}:\n{}", plan.search->cost, text_table(rows));
  if (costs.left_out > 0) {
    out += fmt::format("{} more within the error were not synthesised (search.measure = {})\n",
                       costs.left_out, plan.search->measure);
  }
  const MeasuredCost& best = costs.points[0];
  if (best.point != result.point && !std::isnan(best.measured)) {
    out += fmt::format(
        "the least measured is another point than the least estimate, and has no certificate:\n{}",
        point_text(plan.axes, best.point));
  }
  return out;
}

bool examine_recommendations(const StudyPlan& plan, const std::vector<Scene>& scenes, const LoadScenes& load,
                             const LoadLit& lit, const LoadCurves& curves, Store& store,
                             const std::stop_token& stop) {
  const auto recommended = recommendations(plan, store);
  if (recommended.empty()) {
    fmt::print("nothing to recommend: {}{}\n",
               plan.search || !plan.constraints.empty()
                   ? "no point holds all constraints"
                   : fmt::format("there is no constraint, and {} against {} has no knee", error_metric(plan),
                                 cost_metric(plan)),
               plan.area || plan.budget || plan.bounds
                   ? "; areas, budgets and bounds are of what is recommended"
                   : "");
    return true;
  }
  bool held = true;
  for (const Recommendation& point : recommended) {
    if (stop.stop_requested()) break;
    Examination found = examine(plan, point, scenes, store, tell, stop, lit, curves);
    if (!plan.validation.empty() && !plan.constraints.empty() && !stop.stop_requested()) {
      Validation unseen = validate(plan, point, load, store, tell, stop, lit, curves);
      found.held = found.held && unseen.held == unseen.views;
      std::ranges::move(unseen.lines, std::back_inserter(found.lines));
    }
    tell("");
    fmt::print("recommended {}: {}\n", point.hash, point.reason);
    for (const std::string& line : found.lines) fmt::print("  {}\n", line);
    held = held && found.held;
  }
  return held;
}

void write_study_report(const std::string& database, const std::string& study, const std::string& folder,
                        const std::string& against) {
  namespace fs = std::filesystem;
  const std::string python = (data_folder() / "python").string();
  ::setenv("PYTHONPATH", python.c_str(), 1);
  const ScratchFolder scratch = temporary_scratch_folder("bitspan-report");
  const fs::path log = scratch / "log";
  // This is Debian's own interpreter. The first on PATH may not see Debian's packages.
  std::vector<std::string> words{"/usr/bin/python3", "-B",   "-m",      "bitspan_report",
                                 database,           folder, "--study", study};
  if (!against.empty()) words.insert(words.end(), {"--against", against});
  const int code = run_program(words, log, "--report");
  std::string text = read_text(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (code != 0) throw ToolError("--report: " + (text.empty() ? "no word" : text));
  fmt::print("report: {}\n", (fs::path(folder) / "report.html").string());
}

}  // namespace bitspan
