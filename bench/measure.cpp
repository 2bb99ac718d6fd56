// SPDX-License-Identifier: Apache-2.0
#include "bench/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "report/table.hpp"

namespace bitspan::bench {
namespace {

std::vector<double> rates(const Series& s) {
  std::vector<double> out;
  for (const std::optional<double>& seconds : s.seconds) {
    if (seconds) {
      out.push_back(s.work / *seconds);
    }
  }
  return out;
}

std::string number(double x) {
  if (x >= 100) {
    return fmt::format("{:.0f}", x);
  }
  return x >= 10 ? fmt::format("{:.1f}", x) : fmt::format("{:.2f}", x);
}

// Returns half of the difference between the lowest and the highest, in per cent of the median.
std::string spread(const Summary& s) {
  return s.samples < 2 ? "" : fmt::format("{:.0f} %", 50 * (s.high - s.low) / s.median);
}

nlohmann::ordered_json to_object(const Summary& s) {
  return {{"median", s.median}, {"low", s.low}, {"high", s.high}, {"samples", s.samples}};
}

}  // namespace

Summary summarise(std::vector<double> numbers) {
  Summary s;
  s.samples = static_cast<int>(numbers.size());
  if (numbers.empty()) {
    return s;
  }
  std::ranges::sort(numbers);
  const std::size_t half = numbers.size() / 2;
  s.median = numbers.size() % 2 == 1 ? numbers[half] : (numbers[half - 1] + numbers[half]) / 2;
  s.low = numbers.front();
  s.high = numbers.back();
  return s;
}

Summary rate(const Series& series) { return summarise(rates(series)); }

Summary ratio(const Series& a, const Series& b) {
  std::vector<double> by_round;
  for (std::size_t i = 0; i < std::min(a.seconds.size(), b.seconds.size()); ++i) {
    if (a.seconds[i] && b.seconds[i]) {
      by_round.push_back((a.work / *a.seconds[i]) / (b.work / *b.seconds[i]));
    }
  }
  if (!by_round.empty()) {
    return summarise(std::move(by_round));
  }
  const Summary x = rate(a);
  const Summary y = rate(b);
  if (x.samples == 0 || y.samples == 0) {
    return {};
  }
  return {x.median / y.median, x.low / y.high, x.high / y.low, 1};
}

std::string series_table(const std::vector<const Series*>& series) {
  std::vector<std::vector<std::string>> rows{{"measured", "unit", "median", "low", "high", "spread", "n"}};
  std::string missing;
  for (const Series* s : series) {
    const Summary r = rate(*s);
    if (r.samples == 0) {
      missing += fmt::format("not measured: {}: {}\n", s->name, s->missing);
      continue;
    }
    rows.push_back({s->name, s->unit, number(r.median), number(r.low), number(r.high), spread(r),
                    std::to_string(r.samples)});
  }
  return (rows.size() > 1 ? text_table(rows) : "") + missing;
}

std::string goal_table(const std::vector<Goal>& goals, bool asked, bool markdown) {
  std::vector<std::vector<std::string>> rows{{"work", "against", "ratio", "from .. to"}};
  if (asked) {
    rows.front().insert(rows.front().end(), {"at least", "reached"});
  }
  for (const Goal& g : goals) {
    if (asked != (g.at_least > 0)) {
      continue;
    }
    const Summary r = ratio(*g.ours, *g.theirs);
    if (r.samples == 0) {
      const Series& absent = rate(*g.ours).samples == 0 ? *g.ours : *g.theirs;
      rows.push_back({g.work, g.against, "-", absent.missing});
    } else {
      rows.push_back({g.work, g.against, number(r.median), number(r.low) + " .. " + number(r.high)});
    }
    if (asked) {
      const char* verdict = r.samples == 0 ? "not measured" : r.median >= g.at_least ? "yes" : "no";
      rows.back().insert(rows.back().end(), {number(g.at_least), verdict});
    }
  }
  if (rows.size() == 1) {
    return "";
  }
  return markdown ? markdown_table(rows) : text_table(rows);
}

std::string to_json(const std::vector<const Series*>& series, const std::vector<Goal>& goals,
                    const std::vector<std::string>& notes) {
  nlohmann::ordered_json out;
  out["machine"] = machine();
  out["notes"] = notes;
  out["series"] = nlohmann::ordered_json::array();
  for (const Series* s : series) {
    nlohmann::ordered_json one{{"name", s->name}, {"unit", s->unit}, {"work", s->work}};
    one["rate"] = to_object(rate(*s));
    one["seconds"] = nlohmann::ordered_json::array();
    for (const std::optional<double>& seconds : s->seconds) {
      one["seconds"].push_back(seconds ? nlohmann::ordered_json(*seconds) : nlohmann::ordered_json());
    }
    if (!s->missing.empty()) {
      one["missing"] = s->missing;
    }
    out["series"].push_back(std::move(one));
  }
  out["goals"] = nlohmann::ordered_json::array();
  for (const Goal& g : goals) {
    const Summary r = ratio(*g.ours, *g.theirs);
    nlohmann::ordered_json one{{"work", g.work},
                               {"against", g.against},
                               {"ours", g.ours->name},
                               {"theirs", g.theirs->name},
                               {"ratio", to_object(r)}};
    if (g.at_least > 0) {
      one["at_least"] = g.at_least;
      one["reached"] = r.samples > 0 && r.median >= g.at_least;
    }
    out["goals"].push_back(std::move(one));
  }
  return out.dump(2) + "\n";
}

std::string machine() {
  std::string model = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) {
      model = line.substr(std::min(line.size(), line.find(':') + 2));
      break;
    }
  }
  return fmt::format("{}, {} processors", model, std::thread::hardware_concurrency());
}

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace bitspan::bench
