/* SPDX-License-Identifier: Apache-2.0 */
/* A bench in C: golden's records play the design under test and are checked against the model's. A flipped
 * bit must be found, and a check of nothing must show. The numbers of the interface are pinned here. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bitspan/bitspan.h"

_Static_assert(BS_ABI_VERSION == 10, "renew the numbers below and tests/lib/libbitspan.abi");
_Static_assert(BS_OK == 0 && BS_DIFFERENT == 1 && BS_BAD_INPUT == 2 && BS_BAD_HANDLE == 3, "status");
_Static_assert(BS_BAD_ORDER == 4 && BS_UNSUPPORTED == 5 && BS_BUSY == 6 && BS_NO_MEMORY == 7, "status");
_Static_assert(BS_INTERNAL == 8, "status");
_Static_assert(BS_STAGE_CONSTANTS == 0 && BS_STAGE_SETUP == 1 && BS_STAGE_SETUP_EDGE == 2, "stage");
_Static_assert(BS_STAGE_EDGE_WALK == 3 && BS_STAGE_PLANE_WALK == 4 && BS_STAGE_PLANE_WALK_ROW == 5, "stage");
_Static_assert(BS_STAGE_SPAN_SETUP == 6 && BS_STAGE_SPAN == 7 && BS_STAGE_DEPTH == 8, "stage");
_Static_assert(BS_STAGE_TEXTURE == 9 && BS_STAGE_FOG == 10 && BS_STAGE_MERGE == 11, "stage");
_Static_assert(BS_STAGE_STATE == 12 && BS_STAGE_STENCIL == 13 && BS_STAGE_MERGE_ALPHA == 14, "stage");
_Static_assert(BS_STAGE_SETUP_GRADIENT == 15 && BS_STAGE_LOD == 16 && BS_STAGE_DISTANCE == 17, "stage");
_Static_assert(BS_STAGE_TEXTURE_SECOND == 19 && BS_STAGE_SPAN_CHANNEL == 23 && BS_STAGE_PROJECT == 24,
               "stage");
_Static_assert(BS_STAGE_LIGHT == 25, "stage");
_Static_assert(BS_STAGE_CANDIDATE == 26 && BS_STAGE_LINE_WALK == 27, "stage");
_Static_assert(BS_PLANE_COLOR == 0 && BS_PLANE_DEPTH == 1 && BS_PLANE_U == 2 && BS_PLANE_V == 3, "plane");
_Static_assert(BS_PLANE_TRIANGLE == 4 && BS_PLANE_STENCIL == 5 && BS_PLANE_POSITION == 6, "plane");
_Static_assert(BS_I64 == 0 && BS_U8 == 1 && BS_U32 == 2 && BS_I32 == 3 && BS_F64 == 4, "element");
_Static_assert(BS_TEXEL_RGBA8888 == 0 && BS_TEXEL_RGB332 == 1 && BS_TEXEL_YIQ422 == 2, "texel format");
_Static_assert(BS_TEXEL_A8 == 3 && BS_TEXEL_I8 == 4 && BS_TEXEL_AI44 == 5 && BS_TEXEL_P8 == 6,
               "texel format");
_Static_assert(BS_TEXEL_ARGB8332 == 7 && BS_TEXEL_RGB565 == 8 && BS_TEXEL_ARGB1555 == 9, "texel format");
_Static_assert(BS_TEXEL_ARGB4444 == 10 && BS_TEXEL_AI88 == 11 && BS_TEXEL_AP88 == 12, "texel format");
_Static_assert(BS_TEXEL_AYIQ8422 == 13 && BS_TEXEL_DXT1 == 14 && BS_TEXEL_DXT3 == 15, "texel format");
_Static_assert(BS_TEXEL_DXT5 == 16 && BS_TEXEL_UYVY == 17 && BS_TEXEL_YUYV == 18, "texel format");
_Static_assert(BS_TEXEL_CHECKER == 19 && BS_TEXEL_BRICK == 20 && BS_TEXEL_NOISE == 21, "texel format");
_Static_assert(BS_DIVERGENCE_NONE == 0 && BS_DIVERGENCE_VALUE == 1 && BS_DIVERGENCE_EXTRA == 2, "kind");

static void expect(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "c_bench: %s; last error: %s\n", what, bs_last_error());
  exit(1);
}

static bs_model* drawn(bs_config* config, const char* engine, bs_scene* scene) {
  bs_model* model = NULL;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices = NULL;
  const int32_t* textures = NULL;
  size_t count = 0;
  expect(bs_open(config, engine, &model) == BS_OK, "open");
  expect(bs_scene_get(scene, &desc) == BS_OK, "scene");
  expect(bs_scene_triangles(scene, &vertices, &textures, &count) == BS_OK, "triangles");
  expect(bs_begin(model, &desc) == BS_OK, "begin");
  expect(bs_draw(model, vertices, textures, count, 7, 8) == BS_OK, "draw");
  return model;
}

/* The names belong to the numbers. */
static void check_names(void) {
  static const char* const names[] = {"constants",
                                      "setup",
                                      "setup.edge",
                                      "edge_walk",
                                      "plane_walk",
                                      "plane_walk.row",
                                      "span_setup",
                                      "span",
                                      "depth",
                                      "texture",
                                      "fog",
                                      "merge",
                                      "state",
                                      "stencil",
                                      "merge.alpha",
                                      "setup.gradient",
                                      "lod",
                                      "distance",
                                      "setup.plane",
                                      "texture.second",
                                      "setup.channel",
                                      "edge_walk.channel",
                                      "span_setup.channel",
                                      "span.channel",
                                      "project",
                                      "light",
                                      "candidate",
                                      "line_walk"};
  const int32_t count = (int32_t)(sizeof names / sizeof *names);
  for (int32_t i = 0; i < count; ++i) expect(strcmp(bs_stage_name(i), names[i]) == 0, names[i]);
  expect(count == BS_STAGE_LINE_WALK + 1 && bs_stage_name(count) == NULL, "every stage has its name here");
}

int main(void) {
  check_names();
  bs_config* config = NULL;
  bs_scene* scene = NULL;
  bs_view dut = {sizeof(bs_view), NULL, 0, 0, 0, 0, 0};
  bs_divergence first = {.size = sizeof(bs_divergence)};
  expect(bs_abi_version() == BS_ABI_VERSION, "version");
  expect(bs_config_load("depth16", &config) == BS_OK, "configuration");
  expect(bs_scene_load("demo", 160, 120, &scene) == BS_OK, "demo");
  bs_model* model = drawn(config, "model", scene);
  bs_model* golden = drawn(config, "golden", scene);
  expect(bs_matched(model) == 0 && bs_nontrivial(model) == 0, "nothing is checked yet");

  expect(bs_records(golden, BS_STAGE_SPAN, &dut) == BS_OK, "records");
  expect(dut.rows > 1000, "fragments");
  expect(bs_unchecked(model, BS_STAGE_SPAN) == dut.rows, "unchecked");
  const size_t half = dut.rows / 2;
  const int64_t* records = dut.base;
  expect(bs_check(model, BS_STAGE_SPAN, records, half, &first) == BS_OK, "the first half is equal");
  expect(bs_matched(model) == half * dut.columns && bs_nontrivial(model) > 1000, "counts");

  int64_t flipped[64];
  expect(dut.columns <= 64, "columns");
  memcpy(flipped, records + half * dut.columns, dut.columns * sizeof(int64_t));
  flipped[5] ^= 1;
  expect(bs_check(model, BS_STAGE_SPAN, flipped, 1, &first) == BS_DIFFERENT, "a flipped bit is found");
  expect(first.kind == BS_DIVERGENCE_VALUE && first.record == half && first.field == 5, "its place");
  expect(strcmp(first.field_name, "h") == 0 && first.differences == 1, "its field");
  expect(first.expected == records[half * dut.columns + 5] && first.actual == flipped[5], "its values");
  expect(first.frame == 7 && first.draw == 8, "its draw");
  expect(strstr(bs_last_error(), "span: record ") != NULL, "its text");
  expect(
      bs_check(model, BS_STAGE_SPAN, records + (half + 1) * dut.columns, dut.rows - half - 1, NULL) == BS_OK,
      "the rest is equal");
  expect(bs_unchecked(model, BS_STAGE_SPAN) == 0, "all are checked");
  expect(bs_check(model, BS_STAGE_SPAN, records, 1, &first) == BS_DIFFERENT, "an extra record is found");
  expect(first.kind == BS_DIVERGENCE_EXTRA, "as extra");

  printf("c_bench: %" PRIu64 " values matched, %" PRIu64 " non-trivial\n", bs_matched(model),
         bs_nontrivial(model));
  bs_close(golden);
  bs_close(model);
  bs_scene_free(scene);
  bs_config_free(config);
  return 0;
}
