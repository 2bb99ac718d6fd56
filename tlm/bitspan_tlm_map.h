/* SPDX-License-Identifier: Apache-2.0 */
/* The registers and the command list of bitspan's TLM-2.0 device, for its driver: C11, and clean as C++.
 *
 * docs/tlm.md says what each register and each command does. Everything is little-endian. A struct below is
 * the bytes of a command in memory, for hosts and processors that are little-endian too. Numbers are only
 * added, and never change; BS_TLM_LIST_VERSION grows where a list of today would be read in another way.
 */
#ifndef BITSPAN_TLM_MAP_H
#define BITSPAN_TLM_MAP_H

#include <stdint.h>

/* Offsets of the registers, 32 bits each. */
enum {
  BS_TLM_ID = 0x00,
  BS_TLM_VERSION = 0x04,
  BS_TLM_CTRL = 0x08,
  BS_TLM_STATUS = 0x0c,
  BS_TLM_IRQ = 0x10,
  BS_TLM_IRQ_MASK = 0x14,
  BS_TLM_ERROR = 0x18,
  BS_TLM_FRAMES = 0x1c,
  BS_TLM_CMD_BASE = 0x20, /* the low word; the high word is 4 behind it, as in the other pairs */
  BS_TLM_CMD_BASE_HIGH = 0x24,
  BS_TLM_CMD_SIZE = 0x28,
  BS_TLM_FB_STRIDE = 0x2c,
  BS_TLM_FB_BASE = 0x30,
  BS_TLM_FB_BASE_HIGH = 0x34,
  BS_TLM_Z_BASE = 0x38,
  BS_TLM_Z_BASE_HIGH = 0x3c,
  BS_TLM_Z_STRIDE = 0x40,
  BS_TLM_CYCLES = 0x44,
  BS_TLM_CYCLES_HIGH = 0x48,
  BS_TLM_ERROR_ADDRESS = 0x4c,
  BS_TLM_ERROR_ADDRESS_HIGH = 0x50,
  BS_TLM_MAP_SIZE = 0x54 /* bytes; no register */
};

enum {
  BS_TLM_ID_VALUE = 0x4e505342, /* "BSPN" */
  BS_TLM_LIST_VERSION = 1       /* VERSION, and what a list's begin must say */
};

/* Bits. */
enum { BS_TLM_CTRL_START = 1, BS_TLM_CTRL_RESET = 2 };
enum { BS_TLM_STATUS_BUSY = 1, BS_TLM_STATUS_DONE = 2, BS_TLM_STATUS_ERROR = 4 };
enum { BS_TLM_IRQ_DONE = 1, BS_TLM_IRQ_ERROR = 2 };

/* What ERROR says. */
enum {
  BS_TLM_NO_ERROR = 0,
  BS_TLM_BAD_OPCODE = 1,  /* the command has an opcode that is none */
  BS_TLM_BAD_SIZE = 2,    /* its size is not that of its opcode */
  BS_TLM_BAD_ORDER = 3,   /* another command must come before it, or none of its kind may come here */
  BS_TLM_BAD_VERSION = 4, /* begin has another version */
  BS_TLM_BAD_VALUE = 5,   /* a value of it is not legal; Device::error_text says which */
  BS_TLM_NO_END = 6,      /* the list is over without end */
  BS_TLM_BAD_BASE = 7,    /* a base or stride in a register is not legal for this picture */
  BS_TLM_BUS_ERROR = 8,   /* a transfer's response was not TLM_OK_RESPONSE */
  BS_TLM_NO_MEMORY = 9,   /* the host has no memory for the scene */
  BS_TLM_INTERNAL = 10    /* a fault of the library */
};

/* Opcodes. */
enum { BS_TLM_BEGIN = 1, BS_TLM_TEXTURE = 2, BS_TLM_TRIANGLE = 3, BS_TLM_DRAW = 4, BS_TLM_END = 5 };

/* Each command begins with this; draw and end are nothing else. */
typedef struct bs_tlm_command {
  uint32_t opcode;
  uint32_t size; /* bytes of the command, this included */
} bs_tlm_command;

/* The picture and the viewport: bs_scene_desc of bitspan.h. */
typedef struct bs_tlm_begin {
  bs_tlm_command command;
  uint32_t version;
  int32_t width, height;
  uint32_t has_fog;                    /* 0 or 1 */
  uint8_t background[4], fog_color[4]; /* red, green, blue, 0 */
  double s_min, s_max, focal, fog_distance;
} bs_tlm_begin;

/* The next texture of the scene, counted from 0: RGBA in memory, rows from the top. */
typedef struct bs_tlm_texture {
  bs_tlm_command command;
  int32_t width, height;
  uint64_t address;
  uint32_t stride;   /* bytes from row to row; 0: 4 * width */
  uint32_t reserved; /* 0 */
} bs_tlm_texture;

typedef struct bs_tlm_vertex {
  double x, y, s, u, v, r, g, b, a; /* bs_vertex of bitspan.h */
} bs_tlm_vertex;

typedef struct bs_tlm_triangle {
  bs_tlm_command command;
  int32_t texture;   /* -1: none */
  uint32_t reserved; /* 0 */
  bs_tlm_vertex vertices[3];
} bs_tlm_triangle;

#endif
