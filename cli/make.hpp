// SPDX-License-Identifier: Apache-2.0
// What `bitspan make` makes: each adds itself with its options, as the commands of cli/commands.hpp do.
#pragma once

#include "cli/commands.hpp"

namespace bitspan {

void add_make_curve(CLI::App& make, Action& action);
void add_make_patches(CLI::App& make, Action& action);

}  // namespace bitspan
