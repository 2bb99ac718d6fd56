#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw quadric bodies with the shadow of a light, and what rays find of the same bodies with few steps.

    examples/pictures/quadrics.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/quadrics.png and FOLDER/quadrics-rays.png. The scene with few steps and the maps of
its oracles are made in a folder that is removed again.
"""

import re
import shutil
import sys

from drawing import DATA, Drawing, make

SOLIDS = DATA / "solids.quad"
VIEW = ("--size", "480x360", "--yaw", "20", "--pitch", "28", "--distance", "12", "--light=-6,9,5")
SHADOW = ("--shadow=-6,9,5", "--shadow-map", "1024")


def draw(drawing: Drawing) -> None:
    drawing.render("quadrics", SOLIDS, *VIEW, *SHADOW, config=drawing.with_keys("project", '[project]\nunit = "reciprocal"'))
    coarse = drawing.scratch / "coarse.quad"
    coarse.write_text(re.sub(r"(?m)^steps = \d+", "steps = 14", SOLIDS.read_text()))
    drawing.run("verify", coarse, "--config", drawing.base, *VIEW, "--engines", "golden,model", "--oracles", "ray",
                "--oracle-maps", drawing.scratch)
    [rays] = drawing.scratch.glob("*ray_quadrics.png")
    shutil.copy(rays, drawing.out / "quadrics-rays.png")


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
