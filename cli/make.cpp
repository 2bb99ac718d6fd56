// SPDX-License-Identifier: Apache-2.0
// bitspan make: geometry from parameters and files.
#include "cli/make.hpp"

#include <CLI/CLI.hpp>

namespace bitspan {

void add_make(CLI::App& app, Action& action) {
  CLI::App* make = app.add_subcommand("make", "geometry: curves, patches");
  make->require_subcommand(1);
  make->footer(help_footer("the file is written", "", "bitspan make curve points.csv -o curve.obj"));
  for (const auto add : {add_make_curve, add_make_patches}) add(*make, action);
}

}  // namespace bitspan
