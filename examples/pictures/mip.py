#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw the checkered floor with each choice of levels and of samples, and measure the pictures.

    examples/pictures/mip.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/mip-NAME.png and prints one row of a table per picture, and then one per number of samples. The truth is 16 x 16 samples per pixel of
the engine `ideal`, averaged. PSNR is of the floor's rows and below the horizon alone: the sky is equal in all.
"""

import pathlib
import sys

import matplotlib.image
import numpy

from drawing import Drawing, make

WIDTH, HEIGHT, SAMPLES = 256, 192, 16

# name, what the table says of it, the filter, and [texture] mip, [lod] mode, bias, first
PICTURES = [
    ("nearest", "no chain, one texel", "nearest", "none", "none", 0, 4096),
    ("bilinear", "no chain, four texels", "bilinear", "none", "none", 0, 4096),
    ("zones", "T10, T11: zones of s, trilinear", "bilinear", "linear", "zone_s", 0, 700),
    ("gradient-nearest", "T10: gradients, the nearest level", "bilinear", "nearest", "gradient", 0, 4096),
    ("gradient", "T10: gradients, trilinear", "bilinear", "linear", "gradient", 0, 4096),
]

# The same keys, drawn with 1 x 1 to 8 x 8 samples per pixel.
SAMPLED = [PICTURES[0], PICTURES[1], PICTURES[4]]
COUNTS = [1, 2, 4, 8]


def configured(text: str, texture_filter: str, mip: str, mode: str, bias: int, first: int) -> str:
    lines = []
    for line in text.splitlines():
        if line.startswith("filter = "):
            line = f'filter = "{texture_filter}"\nmip = "{mip}"'
        lines.append(line)
    return "\n".join(lines) + f'\n[lod]\nmode = "{mode}"\nbias = {bias}\nfirst = {first}\n'


def floor_of(drawing: Drawing, config: pathlib.Path, engine: str, size: str, out: pathlib.Path, samples: int = 1) -> numpy.ndarray:
    drawing.run("render", "floor", "--config", config, "--engine", engine, "--size", size, "-o", out, "--supersample", samples)
    return numpy.round(matplotlib.image.imread(out)[:, :, :3] * 255).astype(numpy.float64)


def draw(drawing: Drawing) -> None:
    text = drawing.base.read_text()
    config = drawing.scratch / "floor.toml"
    config.write_text(configured(text, "nearest", "none", "none", 0, 4096))
    fine = floor_of(drawing, config, "ideal", f"{WIDTH * SAMPLES}x{HEIGHT * SAMPLES}", drawing.scratch / "fine.png")
    truth = fine.reshape(HEIGHT, SAMPLES, WIDTH, SAMPLES, 3).mean(axis=(1, 3))
    matplotlib.image.imsave(drawing.out / "mip-truth.png", numpy.round(truth).astype(numpy.uint8))
    floor = numpy.any(truth != truth[0, 0], axis=(1, 2))  # rows with any floor

    def psnr(picture: numpy.ndarray) -> str:
        return f"{10 * numpy.log10(255**2 / numpy.mean((picture[floor] - truth[floor]) ** 2)):.1f}"

    for name, what, *keys in PICTURES:
        config.write_text(configured(text, *keys))
        picture = floor_of(drawing, config, "model", f"{WIDTH}x{HEIGHT}", drawing.out / f"mip-{name}.png")
        print(f"| {name} | {what} | {psnr(picture)} |")
    for name, _, *keys in SAMPLED:
        config.write_text(configured(text, *keys))
        drawn = [floor_of(drawing, config, "model", f"{WIDTH}x{HEIGHT}", drawing.scratch / "drawn.png", k) for k in COUNTS]
        print(f"| {name} | {' | '.join(psnr(picture) for picture in drawn)} |")


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
