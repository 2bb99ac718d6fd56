// SPDX-License-Identifier: Apache-2.0
// One scene through several engines, and what is left of it where they differ: what `fuzz`, `replay` and
// `verify --suite` share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/model_options.hpp"
#include "engine/registry.hpp"
#include "report/describe.hpp"
#include "report/lockstep.hpp"
#include "scene/scene.hpp"

namespace bitspan {

using Engines = std::vector<std::unique_ptr<Engine>>;

// The engines of a list, two at least and not ideal. Throws InputError; `who` ("suites") is to leave ideal
// out, and `one` ("a suite") compares.
std::vector<std::string> engines_to_compare(const ModelFlags& model, const std::string& list,
                                            std::string_view who, std::string_view one);
// Makes the engines that run the configuration, in the order of their names.
Engines make_engines(const std::vector<std::string>& names, const Config& config, std::uint64_t stall_seed,
                     EngineOptions options);

struct CaseResult {
  std::string failure;  // one line, empty where all held
  std::string details;
  std::uint64_t fragments = 0, covered = 0, values = 0, non_trivial = 0;
  std::vector<std::string> compared;  // engines that were compared in values that are not trivial
};

// Names what the stage of each divergence read (report/reads.hpp).
void add_reads(LockStepResult& run, const Config& config, const Scene& scene);

// What is wrong with a pair that does not hold: one line, and the whole story.
struct PairFailure {
  std::string line, details;
};
PairFailure failure_of(const Comparison& pair, const Config& config, const RunLabel& label);

// What a pass over a scene has to say. Coverage is checked against the exact test where the configuration
// promises it and the scene keeps its view.
CaseResult check_case(const Engines& engines, const Config& config, const Scene& scene,
                      const RunLabel& label);

// Returns the text of the scene's refusal, and an empty one where the configuration takes it.
std::string refusal(const Engines& engines, const Config& config, const Scene& scene);

// Drops triangles, then textures and fog, as long as the case still fails.
Scene shrink(const Engines& engines, const Config& config, Scene scene, const RunLabel& label);

// Writes a case for `bitspan replay`. `found` says where it came from and what was seen.
void write_replay(const std::string& path, const Engines& engines, const Config& config, const Scene& scene,
                  std::uint64_t stall_seed, const std::string& found);

}  // namespace bitspan
