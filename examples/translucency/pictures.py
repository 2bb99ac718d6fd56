#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow of glass between two panes that cut it and each other, in the order of the file and by passes, and two teapots.

    examples/translucency/pictures.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/translucency-NAME.png. The mesh is made in a folder that is removed again.
"""

import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPOT = ROOT / "tests/data/spot.obj"
TEAPOT = ROOT / "tests/data/teapot.bez"
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


def teapots(bitspan: str, scratch: pathlib.Path) -> str:
    """Two teapots of glass, one behind the other."""
    patches = scratch / "patches.obj"
    subprocess.run([bitspan, "make", "patches", str(TEAPOT), "-o", str(patches)], check=True, stdout=subprocess.DEVNULL)
    lines = patches.read_text().splitlines()
    points = [[float(part) for part in line.split()[1:]] for line in lines if line.startswith("v ")]
    faces = [[int(part) for part in line.split()[1:]] for line in lines if line.startswith("f ")]
    out = ["mtllib glass.mtl"]
    for number, (name, across, behind) in enumerate((("blue", 1.6, -2.6), ("glass", -1.2, 1.2))):
        out += [f"v {x + across} {y} {z + behind}" for x, y, z in points]
        out.append(f"usemtl {name}")
        out += ["f " + " ".join(str(i + number * len(points)) for i in face) for face in faces]
    return "\n".join([*out, ""])


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    bitspan, config, out = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as scratch:
        obj = pathlib.Path(scratch) / "glass.obj"
        obj.write_text(mesh())
        obj.with_suffix(".mtl").write_text("".join(f"newmtl {name}\nKd {r} {g} {b}\nd {alpha}\n"
                                                   for name, ((r, g, b), alpha) in MATERIALS.items()))
        def draw(name: str, scene: pathlib.Path, *flags: str) -> None:
            subprocess.run([bitspan, "render", str(scene), "--config", config, "--size", SIZE, "--no-cull", *flags,
                            "-o", str(out / f"translucency-{name}.png")], check=True, stdout=subprocess.DEVNULL)

        for name in ("order", "passes"):
            draw(name, obj, "--distance", "3.2", "--light=2,3,-3,0.6,0.2,32", "--translucency", name)
        obj.write_text(teapots(bitspan, pathlib.Path(scratch)))
        for name in ("order", "passes"):
            draw(f"teapots-{name}", obj, "--yaw", "20", "--distance", "13", "--light=-4,9,9,0.6,0.25,32", "--translucency", name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
