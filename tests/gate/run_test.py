# SPDX-License-Identifier: Apache-2.0
"""Nothing sleeps: each long test is in one share, a stale name is refused, and a skip that is not listed fails."""
import contextlib
import io
import pathlib
import tempfile
import tomllib
import unittest

import run

TABLE = tomllib.loads((pathlib.Path(run.__file__).parent / "long.toml").read_text())


class Shares(unittest.TestCase):
    def setUp(self):
        self.long = {(build, name): seconds for build in ("release", "readers") for part in ("long", "short_form")
                     for name, seconds in TABLE[build].get(part, {}).items()}

    def test_each_long_test_is_in_one_share(self):
        flat = [key for share in run.shares(self.long) for key in share]
        self.assertEqual(sorted(flat), sorted(self.long))

    def test_shares_take_about_as_long(self):
        sums = [sum(self.long[key] for key in share) for share in run.shares(self.long)]
        self.assertLessEqual(max(sums), 480, "CPU seconds: four minutes on two cores")
        self.assertLessEqual(max(sums) - min(sums), max(self.long.values()))

    def test_a_test_is_in_one_part(self):
        for build in ("release", "readers"):
            parts = [set(TABLE[build].get(part, {})) for part in ("long", "short_form")]
            self.assertEqual(len(set.union(*parts)), sum(map(len, parts)))


class Verdict(unittest.TestCase):
    def said(self, results, may_skip=()):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            code = run.say(results, may_skip)
        return code, out.getvalue().splitlines()

    def test_a_listed_skip_is_named_and_passes(self):
        code, lines = self.said([{"passed": ["a"], "failed": [], "skipped": ["dv.Uvm"]}], ["dv.*"])
        self.assertEqual((code, lines), (0, ["1 skipped: dv.Uvm", "1 passed, 0 failed"]))

    def test_another_skip_fails(self):
        code, lines = self.said([{"passed": ["a"], "failed": [], "skipped": ["io.Full"]}], ["dv.*"])
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"))

    def test_a_failure_fails_and_so_does_nothing(self):
        self.assertEqual(self.said([{"passed": ["a"], "failed": ["b"], "skipped": []}])[0], 1)
        self.assertEqual(self.said([{"passed": [], "failed": [], "skipped": []}])[0], 1)

    def test_a_name_that_is_no_test_is_refused(self):
        table = {"release": {"long": {"Gone.Test": 1}}}
        with self.assertRaisesRegex(SystemExit, "release: Gone.Test"):
            run.check_names(table, {"release": {"Here.Test": 1}})

    def test_results_of_ctest(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "junit.xml"
            file.write_text("""<testsuite>
<testcase name="a" status="run"/><testcase name="b/0  # GetParam() = 1" status="fail"><failure message=""/></testcase>
<testcase name="c" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>
<testcase name="d" status="notrun"><skipped message="Unable to find executable"/></testcase></testsuite>""")
            self.assertEqual(run.read_results(file), {"passed": ["a"], "failed": ["b/0", "d"], "skipped": ["c"]})


if __name__ == "__main__":
    unittest.main()
