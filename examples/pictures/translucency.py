#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow of glass between two panes that cut it and each other, in the order of the file and by passes, and two teapots.

    examples/pictures/translucency.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/translucency-NAME.png. The mesh is made in a folder that is removed again.
"""

import sys

from drawing import DATA, Drawing, make

SPOT = DATA / "spot.obj"
TEAPOT = DATA / "teapot.bez"
SIZE = "480x360"
PANES = {"red": [(-0.9, -0.8, -0.7), (0.9, -0.8, 0.7), (0.9, 1.0, 0.7), (-0.9, 1.0, -0.7)],
         "blue": [(-0.9, -0.8, 0.5), (0.9, -0.8, -0.5), (0.9, 1.0, -0.5), (-0.9, 1.0, 0.5)]}
MATERIALS = {"glass": ((0.8, 1, 0.85), 0.55), "red": ((1, 0.35, 0.25), 0.6), "blue": ((0.3, 0.5, 1), 0.6)}


def mesh() -> str:
    """The cow without its texture, and the panes in front of it in the file."""
    cow = [line for line in SPOT.read_text().splitlines() if line.startswith(("v ", "f "))]
    points = sum(line.startswith("v ") for line in cow)
    panes: list[str] = []
    for name, corners in PANES.items():
        panes += [f"v {x} {y} {z}" for x, y, z in corners]
        panes += [f"usemtl {name}", f"f {points + 1} {points + 2} {points + 3} {points + 4}"]
        points += len(corners)
    vertices = [line for line in cow if line.startswith("v ")]
    faces = ["f " + " ".join(corner.split("/")[0] for corner in line.split()[1:]) for line in cow if line.startswith("f ")]
    return "\n".join(["mtllib glass.mtl", *vertices, *panes, "usemtl glass", *faces, ""])


def teapots(drawing: Drawing) -> str:
    """Two teapots of glass, one behind the other."""
    patches = drawing.scratch / "patches.obj"
    drawing.run("make", "patches", TEAPOT, "-o", patches)
    lines = patches.read_text().splitlines()
    points = [[float(part) for part in line.split()[1:]] for line in lines if line.startswith("v ")]
    faces = [[int(part) for part in line.split()[1:]] for line in lines if line.startswith("f ")]
    out = ["mtllib glass.mtl"]
    for number, (name, across, behind) in enumerate((("blue", 1.6, -2.6), ("glass", -1.2, 1.2))):
        out += [f"v {x + across} {y} {z + behind}" for x, y, z in points]
        out.append(f"usemtl {name}")
        out += ["f " + " ".join(str(i + number * len(points)) for i in face) for face in faces]
    return "\n".join([*out, ""])


def draw(drawing: Drawing) -> None:
    obj = drawing.scratch / "glass.obj"
    obj.with_suffix(".mtl").write_text("".join(f"newmtl {name}\nKd {r} {g} {b}\nd {alpha}\n"
                                               for name, ((r, g, b), alpha) in MATERIALS.items()))

    def both_ways(name: str, text: str, *flags: str) -> None:
        obj.write_text(text)
        for how in ("order", "passes"):
            drawing.render(f"translucency-{name}{how}", obj, "--size", SIZE, "--no-cull", *flags, "--translucency", how)

    both_ways("", mesh(), "--distance", "3.2", "--light=2,3,-3,0.6,0.2,32")
    both_ways("teapots-", teapots(drawing), "--yaw", "20", "--distance", "13", "--light=-4,9,9,0.6,0.25,32")


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
