// SPDX-License-Identifier: Apache-2.0
// The error budget: which quantisation causes how much of the final error.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "study/point.hpp"

namespace bitspan {

// A register, or a reciprocal unit with its output, made as good as exact by `extra_bits` more fraction bits.
// A reciprocal unit then divides. The bits are as many, up to 16, as the rules between the formats allow.
// 2^-extra_bits of the error is left.
struct Quantisation {
  std::string name;  // "span.f", "reciprocal.pixel.output"
  int extra_bits = 0;
};

struct BudgetRow {
  Quantisation quantisation;
  // The metrics with this quantisation exact and the others as configured, and with only this one as
  // configured.
  Metrics without, alone;
};

// `cause` says for each pixel of a scene whose quantisation alone leaves the largest error of u and v. It is
// an index of Budget::rows; -1 stands where nothing was drawn, or nothing errs.
struct DominantMap {
  std::string scene;
  int width = 0, height = 0;
  std::vector<std::int16_t> cause;
};

struct Budget {
  std::vector<std::string> metrics;
  Metrics base, exact;            // as configured; every quantisation exact
  std::vector<BudgetRow> rows;    // those with extra bits, in the pipeline's order
  std::vector<std::string> kept;  // registers that no rule lets have more bits
  std::vector<DominantMap> maps;  // one per scene
};

// Measures the budget. It leaves out the snap of the vertices, which is the input, and what the picture
// stores (depth codes, 8 bits of colour), which is the output. `progress` gets how many points are measured,
// and of how many. Throws InputError for a metric that does not exist, and as PointMeter::measure does.
Budget error_budget(const PointMeter& meter, const Config& config, const std::vector<std::string>& metrics,
                    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

// Returns the configuration with these registers exact. Tests call it, and callers that want the
// configuration itself.
Config with_exact(const Config& config, const std::vector<Quantisation>& quantisations);

}  // namespace bitspan
