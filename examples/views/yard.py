#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write a yard at the edge of a plain as a triangle stream of 320x240 pixels.

    examples/views/yard.py FOLDER [SEED]

writes FOLDER/yard.tri and its texture FOLDER/stones.png, always the same for one seed (1 where none is given). A meter is 16
texels. The yard has what makes widths hard to choose: a floor to the horizon, power lines thinner than a pixel, a fence, four
closed meshes, and decals 4 mm in front of a wall and above the floor. s_max is 2,000 times s_min.
"""

import json
import pathlib
import sys

import matplotlib.image
import numpy

WIDTH, HEIGHT, FOCAL = 320, 240, 280
S_MIN, S_MAX = 0.5, 1000
EYE, PITCH = numpy.array([0, 1.7, 0]), numpy.radians(6)  # meters, y is up and z forward; looks down
TEXELS = 16  # per meter
SKY = [0.62, 0.74, 0.86]
SPOT = pathlib.Path(__file__).resolve().parent.parent.parent / "tests/data/spot.obj"


def stones(random: numpy.random.Generator, size: int = 64, count: int = 40) -> numpy.ndarray:
    """Cobbles that repeat: each texel takes the grey of its nearest centre, and is dark where two are as near."""
    centres = random.uniform(0, size, (count, 2))
    texels = numpy.stack(numpy.meshgrid(numpy.arange(size), numpy.arange(size)), axis=-1) + 0.5
    apart = numpy.abs(texels[:, :, None] - centres)
    distances = numpy.linalg.norm(numpy.minimum(apart, size - apart), axis=-1)
    near = numpy.sort(distances, axis=-1)
    grey = random.uniform(0.6, 1, count)[distances.argmin(axis=-1)] * numpy.where(near[:, :, 1] - near[:, :, 0] < 1.5, 0.5, 1)
    return numpy.round(255 * grey[:, :, None] * [1, 0.97, 0.92]).astype(numpy.uint8)


def surface(points: numpy.ndarray, texels: numpy.ndarray, color: list) -> tuple:
    """The triangles of a grid of points (n, m, 3) with texels (n, m, 2): arrays (k, 3, 5), and their color."""
    grid = numpy.concatenate([points, texels], axis=-1)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return numpy.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 5), color


def rectangle(corner: list, along: list, up: list, color: list, cells: tuple = (1, 1)) -> tuple:
    """A rectangle of cells between a corner and two sides."""
    i, j = (numpy.linspace(0, 1, n + 1) for n in cells)
    share = numpy.stack(numpy.meshgrid(i, j, indexing="ij"), axis=-1)
    sides = numpy.array([along, up], float)
    return surface(corner + share @ sides, share * numpy.linalg.norm(sides, axis=1) * TEXELS, color)


def post(foot: list, width: float, height: float, color: list) -> list:
    """Four sides and a top."""
    x, y, z = foot
    w = width
    return [rectangle([x, y, z], [w, 0, 0], [0, height, 0], color), rectangle([x, y, z], [0, 0, w], [0, height, 0], color),
            rectangle([x + w, y, z], [0, 0, w], [0, height, 0], color), rectangle([x, y, z + w], [w, 0, 0], [0, height, 0], color),
            rectangle([x, y + height, z], [w, 0, 0], [0, 0, w], color)]


def floor() -> tuple:
    """Cells that grow with their distance, from under the camera to the horizon."""
    z = numpy.geomspace(0.5, 990, 71)[:, None]
    x = numpy.linspace(-1.2, 1.2, 51) * (z + 10)
    points = numpy.stack([x, numpy.zeros_like(x), z + 0 * x], axis=-1)
    return surface(points, points[:, :, [0, 2]] * TEXELS, [0.72, 0.76, 0.6])


def wire(start: numpy.ndarray, end: numpy.ndarray, pieces: int = 16) -> tuple:
    """A band of 2 cm that sags by a twentieth of its length."""
    t = numpy.linspace(0, 1, pieces + 1)[:, None, None]
    points = start + t * (end - start) + numpy.array([[[0, 0, 0], [0, 0.02, 0]]])
    points[:, :, 1] -= 0.2 * numpy.linalg.norm(end - start) * (t * (1 - t))[:, :, 0]
    return surface(points, t * numpy.array([[[64, 0], [64, 1]]]), [0.15, 0.15, 0.18])


def spot(foot: list, height: float, turn: float, color: list) -> tuple:
    """The mesh, scaled, turned around y and standing at a place."""
    rows = [line.split() for line in SPOT.read_text().splitlines()]
    position, texel = (numpy.array([row[1:] for row in rows if row[:1] == [kind]], float) for kind in ("v", "vt"))
    corners = numpy.array([[corner.split("/")[:2] for corner in row[1:]] for row in rows if row[:1] == ["f"]], int) - 1
    scale = height / numpy.ptp(position[:, 1])
    turned = numpy.array([[numpy.cos(turn), 0, -numpy.sin(turn)], [0, 1, 0], [numpy.sin(turn), 0, numpy.cos(turn)]])
    standing = (position - [0, position[:, 1].min(), 0]) @ turned * scale + foot
    return numpy.concatenate([standing[corners[..., 0]], texel[corners[..., 1]] * 4 * TEXELS * height], axis=-1), color


def yard(random: numpy.random.Generator) -> list:
    grey, wood, paint = [0.8, 0.75, 0.7], [0.6, 0.45, 0.3], [[0.85, 0.2, 0.15], [0.95, 0.85, 0.2], [0.2, 0.4, 0.8]]
    parts = [floor(), rectangle([7, 0, 9], [0, 0, 32], [0, 3.2, 0], grey, (32, 4))]
    for i in range(24):  # decals 4 mm in front of the wall, and above the floor; none touches another
        y, z = random.uniform([0.3, 0], [2.2, 0.4])
        parts.append(rectangle([7 - 0.004, y, 9.4 + 1.25 * i + z], [0, 0, 0.8], [0, 0.8, 0], paint[i % 3]))
        x, z = random.uniform([-4, 0], [4, 0.2])
        parts.append(rectangle([x, 0.004, 5 + 1.45 * i + z], [1.2, 0, 0], [0, 0, 1.2], paint[i % 3]))
    for z in numpy.arange(6, 61, 0.5):  # the fence
        parts += post([-5.5, 0, z], 0.12, random.uniform(1, 1.2), wood)
    parts += [rectangle([-5.36, y, 6], [0, 0, 55], [0, 0.1, 0], wood, (55, 1)) for y in (0.3, 0.8)]
    poles = numpy.stack([numpy.full(12, -9), numpy.zeros(12), numpy.arange(12, 372, 30)], axis=-1)
    for pole in poles:
        parts += post(pole, 0.25, 8.5, wood)
        parts.append(rectangle(pole + [-1.4, 8, -0.02], [3, 0, 0], [0, 0.15, 0], wood))
    for arm in (-1.3, 0.1, 1.5):
        parts += [wire(a + [arm, 8.1, 0], b + [arm, 8.1, 0]) for a, b in zip(poles, poles[1:])]
    for foot, height, color in (([-1.9, 0, 6.5], 1.5, [1, 0.9, 0.8]), ([2.1, 0, 9.5], 1.9, [0.9, 0.7, 0.6]),
                                ([-2.5, 0, 16], 3, [0.7, 0.75, 0.9]), ([4.2, 0, 28], 2.4, [0.95, 0.85, 0.6])):
        parts.append(spot(foot, height, random.uniform(0, 2 * numpy.pi), color))
    return parts


def lines(parts: list) -> list:
    """One line of the stream per triangle whose corners lie between s_min and s_max, lit from the upper left."""
    forward, up = numpy.array([0, -numpy.sin(PITCH), numpy.cos(PITCH)]), numpy.array([0, numpy.cos(PITCH), numpy.sin(PITCH)])
    light = numpy.array([-0.5, 0.7, -0.5]) / numpy.linalg.norm([-0.5, 0.7, -0.5])
    out = []
    for triangles, color in parts:
        points = triangles[:, :, :3]
        normal = numpy.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        facing = numpy.abs(normal @ light) / numpy.linalg.norm(normal, axis=1)
        shade = numpy.round(color * (0.4 + 0.6 * facing)[:, None], 3).tolist()
        seen = points - EYE
        s = seen @ forward
        screen = numpy.stack([WIDTH / 2 + FOCAL * seen[:, :, 0] / s, HEIGHT / 2 - FOCAL * (seen @ up) / s, s], axis=-1)
        vertices = numpy.round(numpy.concatenate([screen, triangles[:, :, 3:]], axis=-1), 6).tolist()
        inside = numpy.all((s >= S_MIN) & (s <= S_MAX), axis=1)
        out += [json.dumps({"v": vertices[i], "c": 3 * [[*shade[i], 1]], "tex": 0}) for i in numpy.flatnonzero(inside)]
    return out


def main() -> int:
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    folder, seed = pathlib.Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else 1
    random = numpy.random.default_rng(seed)
    header = {"bitspan": 1, "width": WIDTH, "height": HEIGHT, "s_min": S_MIN, "s_max": S_MAX, "focal": FOCAL, "background": SKY,
              "color_max": 1, "fog": {"color": SKY, "distance": 700}, "textures": ["stones.png"]}
    matplotlib.image.imsave(folder / "stones.png", stones(random))
    triangles = lines(yard(random))
    (folder / "yard.tri").write_text("\n".join([json.dumps(header), *triangles, ""]))
    print(f"yard.tri: {len(triangles)} triangles, seed {seed}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
