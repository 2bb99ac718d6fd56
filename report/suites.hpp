// SPDX-License-Identifier: Apache-2.0
// Named suites: each compares engines where one feature is known to matter. A suite is a feature of the table
// below, a way of perspective and a size of the picture; docs/suites.md tells what the columns mean.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "engine/stages.hpp"
#include "report/lockstep.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// What a suite sets, beside its perspective.
using SuiteSetting = std::function<void(Config&, Scene&)>;

// What must happen to fragments, in a suite of the feature.
enum class SuiteNeeds : std::uint8_t {
  effect,   // some record of the stage is another one without the feature
  passing,  // and the depth test passes some fragments and fails some
  killing,  // and texture kills some fragments and leaves some
};

// One row of the table. A new feature is one row, and gets its suites by that.
struct SuiteFeature {
  std::string name;  // "depth.lequal"
  RecordType stage;  // whose records differ without the feature
  SuiteNeeds needs = SuiteNeeds::effect;
  SuiteSetting with, without;              // given the same configuration and scene
  bool (*applies)(Perspective) = nullptr;  // null: in every way of perspective
};
const std::vector<SuiteFeature>& suite_features();

// "FEATURE/PERSPECTIVE/WIDTHxHEIGHT" of every suite, in the order of the table.
std::vector<std::string> suite_names();
// Those that a pattern of the shell (*, ?, [...]) matches; a * matches slashes too.
std::vector<std::string> matching_suites(const std::string& pattern);

struct SuiteCase {
  std::string name;
  RecordType stage = RecordType::count;
  SuiteNeeds needs = SuiteNeeds::effect;
  Config config, config_without;
  Scene scene, scene_without;
};
// The case of a name, drawn from a hash of the name, the seed and the attempt alone. The attempts grow
// gentler. Its configuration is legal. Throws InputError where there is no suite of that name.
SuiteCase make_suite(const std::string& name, std::uint64_t seed, int attempt);

struct SuiteResult {
  LockStepResult run;
  Counters counters;         // of the first engine
  std::uint64_t effect = 0;  // values of the stage's records that are others without the feature
  std::string trivial;       // why the suite shows nothing; empty where it does
  std::string digest;        // of the configuration and of what the first engine drew: 16 digits
  std::uint64_t values() const;
  std::uint64_t non_trivial() const;
  std::uint64_t differences() const;
  bool agree() const;  // the engines
};

// Engines of a configuration, the first of which is the reference; and another one of the reference alone.
struct SuiteEngines {
  std::function<std::vector<std::unique_ptr<Engine>>(const Config&)> all;
  std::function<std::unique_ptr<Engine>(const Config&)> reference;
};

// Compares the engines. Throws InputError where one of the two configurations refuses its scene.
SuiteResult run_suite(const SuiteCase& suite, const SuiteEngines& engines);

inline constexpr int suite_attempts = 8;

struct SuiteRun {
  SuiteCase suite;  // of the last attempt
  SuiteResult result;
};
// Makes the suite and runs it, with further attempts where a scene is refused or shows nothing.
SuiteRun run_named_suite(const std::string& name, std::uint64_t seed, const SuiteEngines& engines);

}  // namespace bitspan
