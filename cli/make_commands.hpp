// SPDX-License-Identifier: Apache-2.0
// The sub-commands of `bitspan make`: parameters or files in, meshes out. Each stands in a file of its own.
#pragma once

#include "cli/commands.hpp"

namespace bitspan {

void add_make_curve(CLI::App& make, Action& action);
void add_make_patches(CLI::App& make, Action& action);
void add_make_quadric(CLI::App& make, Action& action);
void add_make_terrain(CLI::App& make, Action& action);
void add_make_delaunay(CLI::App& make, Action& action);
void add_make_lod(CLI::App& make, Action& action);
void add_make_simplify(CLI::App& make, Action& action);

}  // namespace bitspan
