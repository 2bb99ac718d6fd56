// SPDX-License-Identifier: Apache-2.0
// What the commands that make terrain have in common.
#pragma once

#include <optional>
#include <string>

#include "cli/progress.hpp"
#include "scene/generate/height_field.hpp"
#include "scene/generate/terrain.hpp"

namespace CLI {
class App;
}

namespace bitspan {

struct FieldOptions {
  std::string field;
  std::optional<std::string> array;
  int every = 1;
  TerrainPlace place;
};
// The field, what of it is taken, and how it lies in the mesh.
void add_field_options(CLI::App& command, FieldOptions& o);
// Throws InputError where an option is out of range, or the field is bad.
HeightField load_field(const FieldOptions& o);

// `output` in front of the work: there is one, and it can be written.
void check_output(const std::string& output);

// "LABEL: DONE of TOTAL" on a terminal.
WorkProgress shown(Progress& progress);

}  // namespace bitspan
