/* SPDX-License-Identifier: Apache-2.0 */
/* The header alone, and its initialisers, with every warning on. */
#include "bitspan/bitspan.h"

bs_vertex vertex(void);
bs_scene_desc scene(void);

bs_vertex vertex(void) {
  bs_vertex v = BS_VERTEX_INIT;
  return v;
}

bs_scene_desc scene(void) {
  bs_scene_desc s = BS_SCENE_DESC_INIT;
  return s;
}
