// SPDX-License-Identifier: Apache-2.0
// The names of SystemVerilog modules and packages, and texts in which they are prefixed.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace bitspan {

// What a text declares.
struct SvNames {
  std::set<std::string, std::less<>> modules, packages;
};
SvNames declared_names(std::string_view text);

// Returns the text with `prefix` in front of these names, wherever one stands for a module or a package:
// declarations, instances and `package::`. Signals, ports, comments and strings of the same spelling stay.
std::string with_prefix(std::string_view text, std::string_view prefix, const SvNames& names);

// Throws InputError where names cannot begin with this: it is empty, a keyword, or has another character than
// letters, digits and underscores.
void check_prefix(std::string_view prefix);
// Throws InputError where a prefixed name is the name of another module, so that both could not be read
// together.
void check_prefix(std::string_view prefix, const SvNames& names);

}  // namespace bitspan
