#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw the teapot as a wire frame: without its hidden lines, and all lines with a fog to black.

    examples/pictures/lines.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/lines-hidden.png and FOLDER/lines-fog.png.
"""

import sys

from drawing import DATA, Drawing, make

VIEW = ("--size", "400x280", "--yaw", "25", "--pitch", "25", "--patch-depth", "2", "--unlit")


def draw(drawing: Drawing) -> None:
    config = drawing.config("lines", ('mode = "table"', 'mode = "linear"'), ("[fog]", '[line]\nwalk = "exact"\n\n[fog]'))
    for name, flags in {"hidden": ("--wireframe", "hidden"),
                        "fog": ("--wireframe", "all", "--no-cull", "--fog", "0,0,0,20")}.items():
        drawing.render(f"lines-{name}", DATA / "teapot.bez", *VIEW, *flags, config=config)


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
