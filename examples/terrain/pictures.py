#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a real height field on a grid, by ranks, in rings, and as Voronoi's cells.

    examples/terrain/pictures.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/terrain-NAME.png. The height field is the sample data `jacksboro_fault_dem.npz` of Matplotlib: 344 x 403
elevations in metres, some 90 m apart.
"""

import pathlib
import subprocess
import sys
import tempfile

import matplotlib.cbook


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    bitspan, base, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    field = matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)
    with tempfile.TemporaryDirectory() as scratch_name:
        scratch = pathlib.Path(scratch_name)
        # Each face has one brightness, so that triangles show.
        config = scratch / "faces.toml"
        config.write_text(base.read_text().replace("[fog]", '[light]\nat = "face"\n\n[fog]', 1))

        def draw(name: str, *command: str, mesh: str = "mesh.obj", camera: tuple[str, ...] = ()) -> None:
            subprocess.run([bitspan, "make", command[0], field, *command[1:], "-o", str(scratch / "mesh.obj"), "--vertical", "0.03"],
                           check=True, stdout=subprocess.DEVNULL)
            seen = camera or ("--pitch", "42", "--distance", "330", "--light=-300,260,-80,0.15,0,1")
            subprocess.run([bitspan, "render", str(scratch / mesh), "--config", str(config), "--size", "480x320", "--yaw", "20",
                            *seen, "-o", str(out / f"terrain-{name}.png")], check=True, stdout=subprocess.DEVNULL)

        draw("grid", "terrain")
        draw("lod", "lod", "--keep", "0.1")
        draw("rings", "terrain", "--rings", "0,0,20")
        draw("voronoi", "delaunay", "--points", "800", "--shade", "--voronoi", str(scratch / "cells.obj"), mesh="cells.obj",
             camera=("--pitch", "80", "--distance", "520", "--unlit"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
