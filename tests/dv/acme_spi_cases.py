# SPDX-License-Identifier: Apache-2.0
"""What examples/dpi and examples/vpi must do alike: acme_spi in two configurations, right and with each kind of fault."""

import re


class AcmeSpi:
    """A unittest.TestCase beside it has code and out of the example's run, and fails(*plusargs): the text of a run that fails."""

    pixels = 0  # of each configuration, in the example's picture
    least_nontrivial = 0
    flip = ()  # arguments of a picture that has the flipped bit
    few_rows = ""
    end_of_simulation = ""  # with the time as group 1

    def test_two_configurations_have_no_difference(self):
        self.assertEqual(self.code, 0, self.out)
        for name in ("near", "far"):
            counts = re.search(rf"u_{name}\S*: (\d+) values matched, (\d+) non-trivial, (\d+) records unchecked", self.out)
            self.assertTrue(counts, self.out)
            matched, nontrivial, unchecked = map(int, counts.groups())
            # 13 fields per pixel: those that the design does not have are not counted.
            self.assertEqual((matched, unchecked), (13 * self.pixels, 0))
            self.assertTrue(self.least_nontrivial < nontrivial < matched)
        self.assertNotIn("mismatch", self.out)

    def test_a_flipped_bit_is_named(self):
        out = self.fails("+flip", *self.flip)
        for name in ("near", "far"):
            line = re.search(rf"mismatch at time (\d+): {name}: span: record \d+, triangle \d+, pixel 20 \d+: u: "
                             r"got 0x([0-9a-f]+) \(-?[\d.]+ texel\), expected 0x([0-9a-f]+) \(-?[\d.]+ texel\)", out)
            self.assertTrue(line, out)
            self.assertEqual(int(line[2], 16) ^ int(line[3], 16), 1)
        self.assertEqual(len(re.findall("mismatch at", out)), 2)
        # 50 clocks of 10 behind the first one, and the clock that ends.
        first = int(re.search(r"mismatch at time (\d+)", out)[1])
        end = int(re.search(self.end_of_simulation, out)[1])
        self.assertEqual(end - first, 510)

    def test_without_stimulus_it_fails(self):
        out = self.fails("+rows=0")
        self.assertIn(f"0 values matched, 0 non-trivial, {self.pixels} records unchecked", out)
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_records_that_are_not_checked_fail(self):
        out = self.fails(self.few_rows)
        self.assertRegex(out, r": [1-9]\d+ values matched, [1-9]\d+ non-trivial, [1-9]\d+ records unchecked")
        self.assertIn("not verified", out)
        self.assertNotIn("mismatch", out)

    def test_settings_reach_the_model(self):
        self.assertRegex(self.fails("+settings=formats.span.uv.word=24"), "mismatch .*: u: got")
        self.assertIn('setting "nonsense"; expected KEY=VALUE', self.fails("+settings=nonsense"))
