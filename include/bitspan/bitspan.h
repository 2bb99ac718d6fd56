/* SPDX-License-Identifier: Apache-2.0 */
/* bitspan's C interface: a bit-true raster pipeline for test benches and studies in any language.
 *
 * docs/c_api.md shows it by example. It is C11, and clean as C++17 and C++20.
 *
 * Status: every function that can fail returns a bs_status. Where it is not BS_OK, bs_last_error() says in
 * one line what was wrong and what was expected. A failed call changes nothing, unless its comment says
 * otherwise. No C++ exception leaves the library.
 *
 * Handles: a bs_config, bs_scene or bs_model is opaque. NULL, a closed handle and one of another kind are
 * refused with BS_BAD_HANDLE, and never crash. Different handles may be used by different threads at the same
 * time. One handle is used by one thread at a time; a call on a bs_model that another call is using returns
 * BS_BUSY. Handles share no state that changes.
 *
 * Structs: each begins with `size`, its sizeof where the caller was compiled. An array of structs is walked
 * by the size of its first element, and every element must have that size. Of a struct the library reads, a
 * missing tail means the defaults that the comment of each member names; a tail that the library does not
 * know is refused with BS_UNSUPPORTED unless it is zero. Of a struct the library fills, it fills `size`
 * bytes, and sets a tail that it does not know to zero. Members are only added, at the end.
 *
 * Numbers: constants below are only added, and never change their value.
 *
 * Pointers that the library gives out: each comment says how long they hold.
 */
#ifndef BITSPAN_BITSPAN_H
#define BITSPAN_BITSPAN_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define BS_API __attribute__((visibility("default")))
#else
#define BS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Grows with every addition to this file; bs_abi_version() tells the library's. */
#define BS_ABI_VERSION 10

typedef int32_t bs_status;
enum {
  BS_OK = 0,
  BS_DIFFERENT = 1,   /* bs_check: the caller's records are not the model's */
  BS_BAD_INPUT = 2,   /* a configuration, scene, record or argument is not legal */
  BS_BAD_HANDLE = 3,  /* NULL, closed, or of another kind */
  BS_BAD_ORDER = 4,   /* another call must come first */
  BS_UNSUPPORTED = 5, /* this engine, configuration or library cannot do it */
  BS_BUSY = 6,        /* another call is using the handle */
  BS_NO_MEMORY = 7,
  BS_INTERNAL = 8 /* a fault of the library */
};

/* The records of the pipeline, in its order. docs/numeric-spec.md defines every field. */
typedef int32_t bs_stage;
enum {
  BS_STAGE_CONSTANTS = 0,           /* one record per scene */
  BS_STAGE_SETUP = 1,               /* per triangle that has an area */
  BS_STAGE_SETUP_EDGE = 2,          /* per edge that has a height */
  BS_STAGE_EDGE_WALK = 3,           /* per row; all modes but const_depth_rows */
  BS_STAGE_PLANE_WALK = 4,          /* per triangle; const_depth_rows only */
  BS_STAGE_PLANE_WALK_ROW = 5,      /* per row of constant depth; const_depth_rows only */
  BS_STAGE_SPAN_SETUP = 6,          /* per row */
  BS_STAGE_SPAN = 7,                /* per pixel of a row */
  BS_STAGE_DEPTH = 8,               /* per covered pixel */
  BS_STAGE_TEXTURE = 9,             /* per pixel that passed the depth test */
  BS_STAGE_FOG = 10,                /* per pixel that the texture did not kill */
  BS_STAGE_MERGE = 11,              /* per pixel written */
  BS_STAGE_STATE = 12,              /* per change of draw state */
  BS_STAGE_STENCIL = 13,            /* per pixel that comes to the stencil test */
  BS_STAGE_MERGE_ALPHA = 14,        /* per pixel written whose stored alpha may change */
  BS_STAGE_SETUP_GRADIENT = 15,     /* per triangle that has an area; lod.mode = gradient */
  BS_STAGE_LOD = 16,                /* per pixel that comes to the texture; texture.mip other than none */
  BS_STAGE_DISTANCE = 17,           /* the same; lod.mode = zone_d, or fog.mode = distance, log */
  BS_STAGE_SETUP_PLANE = 18,        /* per triangle that has an area; slope.row = plane */
  BS_STAGE_TEXTURE_SECOND = 19,     /* per pixel that the first texture unit did not kill; texture1 not -1 */
  BS_STAGE_SETUP_CHANNEL = 20,      /* per triangle that has an area and channel in use */
  BS_STAGE_EDGE_WALK_CHANNEL = 21,  /* per row and channel; not with slope.row = plane */
  BS_STAGE_SPAN_SETUP_CHANNEL = 22, /* per row and channel */
  BS_STAGE_SPAN_CHANNEL = 23,       /* per pixel of a row and channel */
  BS_STAGE_PROJECT = 24,            /* per pixel of texture.second while texture1.coordinates = project */
  BS_STAGE_LIGHT = 25,              /* per pixel written in a scene with a light; light.at other than none */
  BS_STAGE_CANDIDATE = 26,          /* per pixel that may be held while translucency.pass = candidate */
  BS_STAGE_LINE_WALK = 27           /* per line that has pixels in the picture; line.walk other than none */
};

/* The planes of a picture: `height` rows of `width` elements, from the top. */
typedef int32_t bs_plane;
enum {
  BS_PLANE_COLOR = 0, /* BS_U8, 4 channels: red, green, blue, alpha, which is 255 at first */
  BS_PLANE_DEPTH = 1, /* BS_U32: the stored code */
  BS_PLANE_U = 2,     /* BS_F64: texels, of the fragment written last; NaN where there is none */
  BS_PLANE_V = 3,     /* BS_F64 */
  BS_PLANE_TRIANGLE =
      4, /* BS_I32: the triangle of that fragment, counted from bs_begin; -1 where there is none */
  BS_PLANE_STENCIL = 5, /* BS_U8; no rows before the first stencil test or clear of the stencil */
  /* BS_F64, 3 channels: the point that the stored code stands for, x to the right, y downward, s, in the unit
   * of s; NaN where the code is that of the cleared plane. Formed by the call that asks for it. */
  BS_PLANE_POSITION = 6
};

typedef int32_t bs_element;
enum { BS_I64 = 0, BS_U8 = 1, BS_U32 = 2, BS_I32 = 3, BS_F64 = 4 };

typedef struct bs_config bs_config;
typedef struct bs_scene bs_scene;
typedef struct bs_model bs_model;

/* Formats of texels; docs/numeric-spec.md, "texel formats". */
typedef int32_t bs_texel_format;
enum {
  BS_TEXEL_RGBA8888 = 0,
  BS_TEXEL_RGB332 = 1,
  BS_TEXEL_YIQ422 = 2,
  BS_TEXEL_A8 = 3,
  BS_TEXEL_I8 = 4,
  BS_TEXEL_AI44 = 5,
  BS_TEXEL_P8 = 6,
  BS_TEXEL_ARGB8332 = 7,
  BS_TEXEL_RGB565 = 8,
  BS_TEXEL_ARGB1555 = 9,
  BS_TEXEL_ARGB4444 = 10,
  BS_TEXEL_AI88 = 11,
  BS_TEXEL_AP88 = 12,
  BS_TEXEL_AYIQ8422 = 13,
  BS_TEXEL_DXT1 = 14,
  BS_TEXEL_DXT3 = 15,
  BS_TEXEL_DXT5 = 16,
  BS_TEXEL_UYVY = 17,
  BS_TEXEL_YUYV = 18,
  BS_TEXEL_CHECKER = 19, /* this and the next two are computed: no bytes, and a table alone */
  BS_TEXEL_BRICK = 20,
  BS_TEXEL_NOISE = 21,
  BS_TEXEL_DEPTH = 22
};

/* 8-bit RGBA, rows from the top; alpha 0 is clear and 255 opaque. A texture of another format has its texels
 * in `raw` and its `rgba` is not read; bs_scene_get gives both, the latter decoded. BS_TEXTURE_INIT has the
 * defaults. */
typedef struct bs_texture {
  size_t size;
  int32_t width, height; /* texels, 1 to 16384 */
  const uint8_t* rgba;
  size_t stride;          /* bytes from row to row; 0: 4 * width, the default */
  const char* name;       /* for messages; NULL: none, the default */
  bs_texel_format format; /* default BS_TEXEL_RGBA8888 */
  int32_t reserved;       /* 0 */
  const uint8_t* raw;   /* blocks row by row from the top left, without gaps; words have the low byte first */
  size_t raw_size;      /* bytes */
  const int16_t* table; /* palette: 256 times red, green, blue, alpha; YIQ: 16 of Y, 12 of I, 12 of Q;
                           computed: docs/numeric-spec.md, "procedural textures" */
  size_t table_size;    /* values: 0, 1024 or 40; 10, 14 or 11 */
} bs_texture;

#define BS_TEXTURE_INIT \
  { sizeof(bs_texture), 1, 1, NULL, 0, NULL, BS_TEXEL_RGBA8888, 0, NULL, 0, NULL, 0 }

/* What a picture is drawn with, except its triangles. BS_SCENE_DESC_INIT has the defaults. */
typedef struct bs_scene_desc {
  size_t size;
  int32_t width, height; /* of the picture and the viewport, pixels */
  double s_min, s_max;   /* range of the distances s; default 1 to 1000 */
  double focal;          /* pixels; default 500 */
  uint8_t background[3]; /* red, green, blue; default black */
  uint8_t has_fog;       /* 0 or 1; default 0 */
  uint8_t fog_color[3];
  uint8_t reserved;    /* 0 */
  double fog_distance; /* in the unit of s; default 1 */
  const bs_texture* textures;
  size_t texture_count;                    /* default 0 */
  const char* name;                        /* for messages; NULL: none, the default */
  int32_t has_projector;                   /* 0 or 1; default 0 */
  int32_t reserved_2;                      /* 0 */
  double projector_s_min, projector_s_max; /* range of the distances from it; default 1 to 1000 */
  /* A light, in the viewer's space: x to the right, y downward, z along the view axis. 0: none, the default;
   * 1: far away in the direction `light`, of any length; 2: at that point, in the unit of s. */
  int32_t light_kind;
  int32_t light_exponent; /* of the highlight, 1 to 200; default 32 */
  double light[3];        /* default 0, 0, -1: at the viewer */
  double light_ambient;   /* share of what reaches every surface, 0 to 1; default 0.2 */
  double light_specular;  /* share of the highlight, 0 to 1 with ambient; default 0 */
  /* k of the lunar law, 0 to 16, where light.law is lunar; default 0: the cosine alone. */
  double light_lunar;
  /* Where light.fall is first or second: all but the ambient share is divided by (d / reach)^a + offset. 0,
   * the default: brightness does not fall. In the unit of s, s_max 2^-16 to s_max 2^16; the offset is 0
   * to 64. */
  double light_reach, light_offset;
} bs_scene_desc;

#define BS_SCENE_DESC_INIT                                                                                  \
  {                                                                                                         \
    sizeof(bs_scene_desc), 640, 480, 1.0, 1000.0, 500.0, {0, 0, 0}, 0, {0, 0, 0}, 0, 1.0, NULL, 0, NULL, 0, \
        0, 1.0, 1000.0, 0, 32, {0.0, 0.0, -1.0}, 0.2, 0.0, 0.0, 0.0, 0.0                                    \
  }

/* A corner of a triangle. BS_VERTEX_INIT has the defaults. */
typedef struct bs_vertex {
  size_t size;
  double x, y;       /* pixels, origin top left, pixel centres at .5; -32767 to 32767 */
  double s;          /* distance along the view axis, s_min to s_max */
  double u, v;       /* texels, v downward; default 0 */
  double r, g, b, a; /* 0 to 1; default 1 */
  double fog;        /* factor of fog.mode = vertex, 0 to 1; default -1: it follows from s */
  /* In a scene with a projector: W is the distance along its axis, in the unit of s, and X / W and Y / W are
   * column and row of its texture, in texels. Default 0: outside of the texture. */
  double project_x, project_y, project_w;
  double z;      /* depth of depth.line = z, linear on the screen, 0 (nearest) to 1; default -1: that of s */
  double u2, v2; /* texels of the second texture unit, with texture.second = own; default 0 */
  /* In a scene with a light: the outward normal in the viewer's space, of any length up to 2; default 0:
   * ambient light alone. */
  double nx, ny, nz;
  /* With light.normal = map, where the second texture is a map of normals: where the light stands in its
   * field, column, row and height, in its texels; default 0. */
  double lx, ly, lz;
} bs_vertex;

#define BS_VERTEX_INIT                                                                                   \
  {                                                                                                      \
    sizeof(bs_vertex), 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, \
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0                                                                     \
  }

/* A light that casts shadows on a scene that the library reads. Its points are in the world of a mesh and of
 * the demo, and else as the viewer sees: x to the right, y downward, z along the view axis. BS_SHADOW_INIT
 * has the defaults. */
typedef struct bs_shadow {
  size_t size;
  double light[3];  /* where it stands */
  double at[3];     /* what it looks at, where has_at is 1 */
  int32_t has_at;   /* 0 or 1; 0, the default: the middle of the scene */
  int32_t map_size; /* texels of its depth buffer each way, 1 to 8192; default 1024 */
  double
      degrees; /* that it sees, below 160; 0, the default: the whole scene, as far as it is not beside it */
  double bias; /* how many texels a lit surface may rise towards the light per texel, 0 to 64; -1, the
                  default: each triangle as its slope asks for, with map codes of 16 bits */
  double dark; /* what is left of a colour in the shadow, 0 to 1; default 0.35 */
} bs_shadow;

#define BS_SHADOW_INIT \
  { sizeof(bs_shadow), {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0, 1024, 0.0, -1.0, 0.35 }

/* How bs_scene_load_with reads a scene. BS_SCENE_OPTIONS_INIT has the defaults. */
typedef struct bs_scene_options {
  size_t size;
  int32_t width, height;   /* of the picture; 0, the default: the stream's own, or 640x480 */
  int32_t frame;           /* image of a stream's dynamic textures, from 0; -1, the default: their first */
  int32_t reserved;        /* 0 */
  const bs_shadow* shadow; /* NULL, the default: no shadows */
} bs_scene_options;

#define BS_SCENE_OPTIONS_INIT \
  { sizeof(bs_scene_options), 0, 0, -1, 0, NULL }

/* A field of a stage's records: value = raw * 2^-fraction [unit]. */
typedef struct bs_field_info {
  size_t size;
  const char* name; /* both texts hold as long as the library is loaded */
  const char* unit; /* "" for an index, a count or a flag */
  int32_t word; /* bits of the register; 0 for an index, a count or a flag, whose raw value is the value */
  int32_t fraction;
  int32_t is_signed;
  int32_t reserved;
} bs_field_info;

/* An array in the library's memory: row i begins at (const char*)base + i * stride. */
typedef struct bs_view {
  size_t size;
  const void* base; /* NULL where there are no rows */
  size_t rows, columns;
  size_t stride;      /* bytes */
  bs_element element; /* of which each column has `channels` */
  int32_t channels;
} bs_view;

typedef int32_t bs_divergence_kind;
enum {
  BS_DIVERGENCE_NONE = 0,
  BS_DIVERGENCE_VALUE = 1, /* a field differs */
  BS_DIVERGENCE_EXTRA = 2  /* the model has no more records */
};

/* The first difference that bs_check found. */
typedef struct bs_divergence {
  size_t size;
  bs_divergence_kind kind;
  bs_stage stage;
  uint64_t record;      /* index among the records of the stage */
  int64_t triangle;     /* counted from bs_begin, as the record has it; -1 where it has none, as in x and y */
  int64_t x, y;         /* pixel, or first pixel of the row */
  uint64_t frame, draw; /* as given with the triangle; 0 where there is none */
  int32_t field;        /* index of the column; -1 for BS_DIVERGENCE_EXTRA */
  int32_t reserved;     /* 0 */
  const char* field_name;   /* holds as long as the library is loaded; NULL for BS_DIVERGENCE_EXTRA */
  int64_t expected, actual; /* raw, the model's and the caller's */
  double expected_value, actual_value; /* decoded; bs_field tells the unit */
  uint64_t differences;                /* values that differ in this call, of extra records all */
} bs_divergence;

/* ---- the library ---- */

BS_API uint32_t bs_abi_version(void);
BS_API const char* bs_version(void); /* "0.2.0" */
/* What the last failed call of this thread said: "file:line: key: what; expected ...". "" before the first
 * failure. The text holds until the thread's next failure. */
BS_API const char* bs_last_error(void);

/* The names by number, from 0; NULL behind the last one and for what is no number of one. */
BS_API const char* bs_stage_name(bs_stage stage); /* "setup", "setup.edge", "edge_walk" ... */
BS_API const char* bs_engine_name(int i);         /* "golden" ... "systemc" where its plug-in is there */
BS_API const char* bs_counter_name(int i);        /* "triangles", ... "cycles" */

/* ---- configurations ---- */

/* Reads a shipped configuration by name, or a TOML file. */
BS_API bs_status bs_config_load(const char* name_or_path, bs_config** out);
/* Reads a configuration from the text of a TOML file. */
BS_API bs_status bs_config_parse(const char* toml, bs_config** out);
/* Sets one key, such as "formats.span.uv.word" to "23" or "depth.code" to "linear". Rules between keys are
 * checked by bs_open, so that several keys can be set one after another. */
BS_API bs_status bs_config_set(bs_config* config, const char* path, const char* value);
/* 16 hexadecimal digits over all that determines results. The text holds until the configuration is set or
 * freed. NULL for a bad handle. */
BS_API const char* bs_config_hash(bs_config* config);
/* The canonical TOML text, which bs_config_parse reads back; as bs_config_hash otherwise. */
BS_API const char* bs_config_text(bs_config* config);
BS_API void bs_config_free(bs_config* config);

/* Describes field i of a stage's records, which is column i of bs_records. BS_BAD_INPUT behind the last. */
BS_API bs_status bs_field(bs_config* config, bs_stage stage, int i, bs_field_info* out);

/* ---- scenes that the library reads ---- */

/* Reads a scene: "demo", a triangle stream (.tri, .trib) or a mesh (OBJ, PLY, glTF ...), which a camera
 * around it shows. With "@3" behind the name it is what camera 3 sees. width and height are of the picture;
 * 0: the stream's own, or 640x480. */
BS_API bs_status bs_scene_load(const char* name_or_path, int32_t width, int32_t height, bs_scene** out);
/* The same, where the dynamic textures of a stream show image `frame`, from 0, instead of their first one. */
BS_API bs_status bs_scene_load_frame(const char* name_or_path, int32_t width, int32_t height, int32_t frame,
                                     bs_scene** out);
/* The same with options, which may be NULL. A scene with shadows has two passes, with commands between its
 * triangles: bs_draw_scene draws it. It needs project.unit = "reciprocal". docs/shadow.md. */
BS_API bs_status bs_scene_load_with(const char* name_or_path, const bs_scene_options* options,
                                    bs_scene** out);
/* Describes the scene for bs_begin. What it points to holds until the scene is freed. */
BS_API bs_status bs_scene_get(bs_scene* scene, bs_scene_desc* out);
/* Its triangles for bs_draw: 3 vertices and a texture each, as long as the scene is not freed. */
BS_API bs_status bs_scene_triangles(bs_scene* scene, const bs_vertex** vertices, const int32_t** textures,
                                    size_t* count);
/* What of a mesh file the scene does not show, such as points and lines: a line each, empty where nothing is
 * left out. The text holds until the scene is freed. NULL for a bad handle. */
BS_API const char* bs_scene_notes(bs_scene* scene);
BS_API void bs_scene_free(bs_scene* scene);

/* ---- models ---- */

/* Makes an engine for a configuration, which it copies:
 *   golden  the quantised golden, in floating point
 *   model   the pipeline in integers; equal to golden, bit for bit
 *   timed   the model with the clocks of the timed model (counter "cycles"); equal to golden, bit for bit
 *   ideal   the truth that errors are measured from; it has no records
 *   systemc the clocked timed model, from a plug-in; equal to golden, bit for bit
 *   rtl     the Verilated RTL, from a plug-in, compiled for each configuration and kept; equal to golden
 * BS_UNSUPPORTED where a plug-in is missing or comes from another build: docs/c_api.md, "Plug-ins". */
BS_API bs_status bs_open(bs_config* config, const char* engine, bs_model** out);
BS_API void bs_close(bs_model* model);

/* Whether records are kept (1, as after bs_open) or not (0: faster, where only the picture is wanted). Holds
 * for what is drawn from then on. */
BS_API bs_status bs_trace(bs_model* model, int32_t on);

/* Begins a picture: clears planes, records and counters. It copies the scene, textures included. After a
 * failure only bs_begin may follow. */
BS_API bs_status bs_begin(bs_model* model, const bs_scene_desc* scene);

/* Where memory runs out while one of these three draws, or a function of bs_stage_override refuses, the
 * picture is not whole, and only bs_begin may follow.
 *
 * Draws one triangle. texture: index of the scene's, -1 for none. frame and draw are the caller's numbers,
 * which a bs_divergence tells. Triangles count from 0 after bs_begin. */
BS_API bs_status bs_triangle(bs_model* model, const bs_vertex v[3], int32_t texture, uint64_t frame,
                             uint64_t draw);
/* Draws `count` triangles in order, with 3 vertices each: faster than one by one, and what gives `timed` the
 * clocks of a whole picture. textures: one per triangle; NULL: none. Nothing is drawn where one of them is
 * not legal. */
BS_API bs_status bs_draw(bs_model* model, const bs_vertex* vertices, const int32_t* textures, size_t count,
                         uint64_t frame, uint64_t draw);

/* Changes the draw state, clears planes, takes another target or view, or copies a plane to a texture, for
 * what is drawn from then on: the line of a triangle stream, such as {"state": {"depth.func": "lequal"}},
 * {"clear": {"depth": true}}, {"target": 1}, {"view": {"width": 256}} or {"copy": {"target": 1,
 * "plane": "color", "texture": 0}}. Each target has its own view, whose size its planes have. Where a view
 * does not fit the configuration, only bs_begin may follow. docs/formats.md, "Draw state", has the registers.
 * After bs_begin each holds what the configuration says, and target 0 is drawn on; bs_frame_view shows the
 * target drawn on. */
BS_API bs_status bs_command(bs_model* model, const char* json);
/* Draws `count` triangles of a scene from `first` on as bs_draw does, with the commands in front of them, and
 * those behind the last one where it is among them. The scene is the one that bs_begin was given. */
BS_API bs_status bs_draw_scene(bs_model* model, bs_scene* scene, size_t first, size_t count, uint64_t frame,
                               uint64_t draw);

/* Draws one row that was made elsewhere, from behind its stage through merge; engines golden and model. The
 * record has the n columns that bs_field tells of its stage:
 *   BS_STAGE_EDGE_WALK       goes through span_setup
 *   BS_STAGE_PLANE_WALK_ROW  the same in const_depth_rows
 *   BS_STAGE_SPAN_SETUP      goes through span
 *   BS_STAGE_SETUP           in const_depth_rows: draws nothing; the rows that follow are this triangle's, up
 *                            to the next bs_begin, bs_triangle or bs_draw
 * Registers may have every value of their formats. The pixels must lie inside the picture; those of a row of
 * constant depth must be a row of its triangle. The record of the row counts as one of its stage. */
BS_API bs_status bs_row(bs_model* model, bs_stage stage, const int64_t* record, size_t n, int32_t texture);

/* The records of a stage since bs_begin or bs_clear_records, in the order of delivery: one row per record,
 * BS_I64, one column per field. The view holds until the model's next call that draws, begins, clears or
 * closes. BS_BAD_ORDER where tracing was off for something drawn. */
BS_API bs_status bs_records(bs_model* model, bs_stage stage, bs_view* out);
/* Forgets the records, so that a long run takes no more memory. Checks go on with the records to come. */
BS_API bs_status bs_clear_records(bs_model* model);

/* A plane of the picture; the view holds as that of bs_records. */
BS_API bs_status bs_frame_view(bs_model* model, bs_plane plane, bs_view* out);

/* A counter by name since bs_begin. "cycles" counts with the engine timed, and is 0 with the others. */
BS_API bs_status bs_counter(bs_model* model, const char* name, int64_t* out);

/* Compares n records of the caller with the stage's next n records, which those of the calls before came in
 * front of. The columns are those of bs_records, without gaps. Returns BS_DIFFERENT where they differ, and
 * the first difference in *first, which may be NULL. */
BS_API bs_status bs_check(bs_model* model, bs_stage stage, const int64_t* dut, size_t n,
                          bs_divergence* first);
/* Counts of bs_check since bs_open, over all stages. A bench must fail where either of the first two is zero.
 *   matched     values that were equal
 *   nontrivial  those of them that are neither 0 nor the same field's value in the record before
 *   unchecked   records of the stage that are kept, and that no bs_check has reached
 * 0 for a bad handle. */
BS_API uint64_t bs_matched(bs_model* model);
BS_API uint64_t bs_nontrivial(bs_model* model);
BS_API uint64_t bs_unchecked(bs_model* model, bs_stage stage);

/* A stage of the caller's. `in` is the record that feeds the stage, the first one where several do: constants
 * for setup, setup for its edges, the edge on the left for edge_walk, plane_walk for its rows, the row for
 * span_setup, span_setup for span, span for depth, texture and fog, depth for merge. `out` is what the
 * model's stage made of it. The function may change every register within its format, and the flags
 * `covered`, `pass` and `killed`. It returns 0; any other value ends the call that draws with BS_BAD_INPUT.
 */
typedef int32_t (*bs_stage_fn)(void* user, const int64_t* in, size_t n_in, int64_t* out, size_t n_out);
/* Puts the function behind a stage of the engine model from the next bs_begin on; NULL takes it away. Every
 * record behind it follows from what it made. Such a run is not checked by golden: bs_run_text says so. */
BS_API bs_status bs_stage_override(bs_model* model, bs_stage stage, bs_stage_fn function, void* user);

/* What the records since bs_begin are: "engine model, configuration depth16 (c18c9815f835a626)", and behind
 * it
 * ", overridden stages: span; not checked by golden" where that is so. Holds until the next call of this
 * function. NULL for a bad handle. */
BS_API const char* bs_run_text(bs_model* model);

#ifdef __cplusplus
}
#endif

#endif
