// SPDX-License-Identifier: Apache-2.0
#include "report/bands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "report/describe.hpp"
#include "report/table.hpp"

namespace bitspan {
namespace {

// The finaliser of splitmix64.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

void add_up(const Comparison& more, Comparison& into) {
  for (std::size_t t = 0; t < into.stages.size(); ++t) into.stages[t] += more.stages[t];
  into.frame += more.frame;
  into.counters += more.counters;
  if (!into.first) into.first = more.first;
  if (into.fault.empty()) into.fault = more.fault;
}

}  // namespace

void RecordDigest::add(const Trace& trace) {
  for (std::size_t t = 0; t < of_.size(); ++t) {
    const RecordView view = view_of(trace, static_cast<RecordType>(t));
    of_[t].records += view.records;
    for (std::size_t i = 0; i < view.records; ++i) {
      std::uint64_t hash = t + 1;
      for (const std::int64_t value : view.record(i)) {
        hash = mixed(std::rotl(hash, 5) + std::bit_cast<std::uint64_t>(value) + 0x9e3779b97f4a7c15U);
      }
      of_[t].hash += hash;
    }
  }
}

std::string RecordDigest::difference(const RecordDigest& other) const {
  for (std::size_t t = 0; t < of_.size(); ++t) {
    if (of_[t] == other.of_[t]) continue;
    return fmt::format("stage {}: {} records with hash {:016x} against {} with {:016x}",
                       stage_of(static_cast<RecordType>(t)), of_[t].records, of_[t].hash,
                       other.of_[t].records, other.of_[t].hash);
  }
  return "";
}

std::uint64_t RecordDigest::records() const {
  std::uint64_t out = 0;
  for (const Sum& sum : of_) out += sum.records;
  return out;
}

std::uint64_t RecordDigest::hash() const {
  std::uint64_t out = 0;
  for (const Sum& sum : of_) out = mixed(out + sum.hash + sum.records);
  return out;
}

BandReport figures_of_bands(const Config& config, int rows, const BandedRun& run) {
  BandReport out;
  const int height = run.picture.height;
  out.rows = rows;
  out.bands = number_of_bands(height, rows);
  out.counters = run.counters;
  out.work = run.work;
  out.bits = buffer_bits(config, run.picture);
  out.bytes = out.bits.bytes(static_cast<std::uint64_t>(run.picture.width) *
                             static_cast<std::uint64_t>(std::min(rows, height)));
  return out;
}

BandReport compare_bands(std::vector<std::unique_ptr<Engine>> engines, const Config& config,
                         const Scene& scene, int rows, const WholeRun& whole,
                         const std::function<void(int)>& done) {
  const BandedPlan plan = banded_plan(scene);
  BandReport out;
  std::vector<BandedEngine*> banded;
  for (auto& engine : engines) {
    auto one = std::make_unique<BandedEngine>(std::move(engine), config);
    banded.push_back(one.get());
    out.engines.emplace_back(one->name());
    engine = std::move(one);
  }
  RecordDigest digest;
  LockStepOptions steps;
  steps.observe = [&](const Batch& /*batch*/, const Trace& trace) { digest.add(trace); };
  BandedRun all;
  for (int b = 0; b < number_of_bands(plan.height, rows); ++b) {
    const RowRange of = band_of(plan.height, rows, b);
    for (BandedEngine* engine : banded) engine->set_band(plan, of);
    const LockStepResult run = run_lock_step(engines, scene, steps);
    out.pairs.resize(run.pairs.size());
    for (std::size_t p = 0; p < run.pairs.size(); ++p) {
      const Comparison& pair = run.pairs[p];
      out.pairs[p].reference = pair.reference;
      out.pairs[p].other = pair.other;
      add_up(pair, out.pairs[p]);
      const auto fail = [&](const std::string& what) {
        out.failures.push_back(fmt::format("{}, band {} (rows {} to {}), {} against {}: {}", bands_name(rows),
                                           b, of.first, of.end - 1, pair.reference, pair.other, what));
      };
      if (pair.first) fail(summary(*pair.first, config));
      if (!pair.fault.empty()) fail("it broke off: " + pair.fault);
      if (!run.stopped && banded[p + 1]->work() != banded[0]->work())
        fail("they do not repeat the same work");
    }
    all.add(*banded[0], plan.height);
    if (!out.held()) break;
    done(b);
  }
  BandReport figures = figures_of_bands(config, rows, all);
  figures.engines = std::move(out.engines);
  figures.pairs = std::move(out.pairs);
  figures.failures = std::move(out.failures);
  figures.records = digest.records();
  figures.hash = digest.hash();
  out = std::move(figures);
  if (!out.held()) return out;
  out.whole.reference = fmt::format("{}, whole", out.engines[0]);
  out.whole.other = fmt::format("{} in {}", out.engines[0], bands_name(rows));
  compare_frames(whole.picture, all.picture, out.whole);
  compare_counters(whole.counters, out.counters, out.whole);
  const auto fail = [&](const std::string& what) {
    out.failures.push_back(fmt::format("{} against {}: {}", out.whole.reference, out.whole.other, what));
  };
  if (const std::string what = whole.digest.difference(digest); !what.empty()) fail(what);
  if (out.whole.first) {
    fail(summary(*out.whole.first, config));
  } else if (out.whole.frame.unmatched != 0) {
    fail("the planes of the picture have other sizes");
  }
  return out;
}

std::string bands_name(int rows) { return fmt::format("bands of {} row{}", rows, rows == 1 ? "" : "s"); }

std::string bands_text(std::span<const BandReport> reports) {
  std::vector<std::vector<std::string>> rows{
      {"rows per band", "bands", "bytes of buffers", "setups", "again", "unsorted", "rows", "walked over"}};
  for (const BandReport& report : reports) {
    rows.emplace_back();
    for (const std::uint64_t n :
         {static_cast<std::uint64_t>(report.rows), static_cast<std::uint64_t>(report.bands), report.bytes,
          report.work.set_up, report.work.set_up_again, report.work.unsorted, report.counters.rows,
          report.work.rows_above}) {
      rows.back().push_back(fmt::format("{}", n));
    }
  }
  std::string out = text_table(rows);
  const BufferBits& bits = reports[0].bits;
  out += fmt::format("bits per pixel: depth {}, colour {}", bits.depth, bits.color);
  if (bits.stencil != 0) out += fmt::format(", stencil {}", bits.stencil);
  if (bits.candidate != 0) out += fmt::format(", candidate {}", bits.candidate);
  out += "\n";
  for (const BandReport& report : reports) {
    if (report.work.fragments_again == 0) continue;
    out += fmt::format("{}: {} fragments of other targets are drawn again\n", bands_name(report.rows),
                       report.work.fragments_again);
  }
  return out;
}

}  // namespace bitspan
