// SPDX-License-Identifier: Apache-2.0
// A guard in front of Assimp's PLY reader, which does not return from some broken headers, aborts on some
// truncated files and reads others without a word.
#pragma once

#include <iosfwd>
#include <string>

namespace bitspan {

// Reads a PLY file, whose first byte `file` stands at. Throws InputError where its header is no PLY header,
// or where its data ends before all elements that the header promises.
void check_ply(std::istream& file, const std::string& path);

}  // namespace bitspan
