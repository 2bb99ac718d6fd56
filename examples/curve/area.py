#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show what guard bits of forward_difference cost in an ECP5.

    examples/curve/area.py BITSPAN CONFIG FRACTION...

synthesises rtl/forward_difference.sv with the registers of CONFIG, a TOML file, whose fraction bits are each of those, and
prints a table. Yosys is on PATH.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

INTEGER = 13  # bits, the sign included
CELLS = {"LUT4": "LUTs", "L6MUX21": "muxes of four LUTs", "CCU2C": "carries", "TRELLIS_FF": "flip-flops"}


def with_fraction(text: str, fraction: int) -> str:
    """The configuration with so many fraction bits in curve.d0; the other three registers are as that one."""
    curve = f'"curve.d0" = {{ signed = true, word = {INTEGER + fraction}, int = {INTEGER}, round = "SC_RND", overflow = "SC_SAT" }}'
    return text.replace("[formats]\n", f"[formats]\n{curve}\n", 1)


def cells(bitspan: str, config: Path, folder: Path) -> dict[str, int]:
    subprocess.run([bitspan, "config", "emit-sv", config, "--part", "curve", "--rtl", folder / "rtl"], check=True,
                   stdout=subprocess.DEVNULL)
    files = " ".join(f"rtl/{name}" for name in (folder / "rtl/bitspan.f").read_text().split("\n") if name.endswith(".sv"))
    (folder / "area.ys").write_text(f"read_verilog -sv -DSYNTHESIS {files}\nhierarchy -top forward_difference\n"
                                    "synth_ecp5 -top forward_difference\ntee -q -o stat.json stat -json\n")
    subprocess.run(["yosys", "-q", "-s", "area.ys"], cwd=folder, check=True)
    text = (folder / "stat.json").read_text()
    found = json.loads(text[text.index("{"):])["design"]["num_cells_by_type"]
    return {what: found.get(cell, 0) for cell, what in CELLS.items()}


def main() -> None:
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    bitspan, base = sys.argv[1], Path(sys.argv[2]).read_text()
    print("| fraction bits | " + " | ".join(CELLS.values()) + " |\n|---|" + "---:|" * len(CELLS))
    for fraction in map(int, sys.argv[3:]):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "config.toml").write_text(with_fraction(base, fraction))
            found = cells(bitspan, folder / "config.toml", folder)
            print(f"| {fraction} | " + " | ".join(str(found[what]) for what in CELLS.values()) + " |", flush=True)


if __name__ == "__main__":
    main()
