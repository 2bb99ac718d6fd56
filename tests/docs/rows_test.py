# SPDX-License-Identifier: Apache-2.0
"""docs/rows.md has one line per row of the source documents, and what its cells name exists and holds."""

import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = SOURCE / "docs/rows.md"
PROGRAM = os.environ["BITSPAN_PROGRAM"]

# The ids of the source documents: a letter, and the highest number.
HIGHEST = {"D": 1, "T": 15, "F": 4, "SH": 3, "L": 7, "V": 2, "ST": 3, "C": 2, "P": 1, "G": 5, "B": 10, "H": 9, "N": 3, "O": 1}
IDS = [f"{letter}{number}" for letter, highest in HIGHEST.items() for number in range(1, highest + 1)]
ROLES = set("SDPGO")


def section(text, heading):
    """The text below a heading of the second level."""
    return re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.S | re.M)[1]


def table(text):
    """The rows of the first table, without its head: lists of cells."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines[2:]]


def anchor(heading):
    """What a link to a heading ends with."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def problems_of_cells(text):
    """Everything that is wrong with the page but its commands, one line each."""
    found = []
    built, coming = table(section(text, "Built")), table(section(text, "To come"))
    for cells, width in [(row, 6) for row in built] + [(row, 3) for row in coming]:
        if len(cells) != width or not all(cells):
            found.append(f"{cells[0]}: {len(cells)} cells, not all of {width} are filled")
        elif not set(cells[2].split(", ")) <= ROLES:
            found.append(f"{cells[0]}: no such role: {cells[2]}")
    for rows in (built, coming):
        ids = [cells[0] for cells in rows]
        found += [f"{name}: stands twice" for name in sorted({name for name in ids if ids.count(name) > 1})]
        found += [f"{name}: no row of the source documents" for name in ids if name not in IDS]
    there = {cells[0] for cells in [*built, *coming]}
    found += [f"{name}: no line" for name in IDS if name not in there]
    for cells in built:
        if len(cells) == 6:
            found += problems_of_row(*cells)
    return found


def problems_of_row(name, what, role, defined, test, command):
    link = re.fullmatch(r"\[(.+)\]\((\w[\w-]*\.md)#(.+)\)", defined)
    if not link or not (SOURCE / "docs" / link[2]).is_file():
        yield f"{name}: no such page: {defined}"
    else:
        headings = re.findall(r"^#+ (.+)$", (SOURCE / "docs" / link[2]).read_text(), re.M)
        if not any(anchor(heading) == link[3] and heading.startswith(link[1]) for heading in headings):
            yield f"{name}: no such heading: {defined}"
    place = re.fullmatch(r"`(tests/\S+)` `(\w+)\.(\w+)`", test)
    if not place or not (SOURCE / place[1]).is_file():
        yield f"{name}: no such file: {test}"
    elif not re.search(rf"^TEST(_F|_P)?\({place[2]}, {place[3]}\)", (SOURCE / place[1]).read_text(), re.M):
        yield f"{name}: no such test: {test}"
    if not re.fullmatch(r"`bitspan [^`]+`", command):
        yield f"{name}: no command: {command}"


class Rows(unittest.TestCase):
    def test_every_row_has_a_line_and_its_cells_name_what_there_is(self):
        self.assertEqual(problems_of_cells(PAGE.read_text()), [])

    def test_what_is_wrong_is_found(self):
        text = PAGE.read_text()
        for old, new, problem in (
            ("| D1 |", "| D7 |", "D7: no row of the source documents"),
            ("| B10 |", "| B9 |", "B10: no line"),
            ("| ST1 |", "| ST2 |", "ST2: stands twice"),
            ("perspective by adders and one reciprocal per pixel (delta-f)", " ", "T1: 6 cells, not all of 6 are filled"),
            ("per column; filled, and as lines | O |", "per column; filled, and as lines | X |", "V1: no such role: X"),
            ("(numeric-spec.md#merge)", "(numeric-spec.md#blend)", "T5: no such heading: [merge](numeric-spec.md#blend)"),
            ("[span](numeric-spec.md#span)", "[span](numeric.md#span)", "N3: no such page: [span](numeric.md#span)"),
            ("`Merge.TranslucentBlends`", "`Merge.Blends`", "T5: no such test: `tests/stages/merge_test.cpp` `Merge.Blends`"),
            ("`bitspan verify --suite 'merge.blend/*'`", "later", "T5: no command: later"),
        ):
            self.assertEqual(text.count(old), 1, old)
            self.assertIn(problem, problems_of_cells(text.replace(old, new)))

    def test_what_the_specification_names_is_built(self):
        built = {cells[0]: cells[3] for cells in table(section(PAGE.read_text(), "Built"))}
        spec = (SOURCE / "docs/numeric-spec.md").read_text()
        named = set(re.findall(r"\b[A-Z]{1,2}\d+\b", " ".join(re.findall(r"\[((?:[A-Z]{1,2}\d+)(?:, [A-Z]{1,2}\d+)*)\]", spec))))
        self.assertGreaterEqual(len(named), 10)
        self.assertEqual(named - built.keys(), set())

    def test_every_command_holds(self):
        with tempfile.TemporaryDirectory() as folder:
            data = pathlib.Path(folder, "tests/data")
            data.parent.mkdir()
            data.symlink_to(SOURCE / "tests/data")
            for name, *_, cell in table(section(PAGE.read_text(), "Built")):
                words = shlex.split(cell.strip("`"))
                with self.subTest(row=name, command=cell):
                    done = subprocess.run([PROGRAM, *words[1:]], cwd=folder, capture_output=True, text=True, timeout=120)
                    self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_what_is_left_out_by_decision_says_why(self):
        rows = table(section(PAGE.read_text(), "Not built, by decision"))
        self.assertEqual(len(rows), 7)
        for cells in rows:
            self.assertTrue(len(cells) == 2 and all(cells), cells)


if __name__ == "__main__":
    unittest.main()
