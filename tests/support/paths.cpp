// SPDX-License-Identifier: Apache-2.0
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

std::string joined(std::string root, std::string_view below) {
  if (!below.empty()) root.append("/").append(below);
  return root;
}

}  // namespace

std::string source_path(std::string_view below) { return joined(BITSPAN_SOURCE_DIR, below); }
std::string build_path(std::string_view below) { return joined(BITSPAN_BINARY_DIR, below); }

}  // namespace bitspan
