// SPDX-License-Identifier: Apache-2.0
// Where the tests' source and build trees are. No other object names a folder, so that another clone finds it
// in the compiler cache.
#pragma once

#include <string>
#include <string_view>

namespace bitspan {

// A path below the source tree, or the tree itself.
std::string source_path(std::string_view below = "");
// The same of the build tree.
std::string build_path(std::string_view below);

}  // namespace bitspan
