# SPDX-License-Identifier: Apache-2.0
"""examples/vpi: two configurations under Icarus, right and with each kind of fault."""

import re
import unittest

from acme_spi_cases import AcmeSpi
from folder import PREFIX, SOURCE, prepare, run, shown

FOLDER = prepare("vpi")


EXAMPLE = 0, ""


def setUpModule():
    """Builds the VPI module, too."""
    global EXAMPLE
    EXAMPLE = run(FOLDER, SOURCE / "examples/vpi/run.sh")


def simulate(bench, *arguments):
    return run(FOLDER, "vvp", "-n", "-M.", f"{bench}.vvp", *arguments)


class Vpi(AcmeSpi, unittest.TestCase):
    pixels = 126
    least_nontrivial = 500
    flip = ("+width=24", "+height=12")
    few_rows = "+rows=5"
    end_of_simulation = r"Time: (\d+)"

    @classmethod
    def setUpClass(cls):
        cls.code, cls.out = EXAMPLE

    def fails(self, *arguments):
        code, out = simulate("acme_spi_tb", *arguments)
        self.assertNotEqual(code, 0, out)
        return out

    def test_the_document_shows_the_script(self):
        self.assertTrue(shown("examples/vpi/run.sh"))


class Rows(unittest.TestCase):
    """Rows that a bench draws by itself, and calls that are refused."""

    @classmethod
    def setUpClass(cls):
        code, out = run(FOLDER, "iverilog", "-g2012", "-s", "rows_tb", "-L.", "-m", "bitspan", "-o", "rows_tb.vvp",
                        PREFIX / "share/bitspan/dv/vpi/bitspan_checker.sv", SOURCE / "tests/dv/rows_vpi_tb.sv")
        assert code == 0, out

    def test_a_row_matches(self):
        code, out = simulate("rows_tb")
        self.assertEqual(code, 0, out)
        self.assertIn("closed: 176 matched", out)
        self.assertIn("delta_f, 16 bits", out)
        self.assertIn("176 values matched, 1 non-trivial, 0 records unchecked", out)

    def test_nothing_but_trivial_values_fail(self):
        code, out = simulate("rows_tb", "+trivial")
        self.assertNotEqual(code, 0, out)
        self.assertIn("176 values matched, 0 non-trivial, 0 records unchecked", out)
        self.assertIn("not verified", out)

    def test_an_unknown_bit_fails(self):
        code, out = simulate("rows_tb", "+unknown")
        self.assertNotEqual(code, 0, out)
        self.assertIn("argument 3 has x or z", out)

    def test_what_is_refused_says_why(self):
        refused = re.findall(r"refused: (.+)", simulate("rows_tb")[1])
        self.assertEqual(len(refused), 48)
        for text in ("nowhere: no such configuration", "'nothing' is no engine", "argument 2 is missing", "argument 1 is no text",
                     "argument 1 has x or z", "name \"rows\"", "stage -1; expected 0 to 11", "merge delivers no row",
                     "$bs_row(model, stage, record): argument 4 is one too many", "argument 4 is no integer",
                     "record -1 into 64 values", "argument 4 is no array of longint", "nothing: span has no such field",
                     "no field is present", "argument 2 is no stage: spam", "nowhere.tri: cannot read",
                     "rows: closed; expected an open model"):
            self.assertTrue(any(text in said for said in refused), text)


if __name__ == "__main__":
    unittest.main()
