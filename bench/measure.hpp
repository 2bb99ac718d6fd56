// SPDX-License-Identifier: Apache-2.0
// Measurements that are compared within one run: samples taken turn about, medians, spreads and ratios.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace bitspan::bench {

// One thing that is measured. Sample i was taken in round i, near the samples i of everything else that it is
// compared with. It has no sample of a round that it left out.
struct Series {
  std::string name;
  std::string unit = "Mpixel/s";
  double work = 0;                             // units of 10^6 per sample
  std::vector<std::optional<double>> seconds;  // per sample
  std::string missing;                         // why there is none
};

struct Summary {
  double median = 0, low = 0, high = 0;
  int samples = 0;
};
// Returns the summary of the numbers given; all zero where there is none.
Summary summarise(std::vector<double> numbers);
// Returns work / seconds of a series.
Summary rate(const Series& series);
// Returns a's rate over b's, round by round where both took part; where no round has both, the ratio of the
// medians.
Summary ratio(const Series& a, const Series& b);

// A row of "What it must reach".
struct Goal {
  std::string work, against;
  const Series* ours = nullptr;
  const Series* theirs = nullptr;
  double at_least = 0;  // 0: no goal, only told
};

// Return everything of a run, as text and as JSON. A series that a goal needs and that has no samples makes a
// row that says why.
std::string series_table(const std::vector<const Series*>& series);
// Returns the goals that are asked for, or those that are only told; empty where there are none.
std::string goal_table(const std::vector<Goal>& goals, bool asked, bool markdown);
std::string to_json(const std::vector<const Series*>& series, const std::vector<Goal>& goals,
                    const std::vector<std::string>& notes);

// Returns the machine, such as "EPYC ..., 2 processors": the ratios of two runs may differ by it.
std::string machine();

double now_seconds();  // a clock that only runs forward

}  // namespace bitspan::bench
