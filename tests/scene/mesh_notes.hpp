// SPDX-License-Identifier: Apache-2.0
// What the tests of the readers of meshes ask about notes.
#pragma once

#include <algorithm>
#include <string_view>

#include "scene/mesh_file.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {

inline bool has_note(const MeshFile& file, std::string_view part) {
  return std::ranges::any_of(file.notes, [&](const std::string& note) { return names(note, part); });
}

}  // namespace bitspan
