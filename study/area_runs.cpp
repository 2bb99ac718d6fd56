// SPDX-License-Identifier: Apache-2.0
#include "study/area_runs.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "io/data_folder.hpp"

namespace bitspan {
namespace {

using Matrix = std::vector<std::vector<double>>;

// Solves the normal equations of least squares, A x = b, by elimination with pivots.
std::vector<double> solve(Matrix a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    if (a[pivot][column] == 0) throw InputError("area fit: the runs do not determine every coefficient");
    std::swap(a[pivot], a[column]);
    std::swap(b[pivot], b[column]);
    for (std::size_t row = column + 1; row < n; ++row) {
      const double factor = a[row][column] / a[column][column];
      for (std::size_t k = column; k < n; ++k) a[row][k] -= factor * a[column][k];
      b[row] -= factor * b[column];
    }
  }
  std::vector<double> x(n);
  for (std::size_t row = n; row-- > 0;) {
    x[row] = b[row];
    for (std::size_t k = row + 1; k < n; ++k) x[row] -= a[row][k] * x[k];
    x[row] /= a[row][row];
  }
  return x;
}

struct Sample {
  AreaShape shape;
  AreaCounts counts;
};

std::vector<Sample> samples_of(std::span<const AreaRun> runs, Family family, AreaPart part) {
  std::vector<Sample> samples;
  for (const AreaRun& run : runs) {
    if (run.family == family && fitted_as(run.part) == fitted_as(part))
      samples.push_back({area_shape(config_of(run), {run.family, run.part}), run.counts});
  }
  return samples;
}

// The relative error counts, so a large run weighs no more than a small one.
AreaFit fit_samples(std::span<const Sample> samples, Family family, AreaPart part) {
  const std::size_t n = lut_terms({}, family, part).size();
  Matrix a(n, std::vector<double>(n));
  std::vector<double> b(n);
  double ff_square = 0;
  double ff_sum = 0;
  for (const Sample& s : samples) {
    const std::vector<double> terms = lut_terms(s.shape, family, part);
    const auto luts = static_cast<double>(s.counts.luts);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] += terms[i] / luts;
      for (std::size_t k = 0; k < n; ++k) a[i][k] += terms[i] / luts * terms[k] / luts;
    }
    const double ratio = flip_flop_bits(s.shape, family) / static_cast<double>(s.counts.ffs);
    ff_square += ratio * ratio;
    ff_sum += ratio;
  }
  if (samples.empty()) throw InputError(fmt::format("area fit: no runs of {}", to_string(family)));
  return {solve(a, b), ff_sum / ff_square};
}

class ErrorSum {
 public:
  void add(double estimated, double measured) {
    const double percent = measured == 0 ? (estimated == 0 ? 0 : 100) : 100 * (estimated / measured - 1);
    max_ = std::max(max_, std::abs(percent));
    squares_ += percent * percent;
    ++count_;
  }
  AreaFitError error() const { return {max_, std::sqrt(squares_ / std::max(1, count_))}; }

 private:
  double max_ = 0;
  double squares_ = 0;
  int count_ = 0;
};

constexpr std::string_view csv_header = "base,settings,family,part,luts,ffs,multipliers,memory_bits,tools";

std::int64_t count_in(const std::string& text) {
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw InputError(fmt::format("'{}' is no count", text));
  return value;
}

AreaRun run_in(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  if (cells.size() != 9) throw InputError(fmt::format("expected the 9 columns {}", csv_header));
  AreaRun run;
  run.base = cells[0];
  std::istringstream settings(cells[1]);
  for (std::string setting; settings >> setting;) {
    const std::size_t equal = setting.find('=');
    if (equal == std::string::npos) throw InputError(fmt::format("'{}' sets no key", setting));
    run.settings.push_back({setting.substr(0, equal), value_in(std::string_view(setting).substr(equal + 1))});
  }
  run.family = family_named(cells[2]);
  run.part = area_part_named(cells[3]);
  run.counts = {count_in(cells[4]), count_in(cells[5]), count_in(cells[6]), count_in(cells[7])};
  run.tools = cells[8];
  return run;
}

// Estimates each sample by a fit to all others.
std::vector<AreaEstimate> left_out_estimates(const std::vector<Sample>& samples, Family family,
                                             AreaPart part) {
  std::vector<AreaEstimate> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::vector<Sample> others = samples;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    out.push_back(estimate_area(samples[i].shape, family, part, fit_samples(others, family, part)));
  }
  return out;
}

// Returns the least of the shares that at least held_share of them do not exceed.
double share_that_holds(std::vector<double> shares) {
  std::ranges::sort(shares);
  return shares.at(static_cast<std::size_t>(std::ceil(held_share * double(shares.size()))) - 1);
}

}  // namespace

AreaErrorShares left_out_shares(std::span<const AreaRun> runs, Family family, AreaPart part) {
  const std::vector<Sample> samples = samples_of(runs, family, part);
  const std::vector<AreaEstimate> left_out = left_out_estimates(samples, family, part);
  std::vector<double> luts;
  std::vector<double> ffs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    luts.push_back(std::abs(double(samples[i].counts.luts) / left_out[i].luts - 1));
    ffs.push_back(std::abs(double(samples[i].counts.ffs) / left_out[i].ffs - 1));
  }
  return {share_that_holds(std::move(luts)), share_that_holds(std::move(ffs))};
}

AreaFit fit_area(std::span<const AreaRun> runs, Family family, AreaPart part) {
  return fit_samples(samples_of(runs, family, part), family, part);
}

AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family, AreaPart part) {
  const std::vector<Sample> samples = samples_of(runs, family, part);
  const AreaFit whole = fit_samples(samples, family, part);
  const std::vector<AreaEstimate> left_out = left_out_estimates(samples, family, part);
  ErrorSum luts;
  ErrorSum luts_left_out;
  ErrorSum ffs;
  ErrorSum ffs_left_out;
  ErrorSum multipliers;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const AreaEstimate in = estimate_area(samples[i].shape, family, part, whole);
    const AreaEstimate& out = left_out[i];
    const AreaCounts& measured = samples[i].counts;
    luts.add(in.luts, static_cast<double>(measured.luts));
    luts_left_out.add(out.luts, static_cast<double>(measured.luts));
    ffs.add(in.ffs, static_cast<double>(measured.ffs));
    ffs_left_out.add(out.ffs, static_cast<double>(measured.ffs));
    multipliers.add(in.multipliers, static_cast<double>(measured.multipliers));
  }
  return {luts.error(), luts_left_out.error(), ffs.error(), ffs_left_out.error(), multipliers.error()};
}

Config config_of(const AreaRun& run) {
  const std::filesystem::path file = data_folder() / "config" / (run.base + ".toml");
  return with_keys(load_config(file.string()), run.settings);
}

std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::string line;
  if (!in || !std::getline(in, line) || line != csv_header)
    throw InputError(fmt::format("{}: cannot be read, or does not begin with {}", csv.string(), csv_header));
  std::vector<AreaRun> runs;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      runs.push_back(run_in(line));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}:{}: {}", csv.string(), number, error.what()));
    }
  }
  return runs;
}

void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs) {
  std::ofstream out(csv);
  out << csv_header << '\n';
  for (const AreaRun& run : runs) {
    std::string settings;
    for (const KeySetting& setting : run.settings)
      settings += fmt::format("{}{}={}", settings.empty() ? "" : " ", setting.path, to_string(setting.value));
    out << fmt::format("{},{},{},{},{},{},{},{},{}\n", run.base, settings, to_string(run.family),
                       to_string(run.part), run.counts.luts, run.counts.ffs, run.counts.multipliers,
                       run.counts.memory_bits, run.tools);
  }
  out.close();
  if (!out) throw InputError(fmt::format("{}: cannot be written", csv.string()));
}

void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits) {
  tbb::parallel_for_each(runs.begin(), runs.end(), [&limits](AreaRun& run) {
    const AreaResult result = measure_area(config_of(run), {run.family, run.part}, false, limits);
    if (result.status != AreaStatus::ok)
      throw InputError(fmt::format("{} of {} in {}: {}", to_string(run.part), run.base, to_string(run.family),
                                   result.message));
    run.counts = result.counts;
    run.tools = result.tools;
  });
}

}  // namespace bitspan
