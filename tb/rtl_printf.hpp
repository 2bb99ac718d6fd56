// SPDX-License-Identifier: Apache-2.0
// Included in front of Verilator's runtime, which is compiled with VL_PRINTF as this: what a simulation
// prints goes to the harness, not to the program's output.
#pragma once

extern "C" int bitspan_rtl_printf(const char* format, ...);
