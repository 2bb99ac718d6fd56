// SPDX-License-Identifier: Apache-2.0
// PLY, the Stanford polygon format: ascii and both binary forms.
#pragma once

#include <string>
#include <string_view>

#include "scene/mesh_file.hpp"

namespace bitspan {

// Reads the file. docs/formats.md says what is read, refused and left out. Throws InputError with the line,
// or in binary data with the offset, where anything that is read is wrong. All faces are two-sided.
MeshFile read_ply(const std::string& path);

// The same of a file's contents; `path` is what messages call it, and images stand beside it.
MeshFile parse_ply(std::string_view bytes, const std::string& path);

}  // namespace bitspan
