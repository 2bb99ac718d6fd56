// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ, with its material libraries (MTL).
#pragma once

#include <string>
#include <string_view>

#include "scene/mesh_file.hpp"

namespace bitspan {

// Reads the file and the material libraries that it names. docs/formats.md says what is read, refused and
// left out. Throws InputError "FILE:LINE: ..." where anything that is read is wrong.
MeshFile read_obj(const std::string& path);

// The same of a file's contents; `path` is what messages call it, and libraries and images stand beside it.
MeshFile parse_obj(std::string_view text, const std::string& path);

}  // namespace bitspan
