// SPDX-License-Identifier: Apache-2.0
// What the library and its plug-ins agree on. A plug-in is a shared library with one engine that needs what
// the library is to be free of (lib/plugin.cpp).
//
// Both sides are C++ of one build: records, configurations and exceptions cross between them. The hash says
// so, and the library reads nothing else of a plug-in that has another.
#pragma once

#include "engine/registry.hpp"

namespace bitspan::capi {

// 16 hexadecimal digits over the sources, the compiler and the build type (lib/build_hash.cmake).
const char* build_hash();

struct Plugin {
  const char* build;  // stays the first member
  EngineEntry engine;
};

// What a plug-in has under the name plugin_symbol.
using PluginFunction = const Plugin* (*)();
inline constexpr const char* plugin_symbol = "bitspan_plugin";

}  // namespace bitspan::capi
