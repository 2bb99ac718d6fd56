# SPDX-License-Identifier: Apache-2.0
"""The JSON schemas take what the program takes and writes, and refuse what one key alone makes wrong."""

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
        keys = list(leaves(table))
        part = 1
        if "BITSPAN_GATE" in os.environ:  # a quarter of them, as tests/support/long_run.hpp has it
            part = 4
            keys = keys[int(os.environ["BITSPAN_GATE"]) % part::part]
        for path, value in keys:
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
        self.assertGreater(refused, 500 // part)

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


def validator(name):
    """Of a schema in schema/, which may refer to those beside it."""
    path = SOURCE / "schema" / f"{name}.schema.json"
    schema = json.loads(path.read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema, resolver=jsonschema.RefResolver(path.as_uri(), schema))


class Files(unittest.TestCase):
    def test_vectors_of_each_format(self):
        wanted = validator("vectors")
        with tempfile.TemporaryDirectory() as folder:
            for form in ("hex", "json", "npy"):
                out = pathlib.Path(folder) / form
                done = bitspan("vectors", "demo", "--size", "48x36", "--stage", "span", "--format", form, "-o", out)
                self.assertEqual(done.returncode, 0, done.stderr)
                file = json.loads((out if form == "json" else out / "vectors.json").read_text())
                wanted.validate(file)
                self.assertGreater(len(file["scene"]["triangles"]), 100)
                for change in (lambda f: f.update(bitspan_vectors=2), lambda f: f["scene"]["triangles"][0]["v"].pop(),
                               lambda f: f["scene"]["textures"][0].update(rgba="00ff"), lambda f: f.pop("scene"),
                               lambda f: f["tables"][0]["fields"][0].update(word="32"), lambda f: f.update(stage=7)):
                    changed = copy.deepcopy(file)
                    change(changed)
                    self.assertFalse(wanted.is_valid(changed))

    def test_scenes_with_texel_formats(self):
        wanted = validator("vectors")
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "v.json"
            sea = SOURCE / "tests/data/sea.tri"
            self.assertEqual(bitspan("vectors", sea, "--stage", "merge", "--format", "json", "-o", out).returncode, 0)
            file = json.loads(out.read_text())
            wanted.validate(file)
            self.assertEqual(file["scene"]["textures"][0]["format"], "noise")
            for change in ({"rgba": "00000000"}, {"raw": "0"}, {"table": "1"}, {"colors": []}):
                changed = copy.deepcopy(file)
                changed["scene"]["textures"][0].update(change)
                self.assertFalse(wanted.is_valid(changed), change)

    def test_a_replay_has_the_scene_that_vectors_have(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "v.json"
            self.assertEqual(bitspan("vectors", "demo", "--size", "48x36", "--stage", "merge", "--format", "json", "-o", out).returncode, 0)
            vectors = json.loads(out.read_text())
            replay = {"bitspan_replay": 1, "engines": ["golden", "model"], "stall_seed": 1, "scene": vectors["scene"],
                      "config": vectors["configuration"]["toml"]}
            wanted = validator("replay")
            path = pathlib.Path(folder) / "r.json"
            for change, legal in ((lambda r: None, True), (lambda r: r.update(bitspan_replay=2), False), (lambda r: r.pop("engines"), False),
                                  (lambda r: r["scene"].update(focal="far"), False), (lambda r: r.update(stall_seed="x"), False)):
                changed = copy.deepcopy(replay)
                change(changed)
                path.write_text(json.dumps(changed))
                self.assertEqual(wanted.is_valid(changed), legal)
                done = bitspan("replay", path)
                self.assertEqual(done.returncode, 0 if legal else 2, done.stdout + done.stderr)

    def test_maps(self):
        wanted = validator("map")
        maps = [path for folder in ("dv", "examples", "tests/dv") for path in (SOURCE / folder).rglob("*.toml")
                if "input" in tomllib.loads(path.read_text())]
        self.assertGreaterEqual(len(maps), 4)
        for path in maps:
            table = tomllib.loads(path.read_text())
            wanted.validate(table)
            for change in (lambda t: t.update(clocks="clk"), lambda t: t["input"].update(stage="depth"), lambda t: t["output"].pop("valid"),
                           lambda t: t["output"].update(ports={}), lambda t: t["input"]["ports"].update(p=3), lambda t: t.pop("clock"),
                           lambda t: t["output"]["ports"].update(p={"field": "u", "fields": ["v"]}), lambda t: t.update(reset_active="up")):
                changed = copy.deepcopy(table)
                change(changed)
                self.assertFalse(wanted.is_valid(changed))


if __name__ == "__main__":
    unittest.main()
