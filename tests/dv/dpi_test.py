# SPDX-License-Identifier: Apache-2.0
"""examples/dpi: two configurations in one simulation, right and with each kind of fault."""

import os
import pathlib
import re
import subprocess
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
# They stay, so that a second run has nothing to compile.
FOLDER = pathlib.Path(os.environ["BITSPAN_BUILD"]) / "dpi"
PREFIX = FOLDER / "prefix"


def link(name, target):
    """A place of the prefix, without an installation."""
    path = PREFIX / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    path.symlink_to(target)


def run(*command):
    done = subprocess.run([str(word) for word in command], cwd=FOLDER, env={**os.environ, "PREFIX": str(PREFIX)},
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", errors="replace")
    return done.returncode, done.stdout


class Dpi(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        library = pathlib.Path(os.environ["BITSPAN_LIBRARY"]).resolve()
        link("bin/bitspan", os.environ["BITSPAN_PROGRAM"])
        link("lib/libbitspan.so", library)
        link("lib/libbitspan.so.0", library)
        link("include", SOURCE / "include")
        link("share/bitspan/dv", SOURCE / "dv")
        cls.code, cls.out = run(SOURCE / "examples/dpi/run.sh")

    def simulate(self, *arguments):
        code, out = run("obj_dir/Vacme_spi_tb", *arguments)
        self.assertNotEqual(code, 0, out)
        return out

    def test_two_configurations_have_no_difference(self):
        self.assertEqual(self.code, 0, self.out)
        for name in ("near", "far"):
            counts = re.search(rf"u_{name}\S*: (\d+) values matched, (\d+) non-trivial, (\d+) records unchecked", self.out)
            self.assertTrue(counts, self.out)
            matched, nontrivial, unchecked = map(int, counts.groups())
            # 13 fields per pixel: those that the design does not have are not counted.
            self.assertEqual((matched, unchecked), (13 * 7422, 0))
            self.assertTrue(40000 < nontrivial < matched)
        self.assertNotIn("mismatch", self.out)

    def test_a_flipped_bit_is_named(self):
        out = self.simulate("+flip")
        for name in ("near", "far"):
            line = re.search(rf"mismatch at time (\d+): {name}: span: record \d+, triangle \d+, pixel 20 \d+: u: "
                             r"got 0x([0-9a-f]+) \(-?[\d.]+ texel\), expected 0x([0-9a-f]+) \(-?[\d.]+ texel\)", out)
            self.assertTrue(line, out)
            self.assertEqual(int(line[2], 16) ^ int(line[3], 16), 1)
        self.assertEqual(len(re.findall("mismatch at", out)), 2)
        # 50 clocks of 10 behind the first one, and the clock that ends.
        first = int(re.search(r"mismatch at time (\d+)", out)[1])
        end = int(re.search(r"\[(\d+)\] %Error", out)[1])
        self.assertEqual(end - first, 510)

    def test_without_stimulus_it_fails(self):
        out = self.simulate("+rows=0")
        self.assertIn("0 values matched, 0 non-trivial, 7422 records unchecked", out)
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_records_that_are_not_checked_fail(self):
        out = self.simulate("+rows=100")
        self.assertRegex(out, r": [1-9]\d+ values matched, [1-9]\d+ non-trivial, [1-9]\d+ records unchecked")
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_settings_reach_the_model(self):
        self.assertRegex(self.simulate("+settings=formats.span.uv.word=24"), "mismatch .*: u: got")
        self.assertIn('setting "nonsense"; expected KEY=VALUE', self.simulate("+settings=nonsense"))
        self.assertIn("formats.span.nothing", self.simulate("+settings=formats.span.nothing=1"))
        self.assertIn("nowhere.tri", self.simulate("+scene=nowhere.tri"))

    def test_the_document_shows_the_script(self):
        script = (SOURCE / "examples/dpi/run.sh").read_text()
        shown = re.search(r"```sh\n(.*?)```", (SOURCE / "docs/dv.md").read_text(), re.S)[1]
        self.assertTrue(script.endswith("\n" + shown))
        self.assertLessEqual(shown.count("\n"), 15)


if __name__ == "__main__":
    unittest.main()
