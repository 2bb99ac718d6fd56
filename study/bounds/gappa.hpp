// SPDX-License-Identifier: Apache-2.0
// Writes stages as Gappa scripts, and runs Debian's `gappa` on them. A script has the arithmetic of a place
// with its roundings. Its hypotheses are what earlier places deliver, and its goal is the bound of
// study/bounds/bounds.hpp.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "study/bounds/input_range.hpp"

namespace bitspan {

// Returns the places that have a script: "reciprocal.pixel", "edge.h_acc", "edge.h", "edge.f", "edge.uv",
// "span.h", "span.f", "span.uv". For uv and f, it is u or v, whichever has the larger bound.
const std::vector<std::string_view>& gappa_places();

// Returns what the place's script claims, the error's largest magnitude. For "edge.h_acc", "edge.h",
// "edge.uv", "span.h" and "span.uv" it is the bound against `ideal` that error_bounds states. For "edge.f"
// and "span.f" it is against the line through the registers at the ends. For "reciprocal.pixel" it is the
// largest m 2^-e (h + B) - 1, a relative error.
double gappa_claim(const Config& config, const InputRange& range, std::string_view place);

// Returns one script, or several that are true together: a table has one per run of its entries. `claim` is
// another bound than gappa_claim's, for tests that expect a refusal. Throws InputError as error_bounds does,
// where the place has no script, where the unit is not normalised, and where the bound is no sum of
// roundings. That is so where a register of the stage may saturate or wrap in the range, or a line's ends are
// nearly equal.
std::vector<std::string> gappa_scripts(const Config& config, const InputRange& range, std::string_view place,
                                       std::optional<double> claim = std::nullopt);

struct GappaVerdict {
  bool proved = false;
  std::string output;  // what gappa printed
};

// Runs gappa on the script. Throws InputError where it is not installed, cannot be run, does not answer
// within a minute, or does not accept the script's language.
GappaVerdict check_with_gappa(const std::string& script);
// Runs gappa on each of gappa_scripts in turn, up to the first that is not proved.
GappaVerdict prove_with_gappa(const Config& config, const InputRange& range, std::string_view place,
                              std::optional<double> claim = std::nullopt);

}  // namespace bitspan
