// SPDX-License-Identifier: Apache-2.0
// The header of a driver compiles as C11, and its structs have no gaps.
#include <bitspan/bitspan_tlm_map.h>

_Static_assert(sizeof(bs_tlm_begin) == 64, "begin");
_Static_assert(sizeof(bs_tlm_texture) == 32, "texture");
_Static_assert(sizeof(bs_tlm_triangle) == 232, "triangle");
