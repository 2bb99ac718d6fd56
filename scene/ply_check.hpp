// A guard in front of Assimp's PLY reader, which does not return from some broken headers, aborts on some
// truncated files and reads others without a word.
#pragma once

#include <iosfwd>
#include <string>

namespace bitspan {

// Reads a PLY file, `file` at its first byte, and throws InputError where its header is no PLY header or its
// data ends before all elements that the header promises.
void check_ply(std::istream& file, const std::string& path);

}  // namespace bitspan
