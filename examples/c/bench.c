// SPDX-License-Identifier: Apache-2.0
#include <bitspan/bitspan.h>
#include <stdio.h>

#define TRY(call)                               \
  do                                            \
    if ((call) != BS_OK) {                      \
      fprintf(stderr, "%s\n", bs_last_error()); \
      return 1;                                 \
    }                                           \
  while (0)

static int draw(bs_config* config, const char* engine, bs_scene* scene, bs_model** model) {
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices;
  const int32_t* textures;
  size_t count;
  TRY(bs_open(config, engine, model));
  TRY(bs_scene_get(scene, &desc));
  TRY(bs_scene_triangles(scene, &vertices, &textures, &count));
  TRY(bs_begin(*model, &desc));
  TRY(bs_draw(*model, vertices, textures, count, 0, 0));
  return 0;
}

int main(void) {
  bs_config* config;
  bs_scene* scene;
  bs_model *model, *dut;
  bs_view pixels = {sizeof(bs_view), NULL, 0, 0, 0, BS_I64, 0};
  TRY(bs_config_load("depth16", &config));
  TRY(bs_scene_load("demo", 160, 120, &scene));
  if (draw(config, "model", scene, &model) || draw(config, "golden", scene, &dut)) return 1;
  TRY(bs_records(dut, BS_STAGE_SPAN, &pixels));
  TRY(bs_check(model, BS_STAGE_SPAN, (const int64_t*)pixels.base, pixels.rows, NULL));
  printf("%llu values matched, %llu non-trivial, %llu records unchecked\n",
         (unsigned long long)bs_matched(model), (unsigned long long)bs_nontrivial(model),
         (unsigned long long)bs_unchecked(model, BS_STAGE_SPAN));
  return bs_matched(model) == 0 || bs_nontrivial(model) == 0 || bs_unchecked(model, BS_STAGE_SPAN) != 0;
}
