#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Map the ties of the cow with fewer and fewer bits of depth.

    examples/pictures/ties.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/ties-BITS.png for some of them, and prints how many pixels are ties. Both sides of all faces are drawn, and the codes reach
from 0.03 to 30, of which the cow takes a part.
"""

import json
import shutil
import sys

from drawing import DATA, Drawing, make

BITS = (20, 16, 12, 8)
SHOWN = (20, 12, 8)
SCENE = ("--size", "320x240", "--no-cull", "--near", "0.03", "--far", "30")


def draw(drawing: Drawing) -> None:
    maps, verdict = drawing.scratch / "maps", drawing.scratch / "verdict.json"
    for bits in BITS:
        drawing.run("verify", DATA / "spot.obj", "--config", drawing.config(f"bits{bits}", ("\nbits = 20", f"\nbits = {bits}")), *SCENE,
                    "--engines", "golden,model", "--oracles", "scanline", "--oracle-maps", maps, "--json", verdict)
        [found] = json.loads(verdict.read_text())["scenes"][0]["oracles"]
        equal, ties = found["equal"], found["ties"]
        print(f"| {bits} | {ties:,} | {100 * ties / (equal + ties):.2g} % |")
        [mapped] = maps.glob("*scanline.png")
        if bits in SHOWN:
            shutil.copy(mapped, drawing.out / f"ties-{bits}.png")


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
