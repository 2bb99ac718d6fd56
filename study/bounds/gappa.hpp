// SPDX-License-Identifier: Apache-2.0
// Stages as Gappa scripts, and Debian's `gappa` as the judge: the arithmetic of a place written out with its
// roundings, what earlier places deliver as hypotheses, and the bound of study/bounds.hpp as the goal.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "study/bounds/input_range.hpp"

namespace bitspan {

// The places that have a script: "reciprocal.pixel", "edge.h_acc", "edge.h", "edge.f", "edge.uv", "span.h",
// "span.f", "span.uv". uv and f: of u and v, whichever has the larger bound.
const std::vector<std::string_view>& gappa_places();

// What the place's script claims: the error's largest magnitude. "edge.h_acc", "edge.h", "edge.uv", "span.h",
// "span.uv": the bound against `ideal` that error_bounds states. "edge.f", "span.f": against the line through
// the registers at the ends. "reciprocal.pixel": relative, m 2^-e (h + B) - 1.
double gappa_claim(const Config& config, const InputRange& range, std::string_view place);

// One script, or several that are true together: of a table, one for each of its runs of entries.
// claim: another bound than gappa_claim's, to see it refused. Throws InputError where the place has no
// script, where the unit is not normalised, where the bound is no sum of roundings (a register of the stage
// may saturate or wrap in the range, or a line's ends are all but equal), and as error_bounds.
std::vector<std::string> gappa_scripts(const Config& config, const InputRange& range, std::string_view place,
                                       std::optional<double> claim = std::nullopt);

struct GappaVerdict {
  bool proved = false;
  std::string output;  // what gappa printed
};

// Runs gappa on the script. Throws InputError where it is not installed, cannot be run, does not answer
// within a minute, or does not accept the script's language.
GappaVerdict check_with_gappa(const std::string& script);
// gappa_scripts in turn, up to the first that is not proved.
GappaVerdict prove_with_gappa(const Config& config, const InputRange& range, std::string_view place,
                              std::optional<double> claim = std::nullopt);

}  // namespace bitspan
