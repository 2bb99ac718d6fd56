# SPDX-License-Identifier: Apache-2.0
"""examples/cocotb on both simulators, right and with a fault; and cocotb_cases. Exit code 77 where cocotb is missing."""

import re
import subprocess
import sys
import unittest

from folder import BUILD, SOURCE, prepare, run

PYTHON = SOURCE / "build/python/bin/python3"
PACKAGE = BUILD.parent.parent / "python"
FOLDER = prepare("cocotb")


def python(script, *arguments, folder=FOLDER):
    folder.mkdir(exist_ok=True)
    return run(folder, PYTHON, "-B", SOURCE / script, *arguments, PYTHONPATH=str(PACKAGE))


class Example(unittest.TestCase):
    def both(self, *parameters):
        for simulator in ("icarus", "verilator"):
            yield simulator, *python("examples/cocotb/run.py", simulator, *parameters)

    def test_a_design_matches(self):
        for simulator, code, out in self.both():
            self.assertEqual(code, 0, out)
            self.assertRegex(out, r"bitspan: seed \d+, <bitspan.Config depth16 \(c18c9815f835a626\)>")
            counts = re.search(r"bitspan: (\d+) values matched, (\d+) non-trivial, 0 records unchecked, 0 records differ", out)
            self.assertTrue(counts, out)
            matched, nontrivial = map(int, counts.groups())
            self.assertTrue(5000 < nontrivial < matched, (simulator, matched, nontrivial))

    def test_a_planted_bug_is_red(self):
        for _, code, out in self.both("FLIP=1"):
            self.assertEqual(code, 1, out)
            line = re.search(r"first difference: span: record \d+, triangle \d+, pixel 20 \d+: h: got 0x([0-9a-f]+) "
                             r"\([\d.]+ depth code\), expected 0x([0-9a-f]+) \([\d.]+ depth code\)", out)
            self.assertTrue(line, out)
            self.assertEqual(int(line[1], 16) ^ int(line[2], 16), 1)
            self.assertEqual(out.count("first difference"), 1)

    def test_the_document_shows_the_files(self):
        blocks = re.findall(r"```\w*\n(.*?)```", (SOURCE / "docs/cocotb.md").read_text(), re.S)
        for name in ("run.py", "test_acme_walk.py"):
            text = (SOURCE / "examples/cocotb" / name).read_text()
            block = next((b for b in blocks if text.endswith(b)), "")
            self.assertTrue(block and re.fullmatch(r"(#.*\n)+\n?", text[: -len(block)]) and block.count("\n") <= 15, name)
        self.assertIn((SOURCE / "examples/cocotb/acme_walk.toml").read_text().split("\n\n", 1)[1], "".join(blocks))


class Cases(unittest.TestCase):
    def test_icarus(self):
        code, out = python("tests/dv/cocotb_run.py", "icarus", folder=FOLDER / "cases")
        self.assertEqual(code, 0, out)
        self.assertIn("TESTS=10 PASS=9 FAIL=0 SKIP=1", out)

    def test_random_configurations(self):
        seen = set()
        for seed in range(1, 7):
            code, out = python("tests/dv/cocotb_run.py", "icarus", seed, folder=FOLDER / "cases")
            self.assertEqual(code, 0, out)
            seen.add(re.search(rf"seed {seed} .*\((\w+)\)>", out)[1])
        self.assertEqual(len(seen), 6)


if __name__ == "__main__":
    # The package is built where nanobind is.
    found = PYTHON.exists() and subprocess.run([PYTHON, "-c", "import cocotb, bitspan"], cwd=FOLDER, capture_output=True,
                                               env={"PYTHONPATH": str(PACKAGE)}).returncode == 0
    if not found:
        print("skipped: no cocotb, or no Python package of this build: ./dev setup installs what they need")
        sys.exit(77)
    unittest.main(verbosity=2)
