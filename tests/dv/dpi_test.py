# SPDX-License-Identifier: Apache-2.0
"""examples/dpi: two configurations in one simulation, right and with each kind of fault."""

import re
import unittest

from folder import PREFIX, SOURCE, prepare, run, shown

FOLDER = prepare("dpi")


class Dpi(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.code, cls.out = run(FOLDER, SOURCE / "examples/dpi/run.sh")

    def simulate(self, *arguments):
        code, out = run(FOLDER, "obj_dir/Vacme_spi_tb", *arguments)
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
        self.assertEqual(len(refused), 20)
        for text in ("nowhere: no such configuration", "'nothing' is no engine", "name \"rows\"", "stage 99; expected 0 to 11",
                     "merge delivers no row", "record -1 into 64 values", "nothing: span has no such field",
                     "no field is present", "nowhere.tri: cannot read", "rows: closed; expected an open model"):
            self.assertTrue(any(text in said for _, said in refused), text)


if __name__ == "__main__":
    unittest.main()
