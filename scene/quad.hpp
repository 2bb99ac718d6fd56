// SPDX-License-Identifier: Apache-2.0
// Scenes of quadric bodies (.quad), a TOML file; docs/formats.md, "Quadrics". [V2]
#pragma once

#include <functional>
#include <string>

#include "scene/mesh_file.hpp"

namespace bitspan {

// Reads a mesh that the file names, by its path.
using ReadMesh = std::function<MeshFile(const std::string& path)>;

// Tables [[body]], each a quadric body that is tessellated here, and [[mesh]], each a mesh file, relative to
// this one, moved and scaled. The bodies' triangles come first, in their order, and `quadrics` has their
// forms. Throws InputError with one line, file, line and key where the file is something else.
MeshFile read_quad(const std::string& path, const ReadMesh& read_mesh);

}  // namespace bitspan
