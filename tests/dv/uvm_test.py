# SPDX-License-Identifier: Apache-2.0
"""dv/uvm is elaborated by pyslang against a stub of UVM, and planted errors are found. Exit code 77 where pyslang is missing."""

import re
import subprocess
import sys
import unittest

from folder import SOURCE, prepare

PYTHON = SOURCE / "build/python/bin/python3"
PACKAGE = SOURCE / "dv/uvm/bitspan_uvm_pkg.sv"
EXAMPLE = SOURCE / "examples/uvm/acme_test.sv"
FOLDER = prepare("uvm")


def elaborate(package=PACKAGE, example=EXAMPLE.parent):
    here = SOURCE / "tests/dv/uvm"
    done = subprocess.run([PYTHON, "-B", here / "elaborate.py", "--top", "top", "-I", here, "-I", example, here / "uvm_pkg.sv",
                           SOURCE / "dv/dpi/bitspan_pkg.sv", package, here / "top.sv"], cwd=FOLDER, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, encoding="utf-8")
    return done.returncode, done.stdout


class Uvm(unittest.TestCase):
    def test_it_elaborates(self):
        code, out = elaborate()
        self.assertEqual(code, 0, out)
        self.assertIn("0 errors, 0 warnings", out)

    def test_planted_errors_are_found(self):
        text = PACKAGE.read_text()
        for old, new, said in (
            ("bitspan_check(model.handle,", "bitspan_check(", "too few arguments"),  # of a DPI function
            ("bitspan_nontrivial(model", "bitspan_non_trivial(model", "undeclared identifier 'bitspan_non_trivial'"),
            ("t.value, model.present", "t.values, model.present", "no member named 'values'"),
            ("int pixel_stage = StageSpan;", "int pixel_stage = StageSpam;", "undeclared identifier 'StageSpam'"),
            ("pixels.connect(scoreboard.delivered)", "rows.connect(scoreboard.delivered)", "bitspan_row"),  # of another item
            ("virtual function void write(bitspan_record_item t);", "virtual function void write(bitspan_row_item t);", "write"),
            ("expected.write(pixel);", "expected.write(t);", "bitspan_row_item"),
            ("first + count <= width;", "first + count <= wide;", "undeclared identifier 'wide'"),
            ("field[i].field_cg.sample(t.value[i], ", "field[i].field_cg.sample(", "too few arguments"),
            ("cross perspective_cp, depth_code_cp", "cross perspective_cp, depth_cp", "depth_cp"),
            ("bins negative = {[low : -1]};", "bins negative = {[lowest : -1]};", "undeclared identifier 'lowest'"),
            ("if (row.randomize() == 0)", "if (row.randomise() == 0)", "no member named 'randomise'"),
            ("longint records;\n", "int records;\n", "implicit conversion"),
            ("type_id::create(\"row\");\n        row.about", "type_id::create(\"row\", 7, 8, 9);\n        row.about", "too many arguments"),
        ):
            self.assertIn(old, text)
            planted = FOLDER / "planted.sv"
            planted.write_text(text.replace(old, new, 1))
            code, out = elaborate(planted)
            self.assertEqual(code, 1, f"{new}: {out}")
            self.assertIn(said, out)

    def test_the_example_is_checked(self):
        (FOLDER / EXAMPLE.name).write_text(EXAMPLE.read_text().replace("model.open();", "model.opens();"))
        code, out = elaborate(example=FOLDER)
        self.assertEqual(code, 1, out)
        self.assertIn("no member named 'opens'", out)

    def test_the_document_shows_the_example(self):
        text = re.search(r"  function void build_phase.*?endfunction\n  function void connect_phase.*?endfunction\n", EXAMPLE.read_text(),
                         re.S)[0]
        blocks = re.findall(r"```\w*\n(.*?)```", (SOURCE / "docs/dv.md").read_text(), re.S)
        self.assertIn(text.replace("\n  ", "\n").removeprefix("  "), blocks)
        self.assertLessEqual(text.count("\n"), 15)
        for file in (PACKAGE, EXAMPLE, SOURCE / "docs/dv.md"):
            self.assertIn("laborated, not simulated here", file.read_text())


if __name__ == "__main__":
    if not PYTHON.exists() or subprocess.run([PYTHON, "-c", "import pyslang"], capture_output=True).returncode:
        print("skipped: no pyslang; ./dev setup installs it")
        sys.exit(77)
    unittest.main(verbosity=2)
