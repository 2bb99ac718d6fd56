/* SPDX-License-Identifier: Apache-2.0 */
/* A program of another that hands bad files to the library: each call returns a status and a text of one
 * line, and the program lives on. A crash case found anywhere is a row below. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bitspan/bitspan.h"

enum kind { SCENE, CONFIG, CONFIG_TEXT, PART };

/* The file is `head`, `piece` as often as `count` says, and `tail`. A PART is what the row after it names. */
struct row {
  enum kind kind;
  const char* name;
  const char* head;
  const char* piece;
  size_t count;
  const char* tail;
};

#define TRI_HEAD                                                                                        \
  "{\"bitspan\": 1, \"width\": 32, \"height\": 24, \"s_min\": 1.0, \"s_max\": 100.0, \"focal\": 30.0, " \
  "\"background\": [1, 2, 3]"
#define TRI_VERTICES "{\"v\": [[2, 2, 2, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]]"
#define TRI_COLORS ", \"c\": [[1, 0.5, 0.2, 1], [0.3, 1, 0.6, 1], [0.1, 0.2, 1, 1]]"
#define PLY_HEAD(vertices, faces)                            \
  "ply\nformat ascii 1.0\nelement vertex " vertices          \
  "\nproperty float x\nproperty float y\nproperty float z\n" \
  "element face " faces "\nproperty list uchar int vertex_indices\nend_header\n"
#define VERTICES_3 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define CORNERS "-1 -1 0\n1 -1 0\n0 1 0\n"

static const struct row rows[] = {
    {CONFIG, "empty.toml", "", "", 0, ""},
    {CONFIG, "binary.toml",
     "\x7f"
     "ELF\x01\x02",
     "\xff\xfe", 500, ""},
    {CONFIG, "parts.toml", "a", ".a", 200000, " = 1\n"},
    {CONFIG, "header.toml", "[a", ".a", 200000, "]\n"},
    {CONFIG, "keys.toml", "", "a.b.c.d.e = 1\n", 50000, ""},
    {CONFIG, "arrays.toml", "a = ", "[", 200000, ""},
    {CONFIG, "tables.toml", "a = ", "{a=", 200000, ""},
    {CONFIG, "strings.toml", "a = \"", "\\\\", 200000, ""},
    {CONFIG, "large.toml", "", "# a comment\n", 100000, ""},
    {CONFIG, "section.toml", "[raster]\n", "subpixel_bits = 4\n", 3, ""},
    {CONFIG_TEXT, "parts", "a", ".a", 1000000, " = 1\n"},
    {CONFIG_TEXT, "header", "[[a", ".\"a\"", 1000000, "]]\n"},
    {CONFIG_TEXT, "arrays", "a = ", "[", 1000000, ""},
    {CONFIG_TEXT, "mark", "\xEF\xBB\xBF", "", 0, ""},
    {CONFIG_TEXT, "open string", "a = '''", "x\n", 100000, ""},

    {SCENE, "empty.tri", "", "", 0, ""},
    {SCENE, "binary.tri",
     "\x7f"
     "ELF\x01\x02",
     "\xff\xfe", 5000, ""},
    {SCENE, "header.tri", "{\"bitspan\": 1, ", "\"width\": 32, ", 2000, ""},
    {SCENE, "version.tri", "{\"bitspan\": 1e400}\n", "", 0, ""},
    {SCENE, "short.tri", TRI_HEAD "}\n" TRI_VERTICES, "", 0, ""},
    {SCENE, "numbers.tri", TRI_HEAD "}\n{\"v\": [[", "9", 100000, ""},
    {SCENE, "tex.tri", TRI_HEAD "}\n" TRI_VERTICES TRI_COLORS ", \"tex\": 5}\n", "", 0, ""},
    {SCENE, "no_texture.tri", TRI_HEAD ", \"textures\": [\"no.png\"]}\n", "", 0, ""},
    {SCENE, "deep.tri", "", "[", 300000, "\n"},
    {SCENE, "deep_background.tri", "{\"bitspan\": 1, \"background\": ", "[", 300000, "\n"},
    {PART, "bad.png", "\x89PNG\r\n\x1a\n", "IHDR", 1000, ""},
    {SCENE, "png.tri", TRI_HEAD ", \"textures\": [\"bad.png\"]}\n", "", 0, ""},
    {PART, "bad.bmp", "BM", "\x01\x02\x03\x04", 1000, ""},
    {SCENE, "bmp.tri", TRI_HEAD ", \"textures\": [\"bad.bmp\"]}\n", "", 0, ""},
    {PART, "bad.gif", "GIF89a", "\x01\x02\x03\x04", 1000, ""},
    {SCENE, "gif.tri", TRI_HEAD ", \"textures\": [\"bad.gif\"]}\n", "", 0, ""},
    {PART, "bad.jpg", "\xFF\xD8\xFF\xE0", "\x01\x02\x03\x04", 1000, ""},
    {SCENE, "jpg.tri", TRI_HEAD ", \"textures\": [\"bad.jpg\"]}\n", "", 0, ""},
    {PART, "bad.tga", "\x01\x01\x01", "\x01\x02\x03\x04", 1000, ""},
    {SCENE, "tga.tri", TRI_HEAD ", \"textures\": [\"bad.tga\"]}\n", "", 0, ""},

    {SCENE, "empty.obj", "", "", 0, ""},
    {SCENE, "binary.obj",
     "\x7f"
     "ELF\x01\x02",
     "\xff\xfe", 5000, ""},
    {SCENE, "no_vertices.obj", "", "f 1 2 3\n", 1000, ""},
    {SCENE, "index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "", 0, ""},
    {SCENE, "zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 0 0\n", "", 0, ""},
    {SCENE, "large_index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 99999999999999999999 2 3\n", "", 0, ""},
    {SCENE, "empty.ply", "", "", 0, ""},
    {SCENE, "short.ply", PLY_HEAD("3", "1") CORNERS, "", 0, ""},
    {SCENE, "index.ply", PLY_HEAD("3", "1") CORNERS "3 0 1 9\n", "", 0, ""},
    {SCENE, "negative.ply", PLY_HEAD("-3", "1") CORNERS "3 0 1 2\n", "", 0, ""},
    {SCENE, "count.ply", PLY_HEAD("4000000000", "1") CORNERS, "", 0, ""},
    {SCENE, "two.ply",
     "ply\nformat ascii 1.0\n" VERTICES_3 VERTICES_3
     "element face 1\nproperty list uchar int vertex_indices\nend_header\n" CORNERS CORNERS "3 0 1 2\n",
     "", 0, ""},
    {SCENE, "list.ply", PLY_HEAD("3", "1") CORNERS "250", " 0", 3, "\n"},
    {SCENE, "header.ply", "ply\nformat ascii 1.0\n", "comment x\n", 10000, ""},
    {SCENE, "empty.gltf", "", "", 0, ""},
    {SCENE, "short.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [", "{", 3, ""},
    {SCENE, "deep.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"extras\": ", "[", 300000, ""},
    {SCENE, "no_buffer.gltf",
     "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"uri\": \"no.bin\", \"byteLength\": 36}], "
     "\"bufferViews\": "
     "[{\"buffer\": 0, \"byteLength\": 36}], \"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, "
     "\"count\": 3, "
     "\"type\": \"VEC3\"}], \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}], "
     "\"nodes\": [{\"mesh\": "
     "0}], \"scenes\": [{\"nodes\": [0]}], \"scene\": 0}",
     "", 0, ""},
    {SCENE, "empty.glb", "", "", 0, ""},
    {SCENE, "length.glb", "glTF\x02", "\xff", 3, "\xff\xff\xff\xffJSON"},
    {SCENE, "empty.stl", "", "", 0, ""},
    {SCENE, "short.stl", "solid x\nfacet normal 0 0 1\nouter loop\n", "vertex 0 0\n", 3, ""},
    {SCENE, "binary.stl", "", "\xff", 84, ""},
    {SCENE, "deep.dae", "<COLLADA version=\"1.4.1\"><library_visual_scenes><visual_scene id=\"s\">", "<node>",
     200000, ""},
    {SCENE, "no.such.extension", "text", "", 0, ""},
};

static char folder[] = "/tmp/bitspan-host-XXXXXX";

static void fail(const char* name, const char* what) {
  fprintf(stderr, "host: %s: %s; last error: %s\n", name, what, bs_last_error());
  exit(1);
}

static char* text_of(const struct row* r) {
  const size_t head = strlen(r->head), piece = strlen(r->piece), tail = strlen(r->tail);
  char* text = malloc(head + piece * r->count + tail + 1);
  if (text == NULL) fail(r->name, "no memory");
  memcpy(text, r->head, head);
  for (size_t i = 0; i < r->count; ++i) memcpy(text + head + i * piece, r->piece, piece);
  memcpy(text + head + r->count * piece, r->tail, tail + 1);
  return text;
}

static void write_text(const char* path, const char* text) {
  FILE* file = fopen(path, "wb");
  if (file == NULL || fwrite(text, 1, strlen(text), file) != strlen(text) || fclose(file) != 0) {
    fail(path, "cannot be written");
  }
}

static void refused(const char* name, bs_status status) {
  const char* text = bs_last_error();
  if (status != BS_BAD_INPUT) fail(name, "expected BS_BAD_INPUT");
  if (*text == '\0' || strchr(text, '\n') != NULL) fail(name, "expected a text of one line");
}

/* Also a file of the caller's. */
static void load_scene(const char* name, const char* path) {
  bs_scene* scene = NULL;
  refused(name, bs_scene_load(path, 0, 0, &scene));
  if (scene != NULL) fail(name, "a scene beside an error");
}

static void read_row(const struct row* r) {
  char path[sizeof folder + 64];
  char* text = text_of(r);
  bs_config* config = NULL;
  snprintf(path, sizeof path, "%s/%s", folder, r->name);
  if (r->kind != CONFIG_TEXT) write_text(path, text);
  if (r->kind == SCENE) load_scene(r->name, path);
  if (r->kind == CONFIG) refused(r->name, bs_config_load(path, &config));
  if (r->kind == CONFIG_TEXT) refused(r->name, bs_config_parse(text, &config));
  if (config != NULL) fail(r->name, "a configuration beside an error");
  if (r->kind != PART && r->kind != CONFIG_TEXT) unlink(path);
  free(text);
}

/* After all of them, the library draws as before. */
static uint64_t picture(void) {
  bs_config* config = NULL;
  bs_scene* scene = NULL;
  bs_model* model = NULL;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  bs_view view = {sizeof view, NULL, 0, 0, 0, 0, 0};
  const bs_vertex* vertices = NULL;
  const int32_t* textures = NULL;
  size_t count = 0;
  uint64_t sum = 14695981039346656037u;
  if (bs_config_load("depth16", &config) != BS_OK || bs_scene_load("demo", 64, 48, &scene) != BS_OK ||
      bs_open(config, "model", &model) != BS_OK || bs_scene_get(scene, &desc) != BS_OK ||
      bs_scene_triangles(scene, &vertices, &textures, &count) != BS_OK || bs_begin(model, &desc) != BS_OK ||
      bs_draw_scene(model, scene, 0, count, 0, 0) != BS_OK ||
      bs_frame_view(model, BS_PLANE_COLOR, &view) != BS_OK || view.rows != 48) {
    fail("demo", "cannot be drawn");
  }
  for (size_t i = 0; i < view.rows * view.stride; ++i) {
    sum = (sum ^ ((const unsigned char*)view.base)[i]) * 1099511628211u;
  }
  bs_close(model);
  bs_scene_free(scene);
  bs_config_free(config);
  return sum;
}

int main(int argc, char** argv) {
  char path[sizeof folder + 64];
  const size_t count = sizeof rows / sizeof *rows;
  if (mkdtemp(folder) == NULL) fail(folder, "cannot be made");
  const uint64_t before = picture();
  for (size_t i = 0; i < count; ++i) read_row(&rows[i]);
  for (int i = 1; i < argc; ++i) load_scene(argv[i], argv[i]);
  for (size_t i = 0; i < count; ++i) {
    if (rows[i].kind != PART) continue;
    snprintf(path, sizeof path, "%s/%s", folder, rows[i].name);
    unlink(path);
  }
  if (rmdir(folder) != 0) fail(folder, "holds files that the library left");
  if (picture() != before) fail("demo", "another picture");
  printf("%zu bad files, each refused in one line\n", count);
  return 0;
}
