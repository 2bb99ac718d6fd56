# SPDX-License-Identifier: Apache-2.0
"""The report's files, and what it says of bad input."""

import os
import re
import resource
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser
from pathlib import Path

from bitspan_report.database import load_study
from bitspan_report.page import page
from make_database import HOSTILE, write_database


def run(*arguments, limit=None, cwd=None):
    """The program's (exit code, stderr); limit: bytes that a file may have."""

    def restrict():
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = subprocess.run(
        [sys.executable, "-B", "-m", "bitspan_report", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=restrict,
        cwd=cwd,
        check=False,
    )
    assert done.stdout == "", done.stdout
    return done.returncode, done.stderr


class Links(HTMLParser):
    """What a page names to be loaded or gone to, and its tags."""

    def __init__(self):
        super().__init__()
        self.found, self.tags = [], set()

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.found += [value for name, value in attributes if name in ("src", "href", "action", "data")]


class InFolder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = Path(folder.name)
        cls.database = cls.root / "t.db"
        write_database(cls.database)

    def changed(self, name, *statements):
        """A copy of the database after some SQL."""
        path = self.root / name
        path.write_bytes(self.database.read_bytes())
        connection = sqlite3.connect(path)
        for statement in statements:
            connection.execute(statement)
        connection.commit()
        connection.close()
        return path


class Files(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.root / "deep" / "out"
        code, message = run(cls.database, cls.out, "--study", "spans")
        assert code == 0, message

    def test_every_plot_is_there_as_svg_and_png(self):
        names = {path.name for path in self.out.iterdir()}
        self.assertFalse([name for name in names if "partial" in name])
        for stem in ("pareto", "widths", "search"):
            self.assertLessEqual({f"{stem}.svg", f"{stem}.png"}, names)
        for stem in ("registers", "budget", "bounds"):
            self.assertEqual(
                len([name for name in names if re.fullmatch(rf"{stem}-[0-9a-f]{{12}}\.(svg|png)", name)]), 4
            )
        self.assertEqual(len([name for name in names if re.fullmatch(r"unseen-[0-9a-f]{12}\.(svg|png)", name)]), 2)
        self.assertEqual(len([name for name in names if name.startswith("picture-")]), 2 * 2 * 6)

    def test_plots_are_whole(self):
        for path in self.out.glob("*.png"):
            self.assertTrue(path.read_bytes().endswith(b"IEND\xaeB`\x82"), path)
        for path in self.out.glob("*.svg"):
            self.assertEqual(ElementTree.parse(path).getroot().tag, "{http://www.w3.org/2000/svg}svg")

    def test_a_second_run_writes_the_same_bytes(self):
        again = self.root / "again"
        self.assertEqual(run(self.database, again, "--study", "spans"), (0, ""))
        for path in self.out.iterdir():
            self.assertEqual(path.read_bytes(), (again / path.name).read_bytes(), path.name)

    def test_the_page_needs_nothing_else(self):
        links = Links()
        links.feed((self.out / "report.html").read_text("utf-8"))
        self.assertGreater(len(links.found), 10)
        self.assertEqual([link for link in links.found if not link.startswith(("#", "data:"))], [])
        self.assertFalse({"img", "iframe", "object", "embed"} & links.tags)

    def test_text_of_the_database_is_text(self):
        text = (self.out / "report.html").read_text("utf-8")
        self.assertNotIn(HOSTILE, text)
        self.assertIn("&lt;/script&gt;&lt;img src=x", text)
        self.assertEqual(text.count("<script"), text.count("</script"))

    def test_a_recommended_point_tells_its_margins_and_its_scenes(self):
        page = (self.out / "report.html").read_text("utf-8")
        self.assertIn("<li>span.u.p999 is 0.2408 on demo, at most 0.25: margin 3.7 %; 2 of 2 scenes hold ", page)
        self.assertIn("all constraints hold on 7</li>", page)
        table = page[page.index("Each scene alone") :]
        rows = re.findall(r"<tr>.*?</tr>", table[: table.index("</table>")], re.DOTALL)
        self.assertEqual([re.sub(r"<[^>]*>", " ", row).split() for row in rows],
                         [["scene", "span.u.p999", "picture.wrong_order"], ["demo", "0.2408", "0"], ["extreme", "0.1541", "0"]])

    def test_a_study_without_points_says_so(self):
        out = self.root / "empty"
        self.assertEqual(run(self.database, out, "--study", "empty"), (0, ""))
        text = (out / "report.html").read_text("utf-8")
        for line in (
            "No point was measured",
            "This study recommends none",
            "No view was kept from the choice",
            "This needs a register whose format the study varies",
            "No register was observed",
            "has no error budget",
            "has no proved bounds",
            "did not search",
            "Nothing was synthesised at the end of a search",
            "Nothing was synthesised",
            "No picture was kept",
            "every point was measured",
        ):
            self.assertIn(line, text)
        self.assertEqual([path.name for path in out.iterdir()], ["report.html"])

    def test_compared_with_another_study(self):
        other = self.changed(
            "other.db",
            "UPDATE constraints SET at_most = 0.3 WHERE i = 0",
            "UPDATE study_points SET holds = 1 - holds WHERE i = 3",
            "UPDATE metrics SET value = value * 2 WHERE name = 'span.u.p999'",
        )
        out = self.root / "compared"
        self.assertEqual(run(self.database, out, "--study", "spans", "--against", other), (0, ""))
        text = (out / "report.html").read_text("utf-8")
        text = text[text.index('id="compared"') :]
        self.assertIn("span.u.p999 at most 0.3<", text)
        self.assertIn("1 went from holding to failing, 0 from failing to holding", text)
        self.assertRegex(text, r"span\.u\.p999</td>(<td[^>]*>[^<]*</td>){4}<td class=\"n\">-50</td>")
        code, message = run(self.database, out, "--study", "spans", "--against", other, "--against-study", "x")
        self.assertEqual((code, message), (2, f'bitspan_report: {other}: no study "x"; it has: empty, spans\n'))

    def test_each_bound_tells_how_much_of_it_was_reached(self):
        text = page(load_study(str(self.database), "spans"), "")
        row = '<tr><td class="long">span.h</td><td class="long">depth code</td>'
        self.assertIn("49.4 %", text[text.index(row) :].partition("</tr>")[0])
        self.assertTrue('["span.h [depth code]",0.0419,0.0207,"49.4 %",false]' in text)  # for the plot

    def test_a_bound_that_is_passed_is_shouted(self):
        def text_of(database):
            return page(load_study(str(database), "spans"), "")

        path = self.changed("broken.db", "UPDATE bounds SET observed = 1.0 WHERE place = 'span.u'")
        self.assertIn("322.6 %: observed above the bound</span>", text_of(path))
        self.assertNotIn("observed above the bound</span>", text_of(self.database))


class BadInput(InFolder):
    def expect(self, result, *parts):
        code, message = result
        self.assertEqual(code, 2, message)
        self.assertEqual(message.count("\n"), 1, message)
        self.assertTrue(message.startswith("bitspan_report: "), message)
        for part in parts:
            self.assertIn(part, message)

    def test_no_such_file(self):
        self.expect(run(self.root / "none.db", self.root / "o"), "none.db: no such file")
        self.expect(run(self.root, self.root / "o"), "no such file")

    def test_no_database(self):
        path = self.root / "text.db"
        path.write_text("not a database, but long enough to look at" * 100)
        self.expect(run(path, self.root / "o"), "text.db: cannot be read as a study database: file is not a database")

    def test_empty_file_and_other_database(self):
        (self.root / "nothing.db").touch()
        self.expect(run(self.root / "nothing.db", self.root / "o"), "not a study database")
        other = self.root / "other.db"
        sqlite3.connect(other).execute("CREATE TABLE t(x)").connection.close()
        self.expect(run(other, self.root / "o"), "not a study database")

    def test_corrupt_database(self):
        content = bytearray(self.database.read_bytes())
        for at in range(4096 * 3, len(content), 4096):
            content[at : at + 2048] = os.urandom(2048)
        path = self.root / "corrupt.db"
        path.write_bytes(content)
        self.expect(run(path, self.root / "o", "--study", "spans"), "corrupt.db")

    def test_another_schema(self):
        path = self.changed("schema.db", "UPDATE meta SET value = '2' WHERE key = 'schema'")
        self.expect(run(path, self.root / "o"), "schema 2; expected 4")
        path = self.changed("table.db", "DROP TABLE budget")
        self.expect(run(path, self.root / "o", "--study", "spans"), "no such table: budget")

    def test_values_that_no_study_writes(self):
        for name, statement in (
            ("octaves", "UPDATE registers SET octaves = '[1, 2]'"),
            ("settings", "UPDATE study_points SET settings = '{'"),
            ("base", "UPDATE axes SET base = '{'"),
            ("metric", "UPDATE metrics SET value = 'much'"),
            ("picture", "UPDATE pictures SET png = x'00'"),
        ):
            path = self.changed(f"{name}.db", statement)
            self.expect(
                run(path, self.root / "o", "--study", "spans"), f"{name}.db: holds a value that no study writes"
            )

    def test_studies_by_name(self):
        self.expect(run(self.database, self.root / "o"), "2 studies; name one with --study, of: empty, spans")
        self.expect(run(self.database, self.root / "o", "--study", "span"), 'no study "span"; it has: empty, spans')
        self.assertFalse((self.root / "o").exists())

    def test_a_locked_database_is_told_after_a_while(self):
        path = self.changed("locked.db")
        writer = sqlite3.connect(path, isolation_level=None)
        writer.execute("BEGIN EXCLUSIVE")
        self.addCleanup(writer.close)
        self.expect(run(path, self.root / "o", "--study", "spans"), "database is locked")

    def test_folder_that_cannot_be(self):
        self.expect(run(self.database, self.database, "--study", "spans"), "t.db: cannot write: File exists")
        self.expect(run(self.database, self.database / "below", "--study", "spans"), "cannot write: Not a directory")

    def test_full_disk_leaves_nothing_and_old_files_as_they_were(self):
        out = self.root / "full"
        out.mkdir()
        (out / "pareto.svg").write_text("older")
        self.expect(
            run(self.database, out, "--study", "spans", limit=200_000), "report.html: cannot write: File too large"
        )
        self.assertEqual([(path.name, path.read_text()) for path in out.iterdir()], [("pareto.svg", "older")])


if __name__ == "__main__":
    unittest.main()
