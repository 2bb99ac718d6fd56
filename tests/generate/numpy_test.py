# SPDX-License-Identifier: Apache-2.0
"""Height fields as NumPy writes them, Delaunay triangulations against Qhull's, and the memory that a large grid takes."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy
from matplotlib.tri import Triangulation

PROGRAM = os.environ["BITSPAN_PROGRAM"]
HILLS = pathlib.Path(__file__).resolve().parents[1] / "data/hills.png"
IS_LONG = "BITSPAN_LONG" in os.environ


def make(*words):
    return subprocess.run([PROGRAM, "make", *map(str, words)], check=True, capture_output=True, text=True).stdout


def read_obj(path):
    """Vertices, and corners of triangles from 0."""
    lines = [line.split() for line in path.read_text().splitlines()]
    return (numpy.array([[float(x) for x in line[1:4]] for line in lines if line[0] == "v"]),
            numpy.array([[int(x) - 1 for x in line[1:]] for line in lines if line[0] == "f"]))


class NumPy(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def test_arrays_come_back(self):
        random = numpy.random.default_rng(5)
        for kind in ("i1", "u1", "<i2", ">i2", "<u4", ">i8", "<f4", ">f8"):
            field = (random.random((7, 9)) * 100).astype(kind)
            for save, name in ((lambda a, p: numpy.save(p, a), "a.npy"), (lambda a, p: numpy.savez(p, dx=0.5, height=a), "a.npz"),
                               (lambda a, p: numpy.savez_compressed(p, height=a), "a.npz")):
                for array in (field, numpy.asfortranarray(field)):
                    with self.subTest(kind=kind, name=name):
                        save(array, self.folder / name)
                        make("terrain", self.folder / name, "-o", self.folder / "a.obj")
                        vertices, _ = read_obj(self.folder / "a.obj")
                        wanted = field.astype(float) - float(field.min())
                        self.assertTrue((vertices[:, 1].reshape(7, 9) == wanted).all())

    def test_delaunay_is_that_of_qhull_but_for_points_on_one_circle(self):
        random = numpy.random.default_rng(6)
        differ = 0
        for shape, points in (((300, 400), 500), ((40, 50), 700), ((344, 403), 50000 if IS_LONG else 4000)):
            numpy.save(self.folder / "a.npy", random.random(shape))
            make("delaunay", self.folder / "a.npy", "-o", self.folder / "a.obj", "--points", points, "--seed", 9)
            vertices, ours = read_obj(self.folder / "a.obj")
            # Samples, as whole numbers.
            at = numpy.rint(vertices[:, [0, 2]] * 2).astype(numpy.int64)
            at = (at - at.min(axis=0)) // 2
            self.assertEqual(len(at), points)
            theirs = Triangulation(at[:, 0], at[:, 1]).triangles
            known = {frozenset(t) for t in ours.tolist()}
            others = [t for t in theirs.tolist() if frozenset(t) not in known]
            # Qhull also gives flat triangles along the edge.
            flat = [t for t in others if numpy.linalg.det(numpy.c_[at[t], [1, 1, 1]].astype(float)).round() == 0]
            self.assertEqual(len(theirs) - len(flat), len(ours))
            for t in others:
                if t in flat:
                    continue
                differ += 1
                a, b, c = ((at[k][0] - at[:, 0], at[k][1] - at[:, 1]) for k in t)
                square = [x * x + y * y for x, y in (a, b, c)]
                cross = [p[0] * q[1] - p[1] * q[0] for p, q in ((b, c), (c, a), (a, b))]
                inside = sum(s * x for s, x in zip(square, cross))
                turn = numpy.sign(numpy.cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]))
                self.assertLessEqual((inside * turn).max(), 0, "a point in Qhull's circle")
                self.assertGreater((inside == 0).sum(), 3, "a triangle that only Qhull has")
        self.assertGreater(differ, 0)

    def test_a_large_grid_takes_no_memory(self):
        def peak(columns):
            child = subprocess.Popen([PROGRAM, "make", "terrain", HILLS, "-o", self.folder / "a.obj", "--columns", str(columns)],
                                     stdout=subprocess.PIPE, text=True)
            text = child.stdout.read()
            child.stdout.close()
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(status, 0)
            return usage.ru_maxrss, int(text.split()[-2])

        small, few = peak(80)
        large, many = peak(820 if IS_LONG else 400)
        self.assertGreater(many, 1_000_000 if IS_LONG else 200_000)
        self.assertLess(few, 20_000)
        self.assertLess(large, small + 1024, "kB")


if __name__ == "__main__":
    unittest.main()
