# SPDX-License-Identifier: Apache-2.0
# cmake -DROOT=folder -DFILES=list -DSALT=text -DOUT=file -P build_hash.cmake: writes the C++ file with build_hash(), over the
# texts of the files and the salt, which names compiler and build type.
set(text "${SALT}")
foreach(path ${FILES})
  file(RELATIVE_PATH file ${ROOT} ${path})
  file(SHA256 ${path} digest)
  string(APPEND text "\n${file} ${digest}")
endforeach()
string(SHA256 digest "${text}")
string(SUBSTRING ${digest} 0 16 digest)
file(CONFIGURE OUTPUT ${OUT} CONTENT [[
#include "lib/plugin.hpp"

const char* bitspan::capi::build_hash() { return "@digest@"; }
]] @ONLY)
