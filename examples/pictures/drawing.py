# SPDX-License-Identifier: Apache-2.0
"""What the scripts of this folder share. Each draws the pictures that a page of docs/ has: NAME.py BITSPAN CONFIG.toml FOLDER."""

import collections.abc
import dataclasses
import pathlib
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parents[2] / "tests/data"


@dataclasses.dataclass(frozen=True)
class Drawing:
    bitspan: str
    base: pathlib.Path  # the configuration
    out: pathlib.Path  # where the pictures go
    scratch: pathlib.Path  # a folder that is removed again

    def run(self, *words: object) -> None:
        """Runs the program, which must exit with 0."""
        subprocess.run([self.bitspan, *map(str, words)], check=True, stdout=subprocess.DEVNULL)

    def config(self, name: str, *changes: tuple[str, str]) -> pathlib.Path:
        """The configuration with the first of each text replaced, which must be there."""
        text = self.base.read_text()
        for old, new in changes:
            if old not in text:
                raise SystemExit(f"{self.base}: has no {old!r}")
            text = text.replace(old, new, 1)
        file = self.scratch / f"{name}.toml"
        file.write_text(text)
        return file

    def with_keys(self, name: str, keys: str) -> pathlib.Path:
        """The configuration with tables of its own."""
        return self.config(name, ("[fog]", f"{keys}\n\n[fog]"))

    def render(self, picture: str, scene: object, *flags: object, config: pathlib.Path | None = None) -> None:
        self.run("render", scene, "--config", config or self.base, *flags, "-o", self.out / f"{picture}.png")


def elevations() -> str:
    """A real height field, the sample data of Matplotlib: 344 x 403 elevations in metres, some 90 m apart."""
    import matplotlib.cbook

    return matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)


def make(draw: collections.abc.Callable[[Drawing], None], doc: str) -> int:
    """Draws what the command line asks for. Returns the exit code."""
    if len(sys.argv) != 4:
        print(doc, file=sys.stderr)
        return 2
    bitspan, base, out = sys.argv[1:]
    with tempfile.TemporaryDirectory() as scratch:
        draw(Drawing(bitspan, pathlib.Path(base), pathlib.Path(out), pathlib.Path(scratch)))
    return 0
