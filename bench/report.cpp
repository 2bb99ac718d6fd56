// SPDX-License-Identifier: Apache-2.0
#include "bench/report.hpp"

#include <algorithm>

#include "cli/progress.hpp"
#include "config/config.hpp"

namespace bitspan::bench {

bool Options::wants(std::string_view section) const {
  return only.empty() || std::ranges::find(only, section) != only.end();
}

Series& Report::add(std::string name, double work, std::string unit) {
  Series& s = series.emplace_back();
  s.name = std::move(name);
  s.work = work;
  s.unit = std::move(unit);
  return s;
}

std::vector<const Series*> Report::since(std::size_t from) const {
  std::vector<const Series*> out;
  for (std::size_t i = from; i < series.size(); ++i) {
    out.push_back(&series[i]);
  }
  return out;
}

void take_turns(const std::string& label, std::vector<Turn>& turns, int rounds) {
  constexpr double slow_seconds = 1;
  const int slow_rounds = 1 + rounds / 5;
  std::vector<int> left(turns.size(), rounds);
  Progress progress(label);
  const auto sample = [](Turn& turn, std::optional<double>& seconds) {
    try {
      seconds = turn.sample();
    } catch (const InputError& e) {
      turn.series->missing = e.what();
    }
    return seconds.has_value();
  };
  for (std::size_t i = 0; i < turns.size(); ++i) {
    std::optional<double> warm;
    if (!sample(turns[i], warm)) {
      left[i] = 0;
    } else if (*warm > slow_seconds) {
      left[i] = slow_rounds;
    }
  }
  for (int round = 0; round < rounds; ++round) {
    progress.update(static_cast<std::size_t>(round), static_cast<std::size_t>(rounds));
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(round)) % turns.size();
      std::optional<double>& seconds = turns[i].series->seconds.emplace_back();
      if (left[i] > 0) {
        left[i] = sample(turns[i], seconds) ? left[i] - 1 : 0;
      }
    }
  }
}

}  // namespace bitspan::bench
