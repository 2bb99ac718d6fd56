#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow under lights of each kind, and for two eyes, and a teapot.

    examples/light/pictures.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/light-NAME.png and FOLDER/stereo-NAME.png. The configurations with a light are made in a folder that is removed
again.
"""

import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPOT = str(ROOT / "tests/data/spot.obj")
TEAPOT = str(ROOT / "tests/data/teapot.bez")
SIZE = "480x360"
PARALLAX = 9


def parallax_map(codes: numpy.ndarray, file: pathlib.Path) -> None:
    """Draws how far each pixel moves, from depth codes of 16 bits that are linear in 1 / s."""
    figure, axes = plt.subplots(figsize=(4.8, 3.6), dpi=100, layout="constrained")
    shown = axes.imshow(numpy.where(codes == 0, numpy.nan, codes * (PARALLAX / 65535)))
    axes.set_axis_off()
    figure.colorbar(shown, label="parallax, pixels", shrink=0.8)
    figure.savefig(file)
    plt.close(figure)


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    bitspan, base, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as scratch:
        def render(name: str, scene: str, config: pathlib.Path, *flags: str) -> None:
            subprocess.run([bitspan, "render", scene, "--config", str(config), "--size", SIZE, *flags,
                            "-o", str(out / f"{name}.png")], check=True, stdout=subprocess.DEVNULL)

        def draw(name: str, config: pathlib.Path, *flags: str) -> None:
            render(name, SPOT, config, "--distance", "2.6", *flags)

        def pot(name: str, config: pathlib.Path, *flags: str) -> None:
            # Few triangles, so that the three can be told apart.
            render(f"light-teapot-{name}", TEAPOT, config, "--patch-depth", "2", "--yaw", "200", "--distance", "8.5", *flags)

        draw("light-none", base, "--unlit")
        pot("none", base, "--unlit")
        def with_keys(name: str, keys: str) -> pathlib.Path:
            config = pathlib.Path(scratch) / f"{name}.toml"
            config.write_text(base.read_text().replace("[fog]", f"{keys}\n\n[fog]", 1))
            return config

        for at in ("face", "vertex", "pixel"):
            config = with_keys(at, f'[light]\nat = "{at}"\nsource = "point"')
            draw(f"light-{at}", config, "--light=2,2.5,-2.5,0.15,0.4,32")
            pot(at, config, "--light=-2,6,-6,0.25,0.35,32")
        # The light is behind the viewer, as the sun is at full moon.
        moon = with_keys("moon", '[light]\nat = "pixel"\nlaw = "lunar"')
        draw("light-lambert", moon, "--light=4.7,3.4,-8.1,0.05,0,1")
        draw("light-lunar", moon, "--light=4.7,3.4,-8.1,0.05,0,1,3")
        draw("light-falls", with_keys("falls", '[light]\nat = "pixel"\nsource = "point"\nfall = "second"'),
             "--light=0.9,1.1,-1.2,0,0,1,0,0.9,0")
        room = with_keys("room", '[project]\nunit = "reciprocal"\n\n[light]\nat = "pixel"\nsource = "point"\nnormal = "map"\nshadow = "map"')
        render("room-plain", "room", base)
        render("room", "room", room)
        mapped = pathlib.Path(scratch) / "mapped.toml"
        mapped.write_text(base.read_text().replace("wrap = ", 'second = "own"\nwrap = ', 1))
        draw("light-map", mapped, "--light-map=0.9,1.1,-1.2,0.9")
        draw("stereo-anaglyph", base, "--stereo", "anaglyph", "--parallax", str(PARALLAX))
        draw("stereo-depth", base, "--stereo", "pair", "--stereo-by", "depth", "--parallax", str(PARALLAX))
        dump = pathlib.Path(scratch) / "dump"
        subprocess.run([bitspan, "render", SPOT, "--config", str(base), "--size", SIZE, "--distance", "2.6", "--dump", str(dump)],
                       check=True, stdout=subprocess.DEVNULL)
        parallax_map(numpy.load(dump / "depth.npy"), out / "stereo-parallax.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
