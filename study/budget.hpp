// SPDX-License-Identifier: Apache-2.0
// The error budget: which quantisation causes how much of the final error.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "study/point.hpp"

namespace bitspan {

// A register, or a reciprocal unit with its output, made as good as exact: `extra_bits` more fraction bits (a
// reciprocal by division), as many up to 16 as the rules between the formats allow. What is left of its error
// is 2^-extra_bits.
struct Quantisation {
  std::string name;  // "span.f", "reciprocal.pixel.output"
  int extra_bits = 0;
};

struct BudgetRow {
  Quantisation quantisation;
  // By metric: with this one exact and the others as configured; and with only this one as configured.
  std::map<std::string, double, std::less<>> without, alone;
};

// Per pixel of a scene: whose quantisation alone leaves the largest error of u and v, as an index of
// Budget::rows. -1 stands where nothing was drawn, or nothing errs.
struct DominantMap {
  std::string scene;
  int width = 0, height = 0;
  std::vector<std::int16_t> cause;
};

struct Budget {
  std::vector<std::string> metrics;
  std::map<std::string, double, std::less<>> base, exact;  // as configured; every quantisation exact
  std::vector<BudgetRow> rows;                             // those with extra bits, in the pipeline's order
  std::vector<std::string> kept;                           // registers that no rule lets have more bits
  std::vector<DominantMap> maps;                           // one per scene
};

// Not among them: the snap of the vertices, which is the input, and what the picture stores (depth codes, 8
// bits of colour), which is the output. done, total: of the points measured, for progress. Throws InputError
// for a metric that does not exist, and as PointMeter::measure.
Budget error_budget(const PointMeter& meter, const Config& config, const std::vector<std::string>& metrics,
                    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

// A configuration with these registers exact; exposed for tests and for who wants the configuration itself.
Config with_exact(const Config& config, const std::vector<Quantisation>& quantisations);

}  // namespace bitspan
