#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a real height field as the lines of a floating horizon, and by a Y-buffer, in a parallel projection.

    examples/pictures/horizon.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/oracle-horizon.png and FOLDER/oracle-ybuffer.png.
"""

import sys

from drawing import Drawing, elevations, make


def draw(drawing: Drawing) -> None:
    config = drawing.config("parallel", ("[depth]", '[depth]\nline = "z"'))
    mesh = drawing.scratch / "field.obj"
    drawing.run("make", "terrain", elevations(), "--every", "2", "--vertical", "0.018", "--shade", "-o", mesh)
    for name in ("horizon", "ybuffer"):
        drawing.render(f"oracle-{name}", mesh, "--projection", "orthographic", "--size", "480x320", "--yaw", "25", "--pitch", "18",
                       "--distance", "270", "--unlit", "--no-cull", "--engine", f"oracle:{name}", config=config)


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
