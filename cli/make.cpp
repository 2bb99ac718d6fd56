// SPDX-License-Identifier: Apache-2.0
// bitspan make: meshes from parameters or files.
#include <CLI/CLI.hpp>

#include "cli/make_commands.hpp"

namespace bitspan {

void add_make(CLI::App& app, Action& action) {
  CLI::App* make = app.add_subcommand("make", "points of a curve, or quads of patches");
  make->require_subcommand(1);
  make->footer(help_footer("the file is written", "", "bitspan make curve points.csv -o curve.obj"));
  add_make_curve(*make, action);
  add_make_patches(*make, action);
}

}  // namespace bitspan
