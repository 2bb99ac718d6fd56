#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds and runs the bench in the folder that it is called in. PREFIX is where bitspan is installed.
set -e
here=$(cd "$(dirname "$0")" && pwd)
bench="$here/acme_spi.sv $here/acme_spi_tb.sv"
dv=$PREFIX/share/bitspan/dv
test -d near || "$PREFIX/bin/bitspan" config emit-sv depth16 --part interpolator --prefix near_ --rtl near
test -d far || "$PREFIX/bin/bitspan" config emit-sv depth20 --part interpolator --prefix far_ --rtl far
verilator --binary --assert -fno-const-bit-op-tree -j 2 --top-module acme_spi_tb \
  -CFLAGS "-std=c++17 -O1 -I$PREFIX/include" -LDFLAGS "-L$PREFIX/lib -lbitspan -Wl,-rpath,$PREFIX/lib" \
  "$dv/dpi/bitspan_pkg.sv" "$dv/dpi/bitspan_checker.sv" -F near/near_bitspan.f -F far/far_bitspan.f $bench \
  "$dv/dpi/bitspan_dpi.cpp"
exec obj_dir/Vacme_spi_tb "$@"
