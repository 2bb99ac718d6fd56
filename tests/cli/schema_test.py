# SPDX-License-Identifier: Apache-2.0
"""The JSON schema of configurations takes what the program takes, and refuses what one key alone makes wrong."""

import copy
import json
import os
import pathlib
import subprocess
import tempfile
import tomllib
import unittest

import jsonschema

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ["BITSPAN_PROGRAM"]


def bitspan(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)


def leaves(table, path=()):
    for name, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*path, name))
        else:
            yield (*path, name), value


def toml(table):
    """A TOML text of a dotted key per line."""
    return "".join(f"{'.'.join(map(json.dumps, path))} = {json.dumps(value)}\n" for path, value in leaves(table))


class Schema(unittest.TestCase):
    def setUp(self):
        self.schema = json.loads(bitspan("config", "schema").stdout)
        jsonschema.Draft202012Validator.check_schema(self.schema)
        self.validator = jsonschema.Draft202012Validator(self.schema)
        self.shipped = [tomllib.loads(path.read_text()) for path in sorted((SOURCE / "config").glob("*.toml"))]

    def both(self, table):
        """Whether the schema takes a table, and whether the program takes it."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "c.toml"
            path.write_text(toml(table))
            done = bitspan("config", "check", path)
        self.assertIn(done.returncode, (0, 2), done.stderr)
        return self.validator.is_valid(table), done.returncode == 0

    def test_shipped_and_canonical_texts_are_valid(self):
        self.assertGreaterEqual(len(self.shipped), 3)
        for table in self.shipped:
            self.assertEqual(self.both(table), (True, True))
        for name in ("depth16", "depth20", "narrow"):
            text = bitspan("config", "show", "--toml", name).stdout
            self.assertGreater(len(text), 1000)
            self.validator.validate(tomllib.loads(text))

    def test_every_key_of_another_type_or_left_out_is_as_the_program_says(self):
        table = self.shipped[0]
        refused = 0
        for path, value in leaves(table):
            for other in ("no such value", 10**6, True, None):
                if type(other) is type(value):
                    continue
                changed = copy.deepcopy(table)
                inner = changed
                for name in path[:-1]:
                    inner = inner[name]
                if other is None:
                    del inner[path[-1]]
                else:
                    inner[path[-1]] = other
                valid, legal = self.both(changed)
                # Rules between keys are the program's alone.
                self.assertTrue(valid or not legal, f"{path} = {other}")
                refused += not valid
        self.assertGreater(refused, 500)

    def test_unknown_keys_names_and_ranges_are_refused(self):
        for path, value in ((("raster", "nothing"), 1), (("nothing",), 1), (("depth", "bits"), 33),
                            (("perspective", "mode"), "none"), (("formats", "span.h", "words"), 20),
                            (("texture", "transparent"), [1, 2]), (("start_offset", "span_h"), "one")):
            changed = copy.deepcopy(self.shipped[0])
            inner = changed
            for name in path[:-1]:
                inner = inner[name]
            inner[path[-1]] = value
            self.assertEqual(self.both(changed), (False, False), path)

    def test_it_is_written_to_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "s.json"
            self.assertEqual(bitspan("config", "schema", "-o", path).returncode, 0)
            self.assertEqual(json.loads(path.read_text()), self.schema)
            self.assertEqual(bitspan("config", "schema", "-o", path / "no").returncode, 2)


if __name__ == "__main__":
    unittest.main()
