// SPDX-License-Identifier: Apache-2.0
// A plug-in: the engine ENGINE, which what is linked beside this file makes known.
#include "lib/plugin.hpp"

extern "C" __attribute__((visibility("default"))) const bitspan::capi::Plugin* bitspan_plugin() {
  static const bitspan::capi::Plugin plugin{bitspan::capi::build_hash(), bitspan::find_engine(ENGINE)};
  return &plugin;
}
