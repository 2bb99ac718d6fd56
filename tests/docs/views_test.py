# SPDX-License-Identifier: Apache-2.0
"""examples/views/yard.py writes a stream that is drawn, and docs/studies/views.md says of it what its pictures show."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ["BITSPAN_PROGRAM"]
# What chose the widths, the widths, register bits, unseen views that hold, and the worst of them with its camera.
ROW = r"^\| ([^|]*) \| (-?\d+), (\d+), (\d+) \| (\d+) \| [^|]* \| (\d+) \| ([0-9.]+) on yard@(\d+) \|"


def configuration(span_f, edge_uv, mantissa):
    text = (SOURCE / "config/depth20.toml").read_text()
    for name, fraction in (("span.f", span_f), ("span.f_step", span_f), ("edge.uv", edge_uv)):
        text, count = re.subn(rf'^("{re.escape(name)}" = .* word = )\d+, int = (\d+)',
                              lambda found: f"{found[1]}{int(found[2]) + fraction}, int = {found[2]}", text, flags=re.M)
        assert count == 1, name
    return re.sub(r"(\[reciprocal\.pixel\].*?\noutput = .*? word = )\d+", rf"\g<1>{mantissa}", text, count=1, flags=re.S)


class Views(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.said = subprocess.run([sys.executable, "-B", SOURCE / "examples/views/yard.py", cls.folder], check=True, capture_output=True,
                                  text=True).stdout
        cls.ideal = {}

    def drawn(self, scene, engine, config="depth20"):
        """The triangles, and the quarters of a texel of u and v that a picture shows."""
        subprocess.run([PROGRAM, "render", scene, "--engine", engine, "--config", config, "-o", "out.png", "--dump", "dump"], check=True,
                       cwd=self.folder, stdout=subprocess.DEVNULL)
        triangle, u, v = (numpy.load(self.folder / "dump" / f"{name}.npy") for name in ("triangle", "u", "v"))
        return triangle, numpy.floor(4 * numpy.stack([u, v]))

    def rates(self, config, camera):
        """The shares of pixels in the wrong quarter of a texel, and of another triangle."""
        scene = f"yard.tri@{camera}"
        if scene not in self.ideal:
            self.ideal[scene] = self.drawn(scene, "ideal")
        (triangle, quarters), (true_triangle, true_quarters) = self.drawn(scene, "model", config), self.ideal[scene]
        drawn, same = (triangle >= 0) | (true_triangle >= 0), (triangle >= 0) & (triangle == true_triangle)
        wrong = numpy.any(quarters != true_quarters, axis=0)
        return numpy.count_nonzero(wrong & same) / numpy.count_nonzero(same), numpy.count_nonzero(drawn & ~same) / numpy.count_nonzero(drawn)

    def test_the_yard_is_drawn(self):
        header, *triangles = (self.folder / "yard.tri").read_text().splitlines()
        self.assertEqual(self.said, f"yard.tri: {len(triangles)} triangles, seed 1\n")
        self.assertEqual(json.loads(header)["s_max"] / json.loads(header)["s_min"], 2000)
        triangle, _ = self.drawn("yard.tri", "model")
        self.assertEqual(triangle.shape, (240, 320))
        self.assertGreater(len(numpy.unique(triangle)), 4000)
        page = (SOURCE / "docs/studies/views.md").read_text()
        self.assertEqual(re.findall(r"a stream of ([0-9,]+) triangles", page), [f"{len(triangles):,}"])

    def test_widths_hold_on_as_many_unseen_views_as_the_page_says(self):
        rows = re.findall(ROW, (SOURCE / "docs/studies/views.md").read_text(), re.M)
        self.assertGreaterEqual(len(rows), 3)
        for by, *numbers, worst, camera in rows:
            *widths, bits, hold = map(int, numbers)
            (self.folder / "narrow.toml").write_text(configuration(*widths))
            with self.subTest(by=by):
                point = subprocess.run([PROGRAM, "study", "--point", "narrow.toml", "demo", "--size", "16x12"], check=True, cwd=self.folder,
                                       capture_output=True, text=True).stdout
                self.assertRegex(point, rf"(?m)^cost\.register_bits +{bits} ")
                self.assertEqual(f"{self.rates('narrow.toml', camera)[0]:.3g}", worst)
                if "BITSPAN_LONG" in os.environ:
                    views = int(re.search(r"`views = (\d+)`", by)[1])
                    unseen = [self.rates("narrow.toml", i) for i in range(views, views + 100)]
                    self.assertEqual(sum(quarter <= 0.02 and order <= 0.0005 for quarter, order in unseen), hold)


if __name__ == "__main__":
    unittest.main()
