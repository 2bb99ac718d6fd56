// SPDX-License-Identifier: Apache-2.0
// Where the files are that the program reads beside its input.
#pragma once

#include <filesystem>

namespace bitspan {

// Ends the message of a file that should be in data_folder() and is not.
inline constexpr const char* data_folder_hint = "BITSPAN_ROOT names the folder with rtl/ and tb/";

// The program or the shared library that holds this function.
std::filesystem::path own_file();

// Returns the folder with config/, python/, rtl/ and tb/: the one that $BITSPAN_ROOT names, else
// share/bitspan beside the folder of own_file(), or one level further up; a plug-in counts as the library
// beside its folder. So an installed program works wherever its prefix is moved; in a build
// tree share/bitspan links to the sources. Throws InputError where there is none.
std::filesystem::path data_folder();

// Returns the program that reads meshes by Assimp: the one that $BITSPAN_ASSIMP names, else
// libexec/bitspan/bitspan-assimp, found as share/bitspan is. Throws InputError where there is none.
std::filesystem::path assimp_program();

}  // namespace bitspan
