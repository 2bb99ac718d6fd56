// SPDX-License-Identifier: Apache-2.0
// Patches in the text of the classic teapot (.bez); docs/formats.md, "Patches". [P1]
#pragma once

#include <string>

#include "scene/generate/patch.hpp"
#include "scene/mesh_file.hpp"

namespace bitspan {

// The number of patches; 16 numbers of vertices, from 1, per patch, row by row; the number of vertices; x, y,
// z per vertex, z upward, which becomes y. Numbers are divided by commas or blanks. The control points are
// the nearest ones of a grid with 2^20 steps up to the power of two above the largest coordinate. Throws
// InputError with one line where the file is something else.
PatchSet read_bez(const std::string& path);

// 2^k steps each way per patch; two triangles per step, without those that have no area. Corners have u and v
// of the patch, 0 to 1, and its normals. Corners on shared boundaries have the same bits.
MeshFile patch_mesh(const PatchSet& set, int k);

}  // namespace bitspan
