# SPDX-License-Identifier: Apache-2.0
"""examples/vpi: two configurations under Icarus, right and with each kind of fault."""

import re
import unittest

from folder import PREFIX, SOURCE, prepare, run, shown

FOLDER = prepare("vpi")


EXAMPLE = 0, ""


def setUpModule():
    """Builds the VPI module, too."""
    global EXAMPLE
    EXAMPLE = run(FOLDER, SOURCE / "examples/vpi/run.sh")


def simulate(bench, *arguments):
    return run(FOLDER, "vvp", "-n", "-M.", f"{bench}.vvp", *arguments)


class Vpi(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.code, cls.out = EXAMPLE

    def fails(self, *arguments):
        code, out = simulate("acme_spi_tb", *arguments)
        self.assertNotEqual(code, 0, out)
        return out

    def test_two_configurations_have_no_difference(self):
        self.assertEqual(self.code, 0, self.out)
        for name in ("near", "far"):
            counts = re.search(rf"u_{name}\S*: (\d+) values matched, (\d+) non-trivial, (\d+) records unchecked", self.out)
            self.assertTrue(counts, self.out)
            matched, nontrivial, unchecked = map(int, counts.groups())
            self.assertEqual((matched, unchecked), (13 * 196, 0))
            self.assertTrue(1000 < nontrivial < matched)
        self.assertNotIn("mismatch", self.out)

    def test_a_flipped_bit_is_named(self):
        out = self.fails("+flip", "+width=24", "+height=12")
        for name in ("near", "far"):
            line = re.search(rf"mismatch at time (\d+): {name}: span: record \d+, triangle \d+, pixel 20 \d+: u: "
                             r"got 0x([0-9a-f]+) \(-?[\d.]+ texel\), expected 0x([0-9a-f]+) \(-?[\d.]+ texel\)", out)
            self.assertTrue(line, out)
            self.assertEqual(int(line[2], 16) ^ int(line[3], 16), 1)
        self.assertEqual(len(re.findall("mismatch at", out)), 2)
        # 50 clocks of 10 behind the first one, and the clock that ends.
        first = int(re.search(r"mismatch at time (\d+)", out)[1])
        end = int(re.search(r"Time: (\d+)", out)[1])
        self.assertEqual(end - first, 510)

    def test_without_stimulus_it_fails(self):
        out = self.fails("+rows=0")
        self.assertIn("0 values matched, 0 non-trivial, 196 records unchecked", out)
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_records_that_are_not_checked_fail(self):
        out = self.fails("+rows=5")
        self.assertRegex(out, r": [1-9]\d+ values matched, [1-9]\d+ non-trivial, [1-9]\d+ records unchecked")
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_settings_reach_the_model(self):
        self.assertRegex(self.fails("+settings=formats.span.uv.word=24"), "mismatch .*: u: got")
        self.assertIn('setting "nonsense"; expected KEY=VALUE', self.fails("+settings=nonsense"))

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
        self.assertEqual(len(refused), 45)
        for text in ("nowhere: no such configuration", "'nothing' is no engine", "argument 2 is missing", "argument 1 is no text",
                     "argument 1 has x or z", "name \"rows\"", "stage -1; expected 0 to 11", "merge delivers no row",
                     "$bs_row(model, stage, record): argument 4 is one too many", "argument 4 is no integer",
                     "record -1 into 64 values", "argument 4 is no array of longint", "nothing: span has no such field",
                     "no field is present", "argument 2 is no stage: spam", "nowhere.tri: cannot read",
                     "rows: closed; expected an open model"):
            self.assertTrue(any(text in said for said in refused), text)


if __name__ == "__main__":
    unittest.main()
