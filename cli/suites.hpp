// SPDX-License-Identifier: Apache-2.0
// bitspan verify --suite: the named suites of report/suites.hpp, each through the engines.
#pragma once

#include <cstdint>
#include <string>

#include "cli/model_options.hpp"

namespace bitspan {

struct SuiteFlags {
  std::string pattern;
  bool list = false;
  std::string engines = "golden,model";
  bool engines_named = false;  // by the user: each of them must take part
  std::uint64_t seed = 1;
  std::string junit, json;
  std::string out = ".";  // folder of the replay files
  ModelFlags model;
};

// Prints one line per suite, and returns the exit code. Throws InputError where no suite matches.
int verify_suites(const SuiteFlags& flags);

}  // namespace bitspan
