#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Cells of the span interpolator of one configuration, as Yosys makes them.
#
#   tb/yosys_cells.sh PACKAGE.sv [generic|ice40|check]
#
# PACKAGE.sv is the output of `bitspan config emit-sv`. generic: Yosys's own gates and flip-flops; ice40: LUT4s,
# carries, block RAMs of a Lattice iCE40; check: reads and checks the design, no synthesis.
set -eu
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
package=$1
target=${2:-generic}
root=${BITSPAN_ROOT:-$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)}
command -v yosys >/dev/null || { echo "yosys_cells.sh: yosys is not on PATH" >&2; exit 2; }
[ -r "$package" ] || { echo "yosys_cells.sh: $package cannot be read" >&2; exit 2; }

sources=
while read -r name; do sources="$sources $root/rtl/$name"; done <"$root/rtl/span_interpolator.f"
read="read_verilog -sv -DSYNTHESIS $package $sources; hierarchy -check -top span_interpolator"
case $target in
  check) exec yosys -q -p "$read; proc; check -assert" ;;
  generic) synth="synth -flatten -top span_interpolator; check -assert; stat" ;;
  ice40) synth="synth_ice40 -top span_interpolator; check -assert; stat" ;;
  *) echo "yosys_cells.sh: '$target' is no target; legal: generic, ice40, check" >&2; exit 2 ;;
esac
log=$(mktemp)
trap 'rm -f "$log"' EXIT
yosys -q -p "$read; tee -o $log $synth" >/dev/null 2>&1 || { echo "yosys_cells.sh: yosys refused the design" >&2; tail -5 "$log" >&2; exit 1; }
# The last statistics, without what else Yosys has to say.
sed -n '/=== span_interpolator/,/Executing\|^Warning/p' "$log" | sed '/Executing/d; /^Warning/d'
