# SPDX-License-Identifier: Apache-2.0
# Joins sources to one translation unit (bitspan_units of CMakeLists.txt). The anonymous namespaces of each stand in a
# namespace of its own: inside, a helper of the file comes before helpers of the same name in others.
FNR == 1 {
  print "#line 1 \"" substr(FILENAME, length(root) + 2) "\"" >out
  ++file
}
/^namespace {$/ { $0 = "inline namespace file_" file " { namespace {" }
/^}  \/\/ namespace$/ { $0 = "}}  // namespace" }
{ print >out }
