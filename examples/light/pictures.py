#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draw a cow under a light four ways, and for two eyes.

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
        def draw(name: str, config: pathlib.Path, *flags: str) -> None:
            subprocess.run([bitspan, "render", SPOT, "--config", str(config), "--size", SIZE, "--distance", "2.6", *flags,
                            "-o", str(out / f"{name}.png")], check=True, stdout=subprocess.DEVNULL)

        draw("light-none", base, "--unlit")
        for at in ("face", "vertex", "pixel"):
            config = pathlib.Path(scratch) / f"{at}.toml"
            config.write_text(base.read_text().replace("[fog]", f'[light]\nat = "{at}"\nsource = "point"\n\n[fog]', 1))
            draw(f"light-{at}", config, "--light=2,2.5,-2.5,0.15,0.4,32")
        draw("stereo-anaglyph", base, "--stereo", "anaglyph", "--parallax", "9")
        draw("stereo-depth", base, "--stereo", "pair", "--stereo-by", "depth", "--parallax", "9")
    return 0


if __name__ == "__main__":
    sys.exit(main())
