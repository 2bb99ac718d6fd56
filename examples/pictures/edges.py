#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a room of convex bodies, and a cow, as their visible edges.

    examples/pictures/edges.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/edges-NAME.png.
"""

import sys

from drawing import DATA, Drawing, make

SIZE = ("--size", "480x360")
ROOM = (DATA / "bodies.obj", *SIZE, "--yaw", "35", "--pitch", "22", "--distance", "17")
EDGES = ("--engine", "oracle:roberts")


def draw(drawing: Drawing) -> None:
    drawing.render("edges-room", *ROOM)
    drawing.render("edges-room-lines", *ROOM, *EDGES)
    drawing.render("edges-spot-lines", DATA / "spot.obj", *SIZE, *EDGES)


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
