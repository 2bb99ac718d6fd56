// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, as text or as GLB.
#pragma once

#include <string>
#include <string_view>

#include "scene/mesh_file.hpp"

namespace bitspan {

// Reads the triangles of the default scene, or of all root nodes where the file has none, in world space,
// with base colours, COLOR_0 and the texture coordinates of the base colour's texture. second_coordinates:
// those of the occlusion's texture, too, or of the set TEXCOORD_1 in a material without one. Throws
// InputError "FILE: PLACE: what; expected what" where the file is damaged, breaks a rule that the picture
// depends on, or requires an extension that is not honoured.
MeshFile read_gltf(const std::string& path, bool second_coordinates = false);

// The same of a file's contents; `path` is what messages call it, and buffers and images stand beside it.
MeshFile parse_gltf(std::string_view bytes, const std::string& path, bool second_coordinates = false);

}  // namespace bitspan
