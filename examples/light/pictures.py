#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow under lights of each kind, and for two eyes.

    examples/light/pictures.py BITSPAN CONFIG.toml FOLDER

writes FOLDER/light-NAME.png and FOLDER/stereo-NAME.png. The configurations with a light are made in a folder that is removed
again.
"""

import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPOT = str(ROOT / "tests/data/spot.obj")
SIZE = "480x360"


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

        draw("light-none", base, "--unlit")
        def with_keys(name: str, keys: str) -> pathlib.Path:
            config = pathlib.Path(scratch) / f"{name}.toml"
            config.write_text(base.read_text().replace("[fog]", f"{keys}\n\n[fog]", 1))
            return config

        for at in ("face", "vertex", "pixel"):
            draw(f"light-{at}", with_keys(at, f'[light]\nat = "{at}"\nsource = "point"'), "--light=2,2.5,-2.5,0.15,0.4,32")
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
        draw("stereo-anaglyph", base, "--stereo", "anaglyph", "--parallax", "9")
        draw("stereo-depth", base, "--stereo", "pair", "--stereo-by", "depth", "--parallax", "9")
    return 0


if __name__ == "__main__":
    sys.exit(main())
