# SPDX-License-Identifier: Apache-2.0
"""examples/dpi: two configurations in one simulation, right and with each kind of fault."""

import re
import unittest

from acme_spi_cases import AcmeSpi
from folder import PREFIX, SOURCE, prepare, run, shown

FOLDER = prepare("dpi")


class Dpi(AcmeSpi, unittest.TestCase):
    pixels = 7422
    least_nontrivial = 40000
    few_rows = "+rows=100"
    end_of_simulation = r"\[(\d+)\] %Error"

    @classmethod
    def setUpClass(cls):
        cls.code, cls.out = run(FOLDER, SOURCE / "examples/dpi/run.sh")

    def fails(self, *arguments):
        code, out = run(FOLDER, "obj_dir/Vacme_spi_tb", *arguments)
        self.assertNotEqual(code, 0, out)
        return out

    def test_what_the_model_refuses_ends_the_run(self):
        self.assertIn("formats.span.nothing", self.fails("+settings=formats.span.nothing=1"))
        self.assertIn("nowhere.tri", self.fails("+scene=nowhere.tri"))

    def test_the_document_shows_the_script(self):
        self.assertTrue(shown("examples/dpi/run.sh"))


class Rows(unittest.TestCase):
    """Rows that a bench draws by itself, and calls that are refused."""

    @classmethod
    def setUpClass(cls):
        dpi = PREFIX / "share/bitspan/dv/dpi"
        code, out = run(FOLDER, "verilator", "--binary", "-j", "2", "--Mdir", "rows", "--top-module", "rows_tb", "-CFLAGS",
                        f"-std=c++17 -O1 -I{PREFIX}/include", "-LDFLAGS",
                        f"-L{PREFIX}/lib -lbitspan -Wl,-rpath,{PREFIX}/lib", dpi / "bitspan_pkg.sv",
                        dpi / "bitspan_checker.sv", dpi / "bitspan_dpi.cpp", SOURCE / "tests/dv/rows_dpi_tb.sv")
        assert code == 0, out

    def test_a_row_matches(self):
        code, out = run(FOLDER, "rows/Vrows_tb")
        self.assertEqual(code, 0, out)
        self.assertIn("closed: 176 matched", out)
        self.assertIn("176 values matched, 1 non-trivial, 0 records unchecked", out)

    def test_nothing_but_trivial_values_fail(self):
        code, out = run(FOLDER, "rows/Vrows_tb", "+trivial")
        self.assertNotEqual(code, 0, out)
        self.assertIn("176 values matched, 0 non-trivial, 0 records unchecked", out)
        self.assertIn("not verified", out)

    def test_what_is_refused_says_why(self):
        refused = re.findall(r"refused: ([^:]+): (.+)", run(FOLDER, "rows/Vrows_tb")[1])
        self.assertEqual(len(refused), 23)
        for text in ("nowhere: no such configuration", "'nothing' is no engine", "name \"rows\"", "stage 99; expected 0 to 11",
                     "merge delivers no row", "record -1 into 64 values", "nothing: span has no such field",
                     "no field is present", "nowhere.tri: cannot read", "perspective.nothing: the configuration has no such key",
                     "rows: closed; expected an open model"):
            self.assertTrue(any(text in said for _, said in refused), text)


if __name__ == "__main__":
    unittest.main()
