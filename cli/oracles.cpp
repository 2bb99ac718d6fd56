// SPDX-License-Identifier: Apache-2.0
#include "cli/oracles.hpp"

#include "study/bounds/bounds.hpp"

namespace bitspan {

std::optional<Visibility> visibility_of(const Config& config, const Scene& scene, std::string& why) {
  why = visibility_refusal(config, scene);
  if (!why.empty()) return std::nullopt;
  try {
    return Visibility(config, scene, stored_depth_bounds(config, scene));
  } catch (const InputError& error) {  // no bound is known
    why = error.what();
    return std::nullopt;
  }
}

std::string own_refusal(const Oracle& oracle, const Config& config, const Scene& scene) {
  return oracle.refuses == nullptr ? "" : oracle.refuses(config, scene);
}

}  // namespace bitspan
