#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a brick wall with a relief, under a light that goes round it.

    examples/pictures/relief.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/relief-NAME.png. The wall, its bricks and its normals are made in a folder that is removed again.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402 (the backend comes first)
import numpy as np  # noqa: E402

from drawing import Drawing, make  # noqa: E402

SIZE = 256  # texels
BRICK = (64, 32)  # with its mortar
MORTAR, EDGE = 3, 4  # half the width of the mortar, and of the slope beside it
LIGHTS = {"left": "-1.6,0.2,0.7", "above": "0,1.7,0.7", "right": "1.6,0.2,0.7"}

# A wall of 2 x 2, seen from +z.
WALL = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n"
KEYS = '[light]\nat = "pixel"\nsource = "point"\nnormal = "map"'


def heights() -> np.ndarray:
    """Texels above the mortar: bricks with slopes at their edges, and some grain."""
    row, column = np.mgrid[0:SIZE, 0:SIZE] + 0.5
    shifted = column + BRICK[0] / 2 * (row // BRICK[1] % 2)
    across = np.minimum(shifted % BRICK[0], BRICK[0] - shifted % BRICK[0])
    down = np.minimum(row % BRICK[1], BRICK[1] - row % BRICK[1])
    flat = np.clip((np.minimum(across, down) - MORTAR) / EDGE, 0, 1)
    grain = np.random.default_rng(15).normal(size=(SIZE, SIZE))
    for axis in (0, 1, 0, 1):
        grain = (np.roll(grain, 1, axis) + grain + np.roll(grain, -1, axis)) / 3
    return 4 * flat + 1.5 * grain


def draw(drawing: Drawing) -> None:
    high = heights()
    slopes = [(np.roll(high, -1, axis) - np.roll(high, 1, axis)) / 2 for axis in (1, 0)]
    normal = np.dstack([-slopes[0], -slopes[1], np.ones_like(high)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    brick = np.clip((high - 0.5) / 2, 0, 1)[..., None]
    color = brick * np.array([0.75, 0.36, 0.24]) + (1 - brick) * np.array([0.72, 0.7, 0.66])
    config = drawing.config("relief", ("[fog]", KEYS + "\n\n[fog]"), ("wrap = ", 'second = "own"\nwrap = '))
    wall, normals, bricks = (drawing.scratch / name for name in ("wall.obj", "normals.png", "bricks.png"))
    wall.write_text(WALL)
    matplotlib.image.imsave(normals, np.rint(255 * (normal + 1) / 2).astype(np.uint8))
    matplotlib.image.imsave(bricks, np.rint(255 * color).astype(np.uint8))
    for name, place in LIGHTS.items():
        drawing.render(f"relief-{name}", wall, "--size", "320x240", "--texture", bricks, "--relief", normals, f"--light={place},0.15,0,1",
                       "--yaw", "20", "--pitch", "12", "--distance", "2.9", config=config)


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
