// SPDX-License-Identifier: Apache-2.0
// The JSON schema of configuration files, for editors and for tools that write configurations.
#pragma once

#include <string>

namespace bitspan {

// Returns JSON Schema 2020-12 over the keys of config/keys.hpp: tables, types, names and ranges. Rules
// between keys are in no schema; find_config checks them.
std::string config_schema();

}  // namespace bitspan
