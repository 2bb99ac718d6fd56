# SPDX-License-Identifier: Apache-2.0
"""Binary streams from outside: what examples/trib/write_trib.py writes, and what the program makes of it."""

import json
import os
import pathlib
import runpy
import struct
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
EXAMPLE = SOURCE / "examples/trib/write_trib.py"
PROGRAM = os.environ["BITSPAN_PROGRAM"]
HEADER = {"bitspan": 2, "width": 96, "height": 64, "s_min": 1, "s_max": 100, "focal": 60, "background": [0, 0.5, 1],
          "color_max": 1}


class Trib(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def bitspan(self, *arguments, code=0, **options):
        run = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, cwd=self.path, **options)
        self.assertEqual(run.returncode, code, run.stderr)
        return run.stderr.decode()

    def read(self, name):
        return (self.path / name).read_bytes()

    def test_the_example_has_thirty_lines(self):
        text = EXAMPLE.read_text()
        writer = text[text.index("class TribWriter"):text.index('if __name__')]
        self.assertLessEqual(sum(1 for line in writer.splitlines() if line.strip()), 30)

    def test_the_example_is_read_and_comes_back(self):
        subprocess.run([sys.executable, "-B", EXAMPLE, self.path / "a.trib"], check=True)
        self.bitspan("render", "a.trib", "-o", "a.png", "--emit-tri", "b.tri")
        lines = [json.loads(line) for line in self.read("b.tri").splitlines()]
        self.assertEqual(len(lines), 1 + 2 * 16)
        self.assertEqual(lines[1], {"v": [[40, 30, 20, 0, 0], [160, 30, 20, 0, 0], [40, 120, 5, 0, 0]]})
        self.assertEqual(lines[2], {"state": {"depth.func": "less"}})
        self.assertEqual(lines[3]["c"][2], [16 / 255, 0, 1, 128 / 255])
        self.bitspan("render", "b.tri", "-o", "b.png", "--emit-tri", "c.trib")
        self.bitspan("render", "c.trib", "-o", "c.png", "--emit-tri", "d.tri")
        self.assertEqual(self.read("a.png"), self.read("b.png"))
        self.assertEqual(self.read("a.png"), self.read("c.png"))
        self.assertEqual(self.read("b.tri"), self.read("d.tri"))
        # Standard input, and another name.
        self.bitspan("render", "-", "-o", "d.png", input=self.read("c.trib"))
        self.assertEqual(self.read("a.png"), self.read("d.png"))
        (self.path / "e.bin").write_bytes(self.read("c.trib"))
        self.bitspan("render", "e.bin", "-o", "e.png", "--show-target", "0")
        self.assertEqual(self.read("a.png"), self.read("e.png"))
        self.bitspan("verify", "c.trib", "--engines", "golden,model")

    def test_what_another_writer_gives_is_what_the_text_gives(self):
        writer = runpy.run_path(str(EXAMPLE))["TribWriter"](self.path / "a.trib", **HEADER)
        text = [HEADER]
        for k in range(1000):  # more than a block
            v = [[k / 11.0, 1.5, 2 + k / 100, -0.0, 5e-324], [90.25, 3.0, 4, 1e300, 2], [k % 90, 60 - k / 77, 9, 0.1, 3]]
            c = [[0.5, 1, k / 1000, 1], [0, 0.25, 0, 1], [1, 1, 1, 0.5]] if k % 3 == 0 else None
            writer.triangle(v, c)
            text.append({"v": v} if c is None else {"v": v, "c": c})
            if k % 100 == 0:
                command = [{"clear": {"depth": True}}, {"target": k % 3}, {"view": {"focal": 50.5 + k}}][k // 100 % 3]
                writer.command(command)
                text.append(command)
        writer.close()
        (self.path / "b.tri").write_text("".join(json.dumps(line) + "\n" for line in text))
        self.bitspan("render", "a.trib", "--emit-tri", "from_a.tri")
        self.bitspan("render", "b.tri", "--emit-tri", "from_b.tri")
        self.assertEqual(self.read("from_a.tri"), self.read("from_b.tri"))
        self.assertEqual(self.read("from_a.tri").count(b"\n"), len(text))

    def test_a_damaged_file_is_one_line(self):
        subprocess.run([sys.executable, "-B", EXAMPLE, self.path / "a.trib"], check=True)
        good = self.read("a.trib")
        (self.path / "short.trib").write_bytes(good[:1000])
        self.assertEqual(self.bitspan("render", "short.trib", "-o", "a.png", code=2).split(" (")[0],
                         "bitspan: short.trib: byte 1000: the file ends inside a block")
        (size,) = struct.unpack("<I", good[8:12])
        bad = bytearray(good)
        bad[16 + size + 8 + 50] ^= 1  # in the first triangle
        (self.path / "bad.trib").write_bytes(bad)
        self.assertTrue(self.bitspan("render", "bad.trib", "-o", "a.png", code=2).startswith(
            f"bitspan: bad.trib: byte {16 + size}: the checksum behind this block's "))
        self.assertFalse((self.path / "a.png").exists())


if __name__ == "__main__":
    unittest.main()
