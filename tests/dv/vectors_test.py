# SPDX-License-Identifier: Apache-2.0
"""bitspan vectors against readers of its own, and examples/vectors under Icarus, right and with a bug."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
BITSPAN = pathlib.Path(os.environ["BITSPAN_PROGRAM"])


class Vectors(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="bitspan-vectors-")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        (self.folder / "examples").symlink_to(SOURCE / "examples")

    def run_here(self, *command, code=0):
        path = f"{BITSPAN.parent}:{os.environ['PATH']}"
        done = subprocess.run(command, cwd=self.folder, env={**os.environ, "PATH": path}, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8", errors="replace")
        self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout

    def vectors(self, form, *words):
        self.run_here("bitspan", "vectors", "demo", "--size", "40x30", "--format", form, "-o", form, *words)
        return self.folder / form

    def test_words_columns_and_records_say_the_same(self):
        for stage, mode in (("setup", "depth16"), ("edge_walk", "depth20"), ("span", "narrow"), ("merge", "depth16")):
            words = ("--stage", stage, "--config", mode)
            whole = json.loads(self.vectors("json", *words).read_text())
            of_hex = self.vectors("hex", *words)
            of_npy = self.vectors("npy", *words)
            header = (of_hex / "vectors.vh").read_text()
            tables = json.loads((of_hex / "vectors.json").read_text())["tables"]
            self.assertEqual(tables[-1]["role"], "output")
            self.assertEqual([table["stage"] for table in tables], [table["stage"] for table in whole["tables"]])
            for table, inline, columns in zip(tables, whole["tables"],
                                              json.loads((of_npy / "vectors.json").read_text())["tables"]):
                records = numpy.array(inline["records"], dtype=numpy.int64)
                self.assertEqual(len(records), table["count"])
                array = numpy.load(of_npy / columns["file"])
                self.assertEqual(array.dtype, numpy.int64)
                self.assertTrue(numpy.array_equal(array, records))
                lines = (of_hex / table["file"]).read_text().split()
                self.assertEqual({len(line) for line in lines}, {(table["bits"] + 3) // 4})
                # By the rule of the document, without msb and lsb: the first field leftmost, without gaps.
                left = table["bits"]
                for column, field in enumerate(table["fields"]):
                    left -= field["word"]
                    self.assertEqual((field["lsb"], field["msb"]), (left, left + field["word"] - 1))
                    macro = f"{table['role']}_{table['stage']}_{field['name']}".upper().replace(".", "_")
                    self.assertIn(f"`define {macro} {field['msb']}:{field['lsb']}\n", header)
                    raw = [int(line, 16) >> left & (1 << field["word"]) - 1 for line in lines]
                    if field["signed"]:
                        raw = [value - (value >> field["word"] - 1 << field["word"]) for value in raw]
                    self.assertEqual(raw, records[:, column].tolist(), field["name"])
                self.assertEqual(left, 0)
            self.assertTrue((records < 0).any() or stage in ("merge",))

    def test_the_documents_start(self):
        text = (SOURCE / "docs/vectors.md").read_text()
        shown = re.search(r"```sh\n(.*?)```", text, re.S)[1]
        self.assertLessEqual(shown.count("\n"), 15)
        out = self.run_here("bash", "-e", "-c", shown)
        self.assertNotIn("warning", out)
        self.assertIn("20527 pixels, 0 wrong in x or last", out)
        end = re.search(r"It ends with\n\n(.*?)\n\nWith", text, re.S)[1]
        self.assertTrue(out.rstrip().endswith(re.sub("(?m)^    ", "", end)), out)

        wrong = shown.replace("-Wall", "-Wall -DPLANTED_BUG")
        out = self.run_here("bash", "-e", "-c", wrong, code=1)
        self.assertIn(re.search(r"(?m)^    (FAILED: .*)$", text)[1], out)
        self.assertIn("first divergence: model against design", out)


if __name__ == "__main__":
    unittest.main()
