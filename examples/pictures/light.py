#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow under lights of each kind, and for two eyes, and a teapot.

    examples/pictures/light.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/light-NAME.png and FOLDER/stereo-NAME.png. The configurations with a light are made in a folder that is removed
again.
"""

import pathlib
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from drawing import DATA, Drawing, make  # noqa: E402

SIZE = ("--size", "480x360")
COW = (DATA / "spot.obj", *SIZE, "--distance", "2.6")
# Few triangles, so that the three can be told apart.
POT = (DATA / "teapot.bez", *SIZE, "--patch-depth", "2", "--yaw", "200", "--distance", "8.5")
PARALLAX = 9


def parallax_map(codes: numpy.ndarray, file: pathlib.Path) -> None:
    """Draws how far each pixel moves, from depth codes of 16 bits that are linear in 1 / s."""
    figure, axes = plt.subplots(figsize=(4.8, 3.6), dpi=100, layout="constrained")
    shown = axes.imshow(numpy.where(codes == 0, numpy.nan, codes * (PARALLAX / 65535)))
    axes.set_axis_off()
    figure.colorbar(shown, label="parallax, pixels", shrink=0.8)
    figure.savefig(file)
    plt.close(figure)


def draw(drawing: Drawing) -> None:
    def cow(name: str, config: pathlib.Path, *flags: str) -> None:
        drawing.render(name, *COW, *flags, config=config)

    def pot(name: str, config: pathlib.Path, *flags: str) -> None:
        drawing.render(f"light-teapot-{name}", *POT, *flags, config=config)

    cow("light-none", drawing.base, "--unlit")
    pot("none", drawing.base, "--unlit")
    for at in ("face", "vertex", "pixel"):
        config = drawing.with_keys(at, f'[light]\nat = "{at}"\nsource = "point"')
        cow(f"light-{at}", config, "--light=2,2.5,-2.5,0.15,0.4,32")
        pot(at, config, "--light=-2,6,-6,0.25,0.35,32")
    # The light is behind the viewer, as the sun is at full moon.
    moon = drawing.with_keys("moon", '[light]\nat = "pixel"\nlaw = "lunar"')
    cow("light-lambert", moon, "--light=4.7,3.4,-8.1,0.05,0,1")
    cow("light-lunar", moon, "--light=4.7,3.4,-8.1,0.05,0,1,3")
    cow("light-falls", drawing.with_keys("falls", '[light]\nat = "pixel"\nsource = "point"\nfall = "second"'),
        "--light=0.9,1.1,-1.2,0,0,1,0,0.9,0")
    room = drawing.with_keys("room", '[project]\nunit = "reciprocal"\n\n[light]\nat = "pixel"\nsource = "point"\nnormal = "map"\nshadow = "map"')
    drawing.render("room-plain", "room", *SIZE)
    drawing.render("room", "room", *SIZE, config=room)
    cow("light-map", drawing.config("mapped", ("wrap = ", 'second = "own"\nwrap = ')), "--light-map=0.9,1.1,-1.2,0.9")
    cow("stereo-anaglyph", drawing.base, "--stereo", "anaglyph", "--parallax", str(PARALLAX))
    cow("stereo-depth", drawing.base, "--stereo", "pair", "--stereo-by", "depth", "--parallax", str(PARALLAX))
    dump = drawing.scratch / "dump"
    drawing.run("render", *COW, "--config", drawing.base, "--dump", dump)
    parallax_map(numpy.load(dump / "depth.npy"), drawing.out / "stereo-parallax.png")


if __name__ == "__main__":
    sys.exit(make(draw, __doc__))
