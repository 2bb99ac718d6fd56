#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the VPI module and the bench in the folder that it is called in, and runs the bench. PREFIX is where bitspan is
# installed.
set -e
here=$(cd "$(dirname "$0")" && pwd)
dv=$PREFIX/share/bitspan/dv
g++ -std=c++17 -O1 -shared -fPIC -I"$PREFIX/include" $(iverilog-vpi --cflags | grep -o -e '-I[^ ]*') \
  "$dv/vpi/bitspan_vpi.cpp" -L"$PREFIX/lib" -lbitspan -Wl,-rpath,"$PREFIX/lib" -o bitspan.vpi
test -d near || "$PREFIX/bin/bitspan" config emit-sv depth16 --part interpolator --prefix near_ --rtl near
test -d far || "$PREFIX/bin/bitspan" config emit-sv depth20 --part interpolator --prefix far_ --rtl far
iverilog -g2012 -s acme_spi_tb -L. -m bitspan -o acme_spi_tb.vvp \
  $(sed 's|^|near/|' near/near_bitspan.f) $(sed 's|^|far/|' far/far_bitspan.f) \
  "$dv/vpi/bitspan_checker.sv" "$here/../dpi/acme_spi.sv" "$here/acme_spi_tb.sv" 2>iverilog.log
exec vvp -n -M. acme_spi_tb.vvp "$@"
