# SPDX-License-Identifier: Apache-2.0
"""What coverage.py reads and reports, on counts written by hand."""
import pathlib
import tempfile
import unittest

import coverage


def point(file, line, page, name, count, column=3):
    keys = {"f": file, "l": line, "n": column, "page": page, "o": name, "h": "TOP.u"}
    return "C '" + "".join(f"\x01{k}\x02{v}" for k, v in keys.items()) + f"' {count}\n"


class Coverage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        (self.root / "rtl").mkdir()
        (self.root / "rtl" / "skid.sv").write_text(
            "module skid;\n  if (A) begin : gen_a\n    always_ff @(posedge clk_i) q <= d;\n  end else begin : gen_b\n"
            "    always_ff @(posedge clk_i) q <= e;\n  end\nendmodule\n")
        # A build tree reaches the RTL through a link.
        (self.root / "link").symlink_to("rtl")
        file = f"{self.root}/link/skid.sv"
        self.starts = ["# SystemC::Coverage-3\n", point(file, 9, "v_toggle/skid__W8", "q_o[2]", 1)]
        self.ends = [
            "# SystemC::Coverage-3\n",
            # Two instances with other parameters are one module.
            point(file, 3, "v_line/skid__W8", "block", 0),
            point(file, 3, "v_line/skid__W9", "block", 4),
            point(file, 8, "v_branch/skid__W8", "else", 0, 7),
            *(point(file, 9, "v_toggle/skid__W8", f"q_o[{bit}]", count) for bit, count in enumerate((0, 0, 1, 5, 0))),
            *(point(file, 10, "v_toggle/skid__W8", f"m[{word}][{bit}]", int(word == 3 or (word, bit) == (2, 1)))
              for word in range(4) for bit in range(2)),
            point(file, 11, "v_toggle/skid__W8", "valid", 0),
            point("/else/handshakes.sv", 5, "v_user/skid_handshakes", "in_stall", 0),
            point("/else/handshakes.sv", 6, "v_user/skid_handshakes", "in_idle", 7),
            point("/else/handshakes.sv", 6, "v_line/skid_handshakes", "block", 0),
            point("/else/other.sv", 1, "v_line/other", "block", 0),
        ]

    def counts(self):
        return coverage.counted(self.ends, self.starts, self.root)

    def test_the_report_names_every_hole(self):
        text = coverage.report(self.counts(), self.root)
        self.assertEqual(text.splitlines(), [
            "module  lines  toggles  handshakes",
            "skid      1/2     4/14         1/2",
            "all       1/2     4/14         1/2",
            "",
            "rtl/skid.sv: handshake: in_stall",
            "rtl/skid.sv:8: line: else at column 7",
            "rtl/skid.sv:9: toggle: q_o[4, 2:0]",
            "rtl/skid.sv:10: toggle: m[1:0]",
            "rtl/skid.sv:10: toggle: m[2][0]",
            "rtl/skid.sv:11: toggle: valid",
            "rtl/skid.sv:4: never built: gen_b",
        ])

    def test_without_holes_it_says_so(self):
        reached = {p: 1 for p in self.counts() if p.kind == "handshakes"}
        (self.root / "rtl" / "skid.sv").write_text("module skid;\nendmodule\n")
        self.assertTrue(coverage.report(reached, self.root).endswith("\nno holes"))

    def test_modules_restrict_it(self):
        text = coverage.report(self.counts(), self.root, ["span"])
        self.assertEqual(text.splitlines()[1], "all       0/0      0/0         0/0")


if __name__ == "__main__":
    unittest.main()
