#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a real height field on a grid, by ranks, in rings, and as Voronoi's cells.

    examples/pictures/terrain.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/terrain-NAME.png.
"""

import sys

from drawing import Drawing, elevations, make

SEEN = ("--pitch", "42", "--distance", "330", "--light=-300,260,-80,0.15,0,1")


def draw(drawing: Drawing) -> None:
    # Each face has one brightness, so that triangles show.
    config = drawing.with_keys("faces", '[light]\nat = "face"')

    def terrain(name: str, *command: object, mesh: str = "mesh.obj", camera: tuple[str, ...] = SEEN) -> None:
        drawing.run("make", command[0], elevations(), *command[1:], "-o", drawing.scratch / "mesh.obj", "--vertical", "0.03")
        drawing.render(f"terrain-{name}", drawing.scratch / mesh, "--size", "480x320", "--yaw", "20", *camera, config=config)

    terrain("grid", "terrain")
    terrain("lod", "lod", "--keep", "0.1")
    terrain("rings", "terrain", "--rings", "0,0,20")
    terrain("voronoi", "delaunay", "--points", "800", "--shade", "--voronoi", drawing.scratch / "cells.obj", mesh="cells.obj",
            camera=("--pitch", "80", "--distance", "520", "--unlit"))


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
