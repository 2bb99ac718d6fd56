// SPDX-License-Identifier: Apache-2.0
// The mesh formats that have no reader of their own, through Assimp in a program of its own: bitspan-assimp.
#pragma once

#include <string>

#include "scene/mesh_file.hpp"

namespace bitspan {

// Runs assimp_program() on the file. Throws InputError "FILE: what; expected what" where there is no such
// program, it refuses the file, a signal or a limit ends it, its answer is no mesh, or it has not answered
// after `seconds`. The program itself may take 60 s of the processor and 8 GiB.
MeshFile read_by_assimp(const std::string& path, double seconds = 120);

}  // namespace bitspan
