// SPDX-License-Identifier: Apache-2.0
// How deep JSON that comes from outside may be.
#pragma once

#include <optional>
#include <string_view>

namespace bitspan {

constexpr int json_depth_limit = 64;

// Returns the line, from 1, on which arrays and objects are nested deeper; nothing where they are not.
std::optional<int> line_nested_too_deep(std::string_view text);

// Throws InputError, with the line, where arrays and objects are nested deeper. To be called before a parser
// that recurses, or whose values are copied, compared or written by recursion: a stack ends where no handler
// helps.
void check_json_depth(std::string_view text);

}  // namespace bitspan
