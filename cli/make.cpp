// SPDX-License-Identifier: Apache-2.0
// bitspan make: meshes and curves from parameters or files.
#include <CLI/CLI.hpp>

#include "cli/make_commands.hpp"

namespace bitspan {

void add_make(CLI::App& app, Action& action) {
  CLI::App* make = app.add_subcommand("make", "make a mesh, a simpler one, or points of a curve");
  make->require_subcommand(1);
  make->footer(help_footer("the file is written", "",
                           "bitspan make terrain hills.png -o hills.obj\n"
                           "  bitspan make curve points.csv -o curve.obj"));
  add_make_curve(*make, action);
  add_make_patches(*make, action);
  add_make_quadric(*make, action);
  add_make_terrain(*make, action);
  add_make_delaunay(*make, action);
  add_make_lod(*make, action);
  add_make_simplify(*make, action);
}

}  // namespace bitspan
