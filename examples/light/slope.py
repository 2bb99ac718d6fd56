#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Show how a light per vertex approaches a light per pixel as triangles shrink.

    examples/light/slope.py TEAPOT

TEAPOT is Newell's teapot as the teaset file has it: the number of patches, 16 indices of each, the number of points, their
coordinates. Each patch becomes 2 k^2 triangles, k = 16 to 128, which are drawn with both lights. The root mean square of what
their brightness differs by is printed for each k, without a highlight and with one, and the slopes of their logarithms.
"""

import sys

import bitspan
import numpy as np

SIZE = (640, 480)
FOCAL = 900.0
EYE = np.array([3.0, -7.0, 4.5])
TARGET = np.array([0.1, 0.0, 1.4])
SPLITS = (16, 32, 64, 128)
HIGHLIGHTS = (0.0, 0.3)  # shares; their exponent is 8
INSET = 1e-4  # normals of a patch's collapsed side are taken so far within it


def read(path: str) -> np.ndarray:
    """The control points, (patches, 4, 4, 3)."""
    with open(path) as file:
        lines = file.read().split()
    patches = int(lines[0])
    of = np.array([line.split(",") for line in lines[1:1 + patches]], dtype=int) - 1
    points = np.array([line.split(",") for line in lines[2 + patches:]], dtype=float)
    return points[of].reshape(patches, 4, 4, 3)


def bernstein(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cubic polynomials at t, (n, 4), and their derivatives."""
    s = 1 - t
    value = np.stack([s**3, 3 * t * s**2, 3 * t**2 * s, t**3], axis=1)
    slope = np.stack([-3 * s**2, 3 * s**2 - 6 * t * s, 6 * t * s - 3 * t**2, 3 * t**2], axis=1)
    return value, slope


def grid(patches: np.ndarray, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and unit normals of a grid on each patch, (patches, k + 1, k + 1, 3)."""
    t = np.linspace(0, 1, k + 1)
    value, _ = bernstein(t)
    points = np.einsum("ai,bj,pijc->pabc", value, value, patches)
    value, slope = bernstein(np.clip(t, INSET, 1 - INSET))
    normals = np.cross(np.einsum("ai,bj,pijc->pabc", slope, value, patches),
                       np.einsum("ai,bj,pijc->pabc", value, slope, patches))
    return points, normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def view() -> np.ndarray:
    """The rows are the viewer's axes: to the right, downward, ahead."""
    ahead = TARGET - EYE
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def vertices(patches: np.ndarray, k: int) -> np.ndarray:
    """The triangles that face the viewer, as bitspan.Scene.from_vertices takes them."""
    points, normals = grid(patches, k)
    axes = view()
    seen = (points - EYE) @ axes.T
    turned = normals @ axes.T
    corners = np.zeros((*seen.shape[:-1], 19))
    corners[..., 0] = SIZE[0] / 2 + FOCAL * seen[..., 0] / seen[..., 2]
    corners[..., 1] = SIZE[1] / 2 + FOCAL * seen[..., 1] / seen[..., 2]
    corners[..., 2] = seen[..., 2]
    corners[..., 5:9] = 1
    corners[..., 9] = -1
    corners[..., 13] = -1
    corners[..., 16:19] = turned
    a, b, c, d = corners[:, :-1, :-1], corners[:, 1:, :-1], corners[:, 1:, 1:], corners[:, :-1, 1:]
    out = np.concatenate([np.stack(t, axis=-2).reshape(-1, 3, 19) for t in ((a, b, c), (a, c, d))])
    # The normals of all patches point outward.
    position = np.stack([(out[..., 0] - SIZE[0] / 2) / FOCAL, (out[..., 1] - SIZE[1] / 2) / FOCAL, np.ones(out.shape[:2])], -1)
    return out[np.all(np.sum(position * out[..., 16:19], axis=-1) < 0, axis=1)]


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    patches = read(sys.argv[1])
    base = bitspan.Config("depth20").with_({"light.source": "point"})
    errors = []
    print("|   k | triangles | pixels | diffuse | with a highlight |\n|---:|---:|---:|---:|---:|")
    for k in SPLITS:
        corners = vertices(patches, k)
        row = []
        for share in HIGHLIGHTS:
            # At the viewer, so that no visible face lies beyond the terminator, where brightness has an edge.
            light = bitspan.Light(position=(0, 0, 0), ambient=0.1, specular=share, exponent=8)
            scene = bitspan.Scene.from_vertices(corners, *SIZE, s_range=(4, 14), focal=FOCAL, light=light)
            vertex, pixel = (bitspan.render(scene, base.with_({"light.at": at})).real("light.value") for at in ("vertex", "pixel"))
            row.append(float(np.sqrt(np.mean((vertex - pixel)**2))))
        errors.append(row)
        print(f"| {k:3} | {len(corners)} | {len(pixel)} | " + " | ".join(f"{e:.3g}" for e in row) + " |")
    slopes = np.polyfit(np.log2(SPLITS), np.log2(errors), 1)[0]
    print("| slope | | | " + " | ".join(f"{slope:.2f}" for slope in slopes) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
