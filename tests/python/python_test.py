# SPDX-License-Identifier: Apache-2.0
"""The Python package: from a build tree, and as a wheel in an environment of its own."""

import contextlib
import gc
import json
import os
import pathlib
import pickle
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock

try:
    import numpy as np

    import bitspan
except ImportError as error:
    print(f"python_test: skipped: {error}; ./dev setup installs what the package needs", file=sys.stderr)
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ["BITSPAN_BUILD"])
PROGRAM = os.environ["BITSPAN_PROGRAM"]
LONG = os.environ.get("BITSPAN_LONG") == "1"
PIXEL_STAGES = ("span", "depth", "texture", "fog", "merge")


def address(array):
    return array.__array_interface__["data"][0]


def run(*command, cwd=None, env=None):
    """Runs a command and returns what it says; fails where it does."""
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          encoding="utf-8", errors="replace")
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}")
    return done.stdout


def resident():
    """Kilobytes of this process in memory."""
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path("/proc/self/status").read_text())[1])


def triangle(x=8.0, y=8.0, size=40.0, s=5.0):
    return [[[x, y, s, 0, 0], [x + size, y, s, 16, 0], [x, y + size, s, 0, 16]]]


def small(engine="model", **settings):
    return bitspan.render("demo", bitspan.Config().with_(settings), engine, width=80, height=60)


class Configs(unittest.TestCase):
    def test_from_a_name_a_path_and_a_text(self):
        path = SOURCE / "config/depth20.toml"
        configs = [bitspan.Config("depth20"), bitspan.Config(path), bitspan.Config(str(path)), bitspan.Config(path.read_text())]
        self.assertEqual(len({c.hash for c in configs}), 1)
        self.assertRegex(configs[0].hash, r"^[0-9a-f]{16}$")
        self.assertIn(configs[0].hash, run(PROGRAM, "config", "show", "depth20"))
        self.assertEqual(configs[0], configs[3])
        self.assertEqual(configs[0].name, "depth20")

    def test_the_text_reads_back(self):
        config = bitspan.Config("narrow").with_({"formats.span.uv.word": 20})
        self.assertEqual(bitspan.Config(config.text), config)
        self.assertRegex(repr(config), r"^<bitspan.Config narrow, formats.span.uv.word = 20 \([0-9a-f]{16}\)>$")
        self.assertEqual(pickle.loads(pickle.dumps(config)), config)
        self.assertEqual(len({config, bitspan.Config(config.text), bitspan.Config("narrow")}), 2)

    def test_keys_of_each_type(self):
        base = bitspan.Config("depth16")
        changed = base.with_({"formats.span.uv.word": np.int64(23), "texture.transparent": [255, 0, 255], "perspective.mode": "affine"})
        self.assertEqual(changed.field("span.u").word, 23)
        self.assertRegex(changed.text, r"transparent = \[ ?255, 0, 255 ?\]")
        self.assertIn('"affine"', changed.text)
        self.assertEqual(base, bitspan.Config("depth16"))
        self.assertNotEqual(base, changed)

    def test_rules_between_keys_hold_for_all_settings_together(self):
        base = bitspan.Config("depth16")
        with self.assertRaisesRegex(bitspan.InputError, "reciprocal.pixel.index_bits: is 9 with operand_bits = 5"):
            base.with_({"reciprocal.pixel.operand_bits": 5})
        together = base.with_({"reciprocal.pixel.operand_bits": 5, "reciprocal.pixel.index_bits": 4})
        self.assertIn("operand_bits = 5", together.text)

    def test_fields(self):
        config = bitspan.Config("depth16")
        u = config.field("span.u")
        self.assertEqual(u, ("u", 25, 8, True, "texel"))
        self.assertEqual(config.field("span.x"), ("x", 0, 0, False, ""))
        for stage, count in zip(bitspan.STAGES, (6, 29, 14, 42, 24, 25, 31, 16, 8, 16, 10, 7)):
            self.assertEqual(len(config.fields(stage)), count, stage)


class Scenes(unittest.TestCase):
    def test_demo_and_sizes(self):
        self.assertEqual((bitspan.Scene().width, bitspan.Scene().height), (640, 480))
        scene = bitspan.Scene("demo", 80, 60)
        self.assertEqual((scene.width, scene.height, scene.name), (80, 60, "demo"))
        self.assertEqual(scene.vertices.shape, (len(scene), 3, 22))
        self.assertTrue(bitspan.Scene(SOURCE / "tests/data/spot.obj", 64, 48).vertices.shape[0] > 1000)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.obj"
            path.write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\nf 3 2 1\np 1\n")
            self.assertEqual(len(bitspan.Scene(path).notes), 1)
        self.assertEqual(bitspan.Scene("demo").notes, [])

    def test_numbered_cameras_are_those_of_the_program(self):
        from matplotlib import image

        spot = SOURCE / "tests/data/spot.obj"
        for name in ("demo@3", f"{spot}@3"):
            with tempfile.TemporaryDirectory() as folder:
                run(PROGRAM, "render", name, "--size", "80x60", "-o", f"{folder}/seen.png")
                picture = np.round(image.imread(f"{folder}/seen.png") * 255).astype(np.uint8)
            scene = bitspan.Scene(name, 80, 60)
            self.assertTrue(scene.name.endswith("@3"), scene.name)
            self.assertTrue(np.array_equal(bitspan.render(scene).color[..., :3], picture[..., :3]), name)
        self.assertFalse(np.array_equal(bitspan.render("demo@3", width=80, height=60).color, small("model").color))
        with self.assertRaisesRegex(bitspan.InputError, "demo@x"):
            bitspan.Scene("demo@x")

    def test_the_arrays_of_a_scene_make_the_same_scene(self):
        demo = bitspan.Scene("demo", 80, 60)
        again = bitspan.Scene.from_vertices(demo.vertices, 80, 60, s_range=demo.s_range)
        self.assertTrue(np.array_equal(again.vertices, demo.vertices))
        first, second = bitspan.render(demo), bitspan.render(again)
        self.assertTrue(np.array_equal(first.table("span"), second.table("span")))

    def test_columns_that_are_left_out_have_defaults(self):
        scene = bitspan.Scene.from_vertices(np.array(triangle())[..., :3], 64, 64)
        self.assertEqual(scene.vertices[0, 1].tolist(), [48, 8, 5, 0, 0, 1, 1, 1, 1, -1, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0])
        self.assertEqual(scene.texture_of.tolist(), [-1])

    def test_textures_fog_and_background(self):
        texels = np.zeros((16, 16, 3), np.uint8)
        texels[..., 1] = 200
        scene = bitspan.Scene.from_vertices(triangle(), 64, 64, texture=0, textures=[texels], background=(1, 2, 3))
        picture = bitspan.render(scene).color
        self.assertEqual(picture[60, 60].tolist(), [1, 2, 3, 255])
        self.assertEqual(picture[12, 12].tolist(), [0, 200, 0, 255])
        fogged = bitspan.render(bitspan.Scene.from_vertices(triangle(), 64, 64, texture=0, textures=[texels], fog=((255, 0, 0), 4.0)))
        self.assertGreater(int(fogged.color[12, 12, 0]), 20)

    def test_shadows(self):
        config = bitspan.Config("depth16").with_({"project.unit": "reciprocal"})
        spot = SOURCE / "tests/data/spot.obj"
        lamp = (-12, 16, -2, 0, 2, -26, 60)
        for source, light in (("demo", lamp), ("demo@2", (0, -20, 0)), (spot, (3, 4, -3))):
            plain, lit = bitspan.Scene(source, 80, 60), bitspan.Scene(source, 80, 60, shadow=light, shadow_map=64)
            self.assertGreater(len(lit), len(plain))
            self.assertTrue((lit.vertices[-1, :, 12] != 0).all())
            first, second = bitspan.render(lit, config), bitspan.render(lit, config, engine="golden")
            self.assertTrue(np.array_equal(first.color, second.color))
            self.assertTrue(np.array_equal(first.table("project"), second.table("project")))
            self.assertGreater(len(first.table("project")), 100)
            self.assertFalse(np.array_equal(first.color, bitspan.render(plain, config).color), source)
        dark = bitspan.render(bitspan.Scene("demo", 80, 60, shadow=lamp, shadow_map=64, shadow_dark=0), config)
        lit = bitspan.render(bitspan.Scene("demo", 80, 60, shadow=lamp, shadow_map=64, shadow_dark=1), config)
        self.assertLess(dark.color[..., :3].sum(), lit.color[..., :3].sum())
        with self.assertRaisesRegex(bitspan.InputError, "project.unit"):
            bitspan.render(bitspan.Scene("demo", 80, 60, shadow=(30, 60, 0)))
        for bad in ({"shadow": (1, 2)}, {"shadow": 3}, {"shadow": "abc"}, {"shadow": (1, 2, float("nan"))}, {"shadow_map": 0}, {"shadow_map": 1.5},
                    {"shadow_bias": -2}, {"shadow_bias": "x"}, {"shadow_dark": 2}, {"shadow": (0, 9, 0, 0, 0, 9, 160)}, {"frame": -1}, {"frame": 0}):
            with self.assertRaises(bitspan.InputError, msg=str(bad)):
                bitspan.Scene("demo", 80, 60, **({"shadow": (30, 60, 0)} | bad))

    def test_projectors(self):
        config = bitspan.Config("depth16").with_({"project.unit": "reciprocal"})
        corners = np.zeros((1, 3, 16))
        corners[..., :5] = [[(8, 8, 5, 0, 0), (48, 8, 5, 0, 0), (8, 48, 5, 0, 0)]]
        corners[..., 5:9], corners[..., 9], corners[..., 13] = 1, -1, -1
        corners[..., 10:12], corners[..., 12] = 4, 2  # texel (2, 2)
        texels = np.zeros((4, 4, 3), np.uint8)
        texels[2, 2] = (10, 200, 30)
        scene = bitspan.Scene.from_vertices(corners, 64, 64, textures=[texels], projector=(1.0, 8.0))
        self.assertTrue(np.array_equal(scene.vertices[..., :16], corners))
        with bitspan.Model(config) as model:
            model.begin(scene)
            model.state({"texture1": 0, "texture1.coordinates": "project", "texture1.op": "replace"})
            model.draw(scene)
            self.assertEqual(np.array(model.plane("color"))[12, 12, :3].tolist(), [10, 200, 30])
            model.view(projector=None)
            model.state({"depth.func": "always"})
            model.draw(scene)
            self.assertEqual(np.array(model.records("project"))["inside"][-1], 0)
            model.view(projector=(2, 9))
        for bad in ((1.0,), (2.0, 1.0), 3, ("a", "b")):
            with self.assertRaises(bitspan.InputError):
                bitspan.Scene.from_vertices(corners, 64, 64, projector=bad)

    def test_lights(self):
        config = bitspan.Config("depth16").with_({"light.at": "pixel"})
        corners = np.zeros((1, 3, 22))
        corners[..., :5] = [[(8, 8, 5, 0, 0), (48, 8, 5, 0, 0), (8, 48, 5, 0, 0)]]
        corners[..., 5:9], corners[..., 9], corners[..., 13], corners[..., 18] = 1, -1, -1, -1
        scene = bitspan.Scene.from_vertices(corners, 64, 64, light=bitspan.Light(direction=(0.8, 0, -0.6), ambient=0.0))
        self.assertTrue(np.array_equal(scene.vertices, corners))
        with bitspan.Model(config) as model:
            model.begin(scene)
            model.draw(scene)
            self.assertEqual(np.array(model.plane("color"))[12, 12, 0], 153)  # 255 times 0.6
            self.assertGreater(len(model.records("light")), 700)
            model.view(light=None)
            model.state({"depth.func": "always"})
            model.draw(scene)
            self.assertEqual(np.array(model.plane("color"))[12, 12, 0], 255)
            model.view(light=bitspan.Light(direction=(0, 0, 1), ambient=0.2))
            model.draw(scene)
            self.assertEqual(np.array(model.plane("color"))[12, 12, 0], 51)
        # Beside the light, by a quarter of the brightness at the reach.
        falling = config.with_({"light.source": "point", "light.law": "lunar", "light.fall": "second"})
        lamp = bitspan.Light(position=(0, 0, 0), ambient=0.0, lunar=1.0, reach=5.0, offset=1.0)
        scene = bitspan.Scene.from_vertices(corners, 64, 64, light=lamp)
        with bitspan.Model(falling) as model:
            model.begin(scene)
            model.draw(scene)
            self.assertAlmostEqual(np.array(model.plane("color"))[12, 12, 0], 64, delta=1)
            model.view(light=lamp)
        for bad in (bitspan.Light(), bitspan.Light((0, 0, 1), (0, 0, 1)), bitspan.Light((0, 0)), bitspan.Light(("a", 0, 1)),
                    bitspan.Light((0, 0, 1), ambient=2), bitspan.Light((0, 0, 0)), bitspan.Light((0, 0, 1), exponent=0)):
            with self.assertRaises(bitspan.InputError):
                bitspan.Scene.from_vertices(corners, 64, 64, light=bad)

    def test_candidates(self):
        corners = np.zeros((2, 3, 9))
        corners[..., :5] = triangle()[0]
        corners[..., 2] = [[5], [9]]  # the nearer one first
        corners[..., 5:8], corners[..., 8] = [[[1, 0, 0]], [[0, 0, 1]]], 0.5
        scene = bitspan.Scene.from_vertices(corners, 64, 64, background=(0, 0, 0))
        with bitspan.Model("depth16") as model:
            model.begin(scene)
            model.state({"translucency.pass": "candidate"})
            for expected in ([0, 0, 128, 255], [128, 0, 64, 255]):
                model.draw(scene)
                self.assertGreater(len(model.records("candidate")), 700)
                model.resolve()
                self.assertEqual(np.array(model.plane("color"))[12, 12].tolist(), expected)
            model.draw(scene)
            model.resolve()
            self.assertEqual(np.array(model.plane("color"))[12, 12].tolist(), expected)

    def test_own_depth(self):
        corners = np.zeros((1, 3, 16))
        corners[..., :5] = [[(8, 8, 5, 0, 0), (48, 8, 9, 0, 0), (8, 48, 2, 0, 0)]]
        corners[..., 5:9], corners[..., 9], corners[..., 13] = 1, -1, 0.25
        config = bitspan.Config("depth16").with_({"depth.line": "z"})
        drawn = bitspan.render(bitspan.Scene.from_vertices(corners, 64, 64), config)
        self.assertEqual(set(drawn.depth[drawn.triangle >= 0]), {49151})
        by_distance = bitspan.render(bitspan.Scene.from_vertices(corners[..., :13], 64, 64), config)
        self.assertGreater(len(set(by_distance.depth[by_distance.triangle >= 0])), 100)

    def test_textures_of_texel_formats(self):
        raw = np.full((8, 4), 31 << 11, "<u2")  # red of rgb565
        red = bitspan.Texels("rgb565", raw.tobytes(), 4, 8)
        scene = bitspan.Scene.from_vertices(triangle(), 64, 64, texture=0, textures=[red])
        self.assertEqual(bitspan.render(scene).color[12, 12].tolist(), [255, 0, 0, 255])
        table = np.zeros((256, 4), int)
        table[7] = [0, 0, 200, 255]
        blue = bitspan.Texels("p8", bytes([7] * 32), 4, 8, table)
        scene = bitspan.Scene.from_vertices(triangle(), 64, 64, texture=1, textures=[red, blue])
        self.assertEqual(bitspan.render(scene).color[12, 12].tolist(), [0, 0, 200, 255])
        for bad in (bitspan.Texels("rgb5", b"", 1, 1), bitspan.Texels("i8", b"12", 1, 1), bitspan.Texels("p8", b"1", 1, 1),
                    bitspan.Texels("i8", "text", 1, 1), bitspan.Texels("i8", b"1", 0, 1)):
            with self.assertRaises(bitspan.InputError):
                bitspan.Scene.from_vertices(triangle(), 64, 64, texture=0, textures=[bad])

    def test_a_scene_outlives_its_handle(self):
        vertices = bitspan.Scene("demo", 80, 60).vertices
        gc.collect()
        self.assertEqual(vertices.shape[1:], (3, 22))
        self.assertTrue(np.isfinite(vertices).all())
        self.assertFalse(vertices.flags.writeable)


class Records(unittest.TestCase):
    def test_planes(self):
        drawn = small()
        self.assertEqual([(p.shape, p.dtype.name) for p in (drawn.color, drawn.depth, drawn.u, drawn.v, drawn.triangle)],
                         [((60, 80, 4), "uint8"), ((60, 80), "uint32"), ((60, 80), "float64"), ((60, 80), "float64"), ((60, 80), "int32")])
        self.assertTrue((drawn.color[..., 3] == 255).all())

    def test_positions(self):
        drawn = small()
        position = drawn.position
        self.assertEqual((position.shape, position.dtype.name), ((60, 80, 3), "float64"))
        covered = drawn.triangle >= 0
        self.assertTrue(np.isnan(position[~covered]).all())
        self.assertTrue(np.isfinite(position[covered]).all())
        # Along its ray: x / s = (column - middle) / focal.
        columns = np.broadcast_to(np.arange(80) + 0.5 - 40, (60, 80))[covered]
        ratio = position[covered][:, 0] / position[covered][:, 2] / columns
        self.assertLess(np.ptp(ratio), 1e-12)

    def test_a_slide_on_a_height_field_lies_where_the_matrix_route_lays_it(self):
        # Every eighth elevation of Matplotlib's sample, a corner each. Vertices are snapped to 2^-10 pixel, and a texel is about a pixel.
        from matplotlib import cbook, image
        elevation = np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False))["elevation"].astype(float)[::8, ::8]
        rows, columns = elevation.shape
        z, x = 2 * np.mgrid[:rows, :columns]
        corners = np.stack([x - columns, (elevation - elevation.min()) / 40, z - rows], axis=-1).reshape(-1, 3)
        first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1) + 1
        faces = np.concatenate([first + [0, columns, 1], first + [1, columns, columns + 1]])
        eye, projector, aim = np.array([40.0, 70, 90]), np.array([0.0, 80, 30]), np.array([0.0, 3, 0])
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "field.obj").write_text("".join("v %r %r %r\n" % tuple(p) for p in corners.tolist()) + "".join("f %d %d %d\n" % tuple(f) for f in faces))
            image.imsave(folder / "slide.png", np.full((96, 128, 3), 0.8))
            config = bitspan.Config("depth20").with_({"project.unit": "reciprocal", "raster.subpixel_bits": 10})
            (folder / "fine.toml").write_text(config.text)
            run(PROGRAM, "render", "field.obj", "--config", "fine.toml", "--size", "160x120", "--camera", "40,70,90", "--no-cull",
                "--slide", "slide.png", "--slide-from=0,80,30,0,3,0,50", "--emit-tri", "field.tri", "-o", "field.png", cwd=folder)
            scene = bitspan.Scene(folder / "field.tri")
            records = bitspan.render(scene, config, trace=True).records("project")
            (folder / "s.toml").write_text(
                '[study]\nname = "s"\nbase = "fine.toml"\nscenes = ["field.tri"]\nmetrics = ["project.s.max", "project.t.max"]\n'
                '[[vary]]\nkeys = ["depth.bits"]\nvalues = [20]\n[[constraint]]\nmetric = "project.s.max"\nat_most = 1\n'
                "[report]\nbounds = true\n")
            run(PROGRAM, "study", "s.toml", "--db", "s.db", cwd=folder)
            with contextlib.closing(sqlite3.connect(folder / "s.db")) as db:
                proved = dict(db.execute("SELECT place, bound FROM bounds WHERE place LIKE 'span.uv (project)%'"))

        def axes(position, target):
            forward = (target - position) / np.linalg.norm(target - position)
            right = np.cross(forward, [0, 1, 0])
            right /= np.linalg.norm(right)
            return np.stack([right, np.cross(forward, right), forward])

        # In double: the point of the surface that each pixel shows goes by the projector's matrix. The bound is of snapped vertices.
        view = axes(eye, (corners.min(axis=0) + corners.max(axis=0)) / 2)
        focal = 60 / np.tan(np.radians(20))
        v = scene.vertices[records["triangle"]]
        place = np.stack([(v[..., 0] - 80) / focal * v[..., 2], (v[..., 1] - 60) / focal * v[..., 2], v[..., 2]], axis=-1)
        corner = np.stack([np.floor(v[..., 0] * 1024 + 0.5), np.floor(v[..., 1] * 1024 + 0.5)], axis=-1) / 1024
        pixel = np.stack([records["x"], records["y"]], axis=-1)[:, None] + 0.5
        side = np.roll(corner, -1, axis=1) - pixel, np.roll(corner, 1, axis=1) - pixel
        share = (side[0][..., 0] * side[1][..., 1] - side[0][..., 1] * side[1][..., 0]) / v[..., 2]
        point = (share[..., None] * place).sum(axis=1) / share.sum(axis=1)[:, None]
        seen = (point @ view + eye - projector) @ axes(projector, aim).T
        throw = 48 / np.tan(np.radians(25))
        s, t = 64 + throw * seen[:, 0] / seen[:, 2], 48 + throw * seen[:, 1] / seen[:, 2]
        inside = records["inside"] == 1
        ulp = 2.0 ** -config.field("span.u").fraction
        self.assertGreater(inside.sum(), 3000)
        within = (s > 1) & (s < 127) & (t > 1) & (t < 95)
        self.assertEqual((within & ~inside).sum(), 0)
        for name, ideal in (("s", s), ("t", t)):
            off = np.abs(records[name] * ulp - ideal)[inside].max()
            bound = proved[f"span.uv (project) ({name})"]
            print(f"{inside.sum()} pixels in the slide, {name} at most {off:.5f} texels off, {bound:.5f} by the bound")
            self.assertLess(off, bound)
            self.assertLess(bound, 1 / 64)

    def test_frames_of_a_stream(self):
        sea = SOURCE / "tests/data/sea.tri"
        pictures = []
        for frame in range(3):
            pictures.append(bitspan.render(bitspan.Scene(sea, frame=frame)).color)
        self.assertFalse(np.array_equal(pictures[0], pictures[2]))
        with self.assertRaisesRegex(bitspan.InputError, "0..2"):
            bitspan.Scene(sea, frame=3)
        with self.assertRaisesRegex(bitspan.InputError, "no dynamic textures"):
            bitspan.Scene("demo", frame=0)

    def test_a_binary_stream_by_its_contents(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.bin"
            subprocess.run([sys.executable, SOURCE / "examples/trib/write_trib.py", path], check=True)
            scene = bitspan.Scene(path)
            self.assertEqual((scene.width, scene.vertices.shape[0]), (640, 16))
            path.write_bytes(path.read_bytes()[:1000])
            with self.assertRaisesRegex(bitspan.InputError, "byte 1000: the file ends"):
                bitspan.Scene(path)

    def test_the_picture_is_that_of_the_program(self):
        from matplotlib import image

        with tempfile.TemporaryDirectory() as folder:
            run(PROGRAM, "render", "demo", "--size", "80x60", "-o", f"{folder}/demo.png")
            picture = np.round(image.imread(f"{folder}/demo.png") * 255).astype(np.uint8)
        self.assertTrue(np.array_equal(picture[..., :3], small().color[..., :3]))

    def test_every_stage_has_its_records_by_name(self):
        drawn = small()
        for stage in bitspan.STAGES:
            records, table = drawn.records(stage), drawn.table(stage)
            names = tuple(field.name for field in drawn.config.fields(stage))
            self.assertEqual(records.dtype.names, names)
            self.assertEqual(table.shape, (len(records), len(names)))
            for column, name in enumerate(names):
                self.assertTrue(np.array_equal(records[name], table[:, column]))
            if stage != "depth":
                self.assertTrue(np.array_equal(getattr(drawn, stage.replace(".", "_")), records))
        self.assertEqual(len(drawn.constants), 1)
        self.assertEqual(drawn.counters["fragments"], len(drawn.span))
        self.assertEqual(drawn.counters["written"], len(drawn.merge))

    def test_plane_rows(self):
        drawn = small(**{"perspective.mode": "const_depth_rows"})
        self.assertEqual(len(drawn.edge_walk), 0)
        self.assertGreater(len(drawn.plane_walk_row), 10)

    def test_decoded_values(self):
        drawn = small()
        self.assertTrue(np.array_equal(drawn.real("span.u"), drawn.span["u"] / 256))
        self.assertEqual(drawn.real("span.u").dtype, np.float64)
        # The picture shows the u of the fragment written last.
        last = {(r["x"], r["y"]): r["u"] for r in drawn.span if drawn.triangle[r["y"], r["x"]] == r["triangle"]}
        (x, y), raw = next(iter(last.items()))
        self.assertEqual(drawn.u[y, x], raw / 256)

    def test_engines(self):
        model, golden = small(), small("golden")
        for stage in bitspan.STAGES:
            self.assertTrue(np.array_equal(model.table(stage), golden.table(stage)), stage)
        self.assertTrue(np.array_equal(model.color, small("timed").color))
        self.assertGreater(small("timed").counters["cycles"], 1000)
        self.assertIn("engine golden, configuration depth16", golden.text)
        with self.assertRaisesRegex(bitspan.InputError, "engine ideal has no records"):
            small("ideal").records("span")
        untraced = bitspan.render("demo", trace=False, width=80, height=60)
        self.assertTrue(np.array_equal(untraced.color, model.color))
        with self.assertRaisesRegex(bitspan.StateError, "drawn without records"):
            untraced.records("span")

    def test_data_folder(self):
        self.assertTrue((bitspan.data_folder() / "rtl/span_interpolator.sv").is_file())


class Views(unittest.TestCase):
    def test_arrays_are_views_without_a_copy(self):
        drawn = small()
        for stage in bitspan.STAGES:
            table, records = drawn.table(stage), drawn.records(stage)
            if len(table) == 0:
                continue
            self.assertIsNotNone(table.base)
            self.assertFalse(table.flags.owndata or records.flags.owndata)
            self.assertFalse(table.flags.writeable or records.flags.writeable)
            # Two arrays of the same memory: neither is a copy.
            self.assertEqual({address(table), address(records), address(drawn.table(stage))}, {address(table)})
            for column, field in enumerate(drawn.config.fields(stage)):
                self.assertEqual(address(records[field.name]), address(table) + 8 * column)
        for plane in ("color", "depth", "u", "v", "triangle"):
            array = getattr(drawn, plane)
            self.assertIsNotNone(array.base)
            self.assertFalse(array.flags.owndata or array.flags.writeable)
            self.assertEqual(address(array), address(getattr(drawn, plane)))
        with self.assertRaises(ValueError):
            drawn.color[0, 0, 0] = 1

    def test_they_outlive_run_model_and_scene(self):
        drawn = small()
        copies = {stage: drawn.table(stage).copy() for stage in bitspan.STAGES}
        tables = {stage: drawn.table(stage) for stage in bitspan.STAGES}
        column, picture, colors = drawn.span["u"], drawn.color, drawn.color.copy()
        del drawn
        gc.collect()
        # What would take the memory: a run like it of another scene, and others.
        others = [bitspan.render("demo", width=64, height=48), *(small("golden", **{"formats.span.uv.word": 20}) for _ in range(3))]
        for stage, table in tables.items():
            self.assertTrue(np.array_equal(table, copies[stage]), stage)
        self.assertTrue(np.array_equal(picture, colors))
        del tables, others
        gc.collect()
        self.assertTrue(np.array_equal(column, copies["span"][:, 10]))

    def test_a_model_does_not_draw_below_a_view(self):
        scene = bitspan.Scene("demo", 80, 60)
        model = bitspan.Model()
        model.begin(scene)
        model.draw(scene)
        column = model.records("span")["u"]
        kept = column.copy()
        row = model.records("span_setup")[3].copy()
        self.assertEqual(model.views, 1)
        for call in (lambda: model.begin(scene), lambda: model.draw(scene), model.clear_records, lambda: model.row("span_setup", row)):
            with self.assertRaisesRegex(bitspan.StateError, "1 arrays show the model's memory"):
                call()
        self.assertTrue(np.array_equal(column, kept))
        model.close()
        self.assertTrue(np.array_equal(column, kept))
        with self.assertRaisesRegex(bitspan.StateError, "is closed"):
            model.records("span")
        del column
        with bitspan.Model() as model:
            model.begin(scene)
            model.draw(scene)
            model.records("span")
            model.begin(scene)

    def test_a_run_takes_memory_over_only_where_no_array_shows_it(self):
        first = small()
        where, kept, copy = address(first.table("span")), first.table("span"), first.table("span").copy()
        del first
        second = small()
        self.assertNotEqual(address(second.table("span")), where)
        self.assertTrue(np.array_equal(kept, copy))
        where = address(second.table("span"))
        del second
        third = small()
        self.assertEqual(address(third.table("span")), where)
        self.assertNotEqual(address(small("golden").table("span")), where)
        untraced = bitspan.render("demo", trace=False, width=80, height=60)
        del third, untraced
        self.assertTrue(np.array_equal(small().table("span"), copy))

    def test_memory_is_given_back(self):
        def draw(n):
            for i in range(n):
                small(**{"formats.span.uv.word": 20 + i % 5}).table("span")
                bitspan.Scene("demo", 80, 60)
                with self.assertRaises(bitspan.InputError):
                    bitspan.Config("a = 1\nb = \n")

        draw(20)
        before = resident()
        draw(100)
        # A run has 5 MB; ASan keeps freed memory for a while.
        self.assertLess(resident() - before, 60_000 if "asan" not in os.environ.get("LD_PRELOAD", "") else 300_000)


class Runs(unittest.TestCase):
    def test_many_runs_of_640x480(self):
        """Arrays of many runs, each kept for some runs beyond its own. Two scenes take turns, so that memory that another run
        has taken holds other values; and the module itself reads the arrays, since NumPy is not sanitized."""
        count = 10_000 if LONG else 24
        demo, config = bitspan.Scene("demo"), bitspan.Config()
        scenes = demo, bitspan.Scene.from_vertices(demo.vertices[::-1], 640, 480, s_range=demo.s_range)
        runs = [bitspan.render(scene, config) for scene in scenes]
        sums = [{stage: int(run.table(stage).sum()) for stage in PIXEL_STAGES} for run in runs]
        pictures = [int(run.color.sum()) for run in runs]
        errors = [run.error("span.u")[:500] for run in runs]
        self.assertNotEqual(sums[0], sums[1])
        del runs
        kept = []
        for i in range(count):
            drawn = bitspan.render(scenes[i % 2], config)
            kept.append((i % 2, drawn.color, drawn.table(PIXEL_STAGES[i % 5]), PIXEL_STAGES[i % 5], drawn.table("span")[:500]))
            del drawn
            # Most runs take over the memory of the one before; every fourth one must not.
            while len(kept) > (1 if i % 4 == 3 else 0):
                which, picture, table, stage, span = kept.pop(0)
                self.assertEqual((picture.shape, int(picture.sum())), ((480, 640, 4), pictures[which]))
                self.assertEqual(int(table.sum()), sums[which][stage])
                read = bitspan._core.errors(config._handle, scenes[which]._handle, "span", "u", span)
                self.assertTrue(np.array_equal(read, errors[which]))
        self.assertLess(len(kept), 2)


class Errors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.drawn = bitspan.render("demo", width=160, height=120)
        cls.metrics = bitspan.measure("depth16", "demo", 160, 120)

    def test_rays_judge_a_shadow(self):
        lit = bitspan.Config("depth16").with_({"project.unit": "reciprocal"})
        for bias, are_wrong in ((None, False), (0, True)):
            found = bitspan.measure(lit, bitspan.Scene("demo", 96, 72, shadow=(-12, 16, -2), shadow_map=256, shadow_bias=bias))
            self.assertGreater(found["shadow.judged"], 3000)
            self.assertEqual(found["shadow.unexplained"] > 0, are_wrong)

    def test_errors_of_records_are_those_of_the_study(self):
        for field, metric in (("span.u", "span.u"), ("span.v", "span.v"), ("span.h", "span.h"), ("depth.z", "depth.z")):
            error = self.drawn.error(field)
            self.assertEqual(error.shape, (len(self.drawn.records(field.split(".")[0])),))
            error = error[~np.isnan(error)]
            self.assertGreater(len(error), 1000)
            self.assertEqual(np.abs(error).max(), self.metrics[f"{metric}.max"])
            self.assertAlmostEqual(error.mean(), self.metrics[f"{metric}.bias"], delta=1e-12)
            self.assertAlmostEqual(np.sqrt((error**2).mean()), self.metrics[f"{metric}.rms"], delta=1e-12)
            # The metric is the upper edge of a bin of 1/8 octave.
            quantile, p999 = np.quantile(np.abs(error), 0.999), self.metrics[f"{metric}.p999"]
            self.assertTrue(quantile / 2**0.125 <= p999 <= quantile * 2**0.2, (quantile, p999))
        channels = [self.drawn.error(f"texture.{c}") for c in "rgb"]
        self.assertEqual(np.nanmax(np.abs(channels)), self.metrics["texture.colour.max"])
        ends = np.concatenate([self.drawn.error("edge_walk.l_u"), self.drawn.error("edge_walk.r_u")])
        self.assertEqual(np.nanmax(np.abs(ends)), self.metrics["edge_walk.u.max"])
        self.assertEqual(len(ends[~np.isnan(ends)]), 2 * len(self.drawn.edge_walk))

    def test_error_maps(self):
        u = self.drawn.error_map("span.u")
        self.assertEqual((u.shape, u.dtype.name), ((120, 160), "float64"))
        shown = self.drawn.triangle >= 0
        self.assertTrue((~np.isnan(u) == shown).all())
        self.assertLessEqual(np.nanmax(np.abs(u)), self.metrics["span.u.max"])
        picture = self.drawn.error_map("picture.u")
        both = ~np.isnan(picture)
        self.assertTrue(np.allclose(u[both], picture[both], atol=1e-9))
        self.assertEqual(np.nanmax(np.abs(picture)), self.metrics["picture.u.max"])
        self.assertEqual(np.nanmax(np.abs(self.drawn.error_map("picture.depth"))), self.metrics["picture.depth.max"])
        self.assertEqual(self.drawn.error_map("picture.color").max(), self.metrics["picture.color_max"])
        self.assertEqual(self.drawn.error_map("depth.z").shape, (120, 160))

    def test_fewer_bits_make_larger_errors(self):
        less = bitspan.render("demo", bitspan.Config().with_({"formats.span.uv.word": 19}), width=160, height=120)
        self.assertGreater(np.nanmean(np.abs(less.error("span.u"))), 3 * np.nanmean(np.abs(self.drawn.error("span.u"))))

    def test_what_has_no_error(self):
        for name, says in (("span.recip_m", "ideal has no value"), ("constants.b", "no records of triangles"),
                           ("span.nothing", "no such field"), ("u", "no field"), ("nothing.u", "no stage")):
            with self.assertRaisesRegex(bitspan.InputError, says):
                self.drawn.error(name)
        for name, says in (("edge_walk.l_u", "no record per pixel"), ("picture.nothing", "expected picture.u"), ("setup.h0", "no record per pixel")):
            with self.assertRaisesRegex(bitspan.InputError, says):
                self.drawn.error_map(name)


class Compares(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.drawn = small()

    def test_equal_runs(self):
        found = bitspan.compare(self.drawn, small("golden"))
        self.assertTrue(found.equal)
        self.assertIsNone(found.first)
        values = sum(self.drawn.table(stage).size for stage in bitspan.STAGES)
        self.assertEqual(found.matched, values)
        self.assertTrue(0 < found.nontrivial < values)

    def test_a_flipped_bit_is_named(self):
        records = self.drawn.span.copy()
        records["u"][77] ^= 4
        found = bitspan.compare(self.drawn, records)
        first = found.first
        self.assertFalse(found.equal)
        self.assertEqual((first.kind, first.stage, first.record, first.field, found.differences), ("value", "span", 77, "u", 1))
        self.assertEqual((first.x, first.y, first.triangle), tuple(int(self.drawn.span[77][n]) for n in ("x", "y", "triangle")))
        self.assertEqual(first.expected ^ first.actual, 4)
        self.assertEqual((first.expected_value, first.unit), (first.expected / 256, "texel"))
        for shown in (str(first), first._repr_html_(), found._repr_html_()):
            self.assertIn(str(first.actual), shown)
        self.assertIn(f"pixel {first.x} {first.y}", str(found))

    def test_the_counts_are_those_of_the_model(self):
        records = self.drawn.table("span").copy()
        records[100:200, 5] += 1
        model = bitspan.Model()
        model.begin(self.drawn.scene)
        model.draw(self.drawn.scene)
        part = records[:1500]
        by_model, found = model.check("span", part), bitspan.compare(self.drawn, part)
        self.assertEqual((model.matched, model.nontrivial, model.unchecked("span")), (found.matched, found.nontrivial, found.unchecked))
        self.assertEqual(found.unchecked, len(records) - 1500)
        for name in ("kind", "stage", "record", "triangle", "x", "y", "field", "expected", "actual", "expected_value", "unit", "differences"):
            self.assertEqual(getattr(by_model, name), getattr(found.first, name), name)

    def test_missing_extra_and_empty_records_are_no_success(self):
        table = self.drawn.table("span")
        self.assertFalse(bitspan.compare(self.drawn, table[:-1]).equal)
        more = bitspan.compare(self.drawn, np.concatenate([table, table[-1:]]))
        self.assertEqual((more.first.kind, more.first.record, more.differences), ("extra", len(table), table.shape[1]))
        none = bitspan.compare(self.drawn, table[:0])
        self.assertFalse(none.equal)
        self.assertEqual((none.matched, none.nontrivial, none.unchecked), (0, 0, len(table)))

    def test_a_run_without_pixels_is_no_success(self):
        nothing = bitspan.render(bitspan.Scene.from_vertices(triangle(x=900), 64, 64))
        found = bitspan.compare(nothing, nothing.span)
        self.assertEqual((found.first, found.matched, found.unchecked, found.equal), (None, 0, 0, False))

    def test_stages_in_their_order(self):
        depth, span = self.drawn.table("depth").copy(), self.drawn.table("span").copy()
        depth[0, 5] += 1
        span[9, 5] += 1
        found = bitspan.compare(self.drawn, {"depth": depth, "span": span})
        self.assertEqual((found.first.stage, found.first.record, found.differences), ("span", 9, 2))
        columns = {name: self.drawn.span[name] for name in self.drawn.names("span")}
        self.assertTrue(bitspan.compare(self.drawn, columns).equal)
        self.assertTrue(bitspan.compare(self.drawn, self.drawn.table("fog").astype(np.int32), stage="fog").equal)


class Sweeps(unittest.TestCase):
    def test_metrics_are_those_of_the_study(self):
        """Every number of a sweep against the database of `bitspan study`, bit for bit."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "study.toml").write_text(
                '[study]\nname = "s"\nbase = "depth16"\nscenes = ["demo"]\nsize = "96x72"\n'
                '[[vary]]\nkeys = ["formats.span.uv.word"]\nvalues = [20, 22, 25]\n')
            run(PROGRAM, "study", "study.toml", "--db", "study.db", cwd=folder)
            with sqlite3.connect(folder / "study.db") as db:
                rows = db.execute("SELECT settings ->> '$.\"formats.span.uv.word\"', name, value FROM study_points JOIN metrics "
                                  "USING (hash) WHERE study = 's'").fetchall()
        table = bitspan.sweep("depth16", {"formats.span.uv.word": [20, 22, 25]}, width=96, height=72)
        wanted = {}
        for word, metric, value in rows:
            wanted.setdefault(int(word), {})[metric] = float(value)
        self.assertEqual(sorted(wanted), table["formats.span.uv.word"].tolist())
        checked = 0
        for i, word in enumerate(table["formats.span.uv.word"]):
            for metric, value in wanted[word].items():
                self.assertEqual(table[metric][i], value, metric)
                checked += 1
        self.assertGreater(checked, 3 * 150)
        self.assertEqual(bitspan.measure(bitspan.Config().with_({"formats.span.uv.word": 22}), "demo", 96, 72)["span.u.p999"],
                         table["span.u.p999"][1])

    def test_grid_refusals_and_choice(self):
        table = bitspan.sweep("depth16", {"formats.span.uv.word": range(20, 24), "reciprocal.pixel.operand_bits": (22, 5)},
                              metric=("span.u.p999", "span.u.max"), width=64, height=48, threads=2)
        self.assertEqual(len(table), 8)
        self.assertEqual(table.columns, ("formats.span.uv.word", "reciprocal.pixel.operand_bits", "span.u.p999", "span.u.max"))
        self.assertEqual(table["reciprocal.pixel.operand_bits"].tolist(), [22, 5] * 4)
        self.assertEqual([bool(r) for r in table.reasons], [False, True] * 4)
        self.assertIn("index_bits < operand_bits", table.reasons[1])
        self.assertEqual(np.isnan(table["span.u.p999"]).tolist(), [False, True] * 4)
        error = table["span.u.p999"][::2]
        self.assertTrue((np.diff(error) < 0).all())
        self.assertEqual(table.choose(at_most=error[2]), {"formats.span.uv.word": 22, "reciprocal.pixel.operand_bits": 22})
        self.assertEqual(table.choose(metric="span.u.max", at_least=0)["formats.span.uv.word"], 20)
        with self.assertRaisesRegex(bitspan.InputError, "no point has span.u.p999"):
            table.choose(at_most=1e-9)
        with self.assertRaisesRegex(bitspan.InputError, "no limit"):
            table.choose()
        with self.assertRaisesRegex(bitspan.InputError, "every point was refused.*index_bits"):
            bitspan.sweep("depth16", {"reciprocal.pixel.operand_bits": (5, 4)}, width=64, height=48)

    def test_shown_written_and_plotted(self):
        os.environ["MPLBACKEND"] = "agg"
        table = bitspan.sweep("depth16", {"formats.span.uv.word": (20, 22), "depth.bits": (15, 16)}, width=64, height=48)
        self.assertEqual(table._repr_html_().count("<tr>"), 5)
        self.assertEqual(len(repr(table).splitlines()), 5)
        with tempfile.TemporaryDirectory() as folder:
            text = table.to_csv(f"{folder}/table.csv")
            self.assertEqual(pathlib.Path(folder, "table.csv").read_text(), text)
        lines = text.splitlines()
        self.assertEqual(lines[0], "formats.span.uv.word,depth.bits,span.u.p999,refused")
        self.assertEqual(lines[1], f"20,15,{float(table['span.u.p999'][0])!r},")
        axes = table.plot()
        self.assertEqual([line.get_label() for line in axes.get_lines()], ["depth.bits = 15", "depth.bits = 16"])
        self.assertEqual(axes.get_lines()[0].get_xdata().tolist(), [20, 22])
        self.assertEqual(axes.get_ylabel(), "span.u.p999 [texel]")

    def test_several_scenes(self):
        scenes = [bitspan.Scene("demo", 64, 48), bitspan.Scene("demo", 96, 72)]
        both = bitspan.measure("depth16", scenes)
        largest = max(bitspan.measure("depth16", scene)["span.u.max"] for scene in scenes)
        self.assertEqual(both["span.u.max"], largest)

    def test_several_constraints(self):
        table = bitspan.sweep("depth16", {"formats.span.uv.word": range(20, 25), "depth.bits": (14, 16)},
                              metric=("span.u.p999", "span.u.max"), width=64, height=48)
        u, largest, cost = table["span.u.p999"], table["span.u.max"], table["cost.register_bits"]
        limits = {"span.u.p999": {"at_most": float(u[2])}, "span.u.max": {"at_most": float(np.sort(np.unique(largest))[1])}}
        legal = [i for i in range(len(table)) if all(table[name][i] <= limit["at_most"] for name, limit in limits.items())]
        self.assertTrue(0 < len(legal) < (u <= u[2]).sum())  # the second constraint decides
        best = min(legal, key=lambda i: cost[i])
        self.assertEqual(table.choose(limits), dict(zip(table.keys, (table[key][best] for key in table.keys))))
        with self.assertRaisesRegex(bitspan.InputError, f"no point has span.u.max at most 1e-09: the nearest value is {largest.min():g}"):
            table.choose({"span.u.p999": {"at_most": 1}, "span.u.max": {"at_most": 1e-9}})
        with self.assertRaisesRegex(bitspan.InputError, r"each holds somewhere; at .*word = \d+.*is .*, not at (most|least)"):
            table.choose({"span.u.p999": {"at_most": float(u.min())}, "span.u.max": {"at_least": float(largest.max())}})
        for wrong, text in (({}, "no constraint"), ({"span.u.max": 1}, "expected limits"), ({"span.u.max": {}}, "no limit"),
                            ({"span.u.max": {"at_most": "1"}}, "expected a number"), ({"span.q": {"at_most": 1}}, "is no metric"),
                            ({"span.u.max": {"at_most": 1, "over": "best"}}, "expected 'worst' or 'pooled'")):
            with self.assertRaisesRegex(bitspan.InputError, text):
                table.choose(wrong)
        with self.assertRaisesRegex(bitspan.InputError, "one of the two forms"):
            table.choose(limits, at_most=1)

    def test_constraints_judge_the_worst_scene(self):
        scenes = [bitspan.Scene("demo", 64, 48), bitspan.Scene("demo", 160, 120)]
        table = bitspan.sweep("depth16", {"formats.span.uv.word": range(20, 25)}, "span.u.rms", scenes)
        each = [bitspan.sweep("depth16", {"formats.span.uv.word": range(20, 25)}, "span.u.rms", scene)["span.u.rms"]
                for scene in scenes]
        worst, pooled = np.maximum(*each), table["span.u.rms"]
        limit = float(pooled[2])
        self.assertLess(limit, worst[2])  # so the two rules differ
        wanted = int(table["formats.span.uv.word"][worst <= limit].min())
        self.assertEqual(table.choose(at_most=limit)["formats.span.uv.word"], wanted)
        self.assertEqual(table.choose(at_most=limit, over="pooled")["formats.span.uv.word"], 22)
        self.assertEqual(table.choose({"span.u.rms": {"at_most": limit, "over": "pooled"}})["formats.span.uv.word"], 22)
        self.assertGreater(wanted, 22)

    def test_metrics_of_the_users(self):
        def wrong_texels(run):
            shown = ~np.isnan(run.u) & (run.triangle == run.ideal.triangle)
            return float(np.mean(np.floor(run.u[shown]) != np.floor(run.ideal.u[shown])))

        def largest_error(run):
            return np.nanmax(np.abs(run.error("span.u")))

        scenes = [bitspan.Scene("demo", 64, 48), bitspan.Scene("demo", 96, 72)]
        words = {"formats.span.uv.word": (20, 22, 24)}
        table = bitspan.sweep("depth16", words, ["span.u.max", wrong_texels, largest_error], scenes, threads=2)
        self.assertEqual(table.columns[1:], ("span.u.max", "wrong_texels", "largest_error"))
        self.assertEqual(table["largest_error"].tolist(), table["span.u.max"].tolist())  # the study's own number
        for word, value in zip(words["formats.span.uv.word"], table["wrong_texels"]):
            config = bitspan.Config().with_({"formats.span.uv.word": word})
            self.assertEqual(value, max(wrong_texels(bitspan.render(scene, config)) for scene in scenes))
            self.assertEqual(bitspan.measure(config, scenes, metric={"mine": wrong_texels})["mine"], value)
        self.assertGreater(table["wrong_texels"][0], table["wrong_texels"][2])
        limit = float(table["wrong_texels"][1])
        self.assertEqual(table.choose({"wrong_texels": {"at_most": limit}}), {"formats.span.uv.word": 22})
        self.assertIn("span.u.max,wrong_texels,largest_error", table.to_csv())
        os.environ["MPLBACKEND"] = "agg"
        self.assertEqual(table.plot("wrong_texels").get_ylabel(), "wrong_texels")
        with self.assertRaisesRegex(bitspan.InputError, "no value of all scenes together"):
            table.choose({"wrong_texels": {"at_most": limit, "over": "pooled"}})

        def broken(run):
            raise RuntimeError("of the user")

        with self.assertRaisesRegex(RuntimeError, "of the user"):
            bitspan.sweep("depth16", words, broken, scenes[0])
        for metric, text in ((lambda run: 0.0, "expected a function with a name"), ({"a": 1}, "is no function"),
                             ({"a": lambda run: "x"}, "returned 'x' for scene demo"), ([broken, broken], "two functions")):
            with self.assertRaisesRegex(bitspan.InputError, text):
                bitspan.sweep("depth16", words, metric, scenes[0])

    def test_what_the_formats_cost(self):
        known, measured = bitspan.costs("narrow"), bitspan.measure("narrow", "demo", 64, 48)
        self.assertEqual({name: measured[name] for name in known}, known)
        for part in ("", "pixel_", "late_pixel_"):
            self.assertTrue(0 < known[f"estimate.ice40.{part}luts_error"] < known[f"estimate.ice40.{part}luts"])
        self.assertEqual({name.split(".")[0] for name in known}, {"cost", "timing", "estimate"})

    def test_list_of_metrics(self):
        known = {metric.name: metric for metric in bitspan.metrics()}
        self.assertEqual(known["span.u.p999"].unit, "texel")
        self.assertTrue(known["picture.psnr_db"].high_is_better)
        self.assertFalse(known["span.u.max"].high_is_better)

    def test_progress_on_a_terminal(self):
        program = ("import bitspan\nbitspan.sweep('depth16', {'formats.span.uv.word': range(20, 24)}, width=32, height=24, "
                   "threads=1, progress=True)\n")
        out = run(sys.executable, "-c", "import bitspan._progress as p; p.time.monotonic = iter(range(99)).__next__\n" + program)
        self.assertIn("2 of 4 points", out)
        self.assertNotIn("points", run(sys.executable, "-c", program.replace("True", "None")))


STUDY = """[study]
name = "s"
base = "depth16"
scenes = ["demo", "demo@2"]
size = "96x72"
[[vary]]
keys = ["formats.span.uv.word"]
from = 18
to = 25
[[vary]]
keys = ["formats.span.f.fraction", "formats.span.f_step.fraction"]
from = -4
to = 8
[[vary]]
keys = ["reciprocal.pixel.kind"]
values = ["lut_newton", "restoring"]
[[constraint]]
metric = "span.u.p999"
at_most = 0.2
[search]
algorithm = "greedy"
cost = "estimate.ecp5.luts"
"""
KEYS = {"formats.span.uv.word": range(18, 26), ("formats.span.f.fraction", "formats.span.f_step.fraction"): range(-4, 9),
        "reciprocal.pixel.kind": ("lut_newton", "restoring")}


class Searches(unittest.TestCase):
    def test_it_is_the_search_of_the_study(self):
        with tempfile.TemporaryDirectory() as name:
            (pathlib.Path(name) / "study.toml").write_text(STUDY)
            run(PROGRAM, "study", "study.toml", "--db", "study.db", cwd=name)
            with sqlite3.connect(f"{name}/study.db") as db:
                steps = [(json.loads(settings), cost, holds) for settings, cost, holds in db.execute(
                    "SELECT p.settings, s.cost, s.holds FROM search_steps s JOIN study_points p USING (study, i) ORDER BY i")]
                certificates = db.execute("SELECT key, from_value, to_value, failed FROM certificate").fetchall()
        scenes = [bitspan.Scene(scene, 96, 72) for scene in ("demo", "demo@2")]
        found = bitspan.search("depth16", KEYS, {"span.u.p999": {"at_most": 0.2}}, scenes, cost="estimate.ecp5.luts")
        table = found.table
        self.assertEqual([dict(zip(table.keys, point)) for point in table._settings], [s for s, _, _ in steps])
        self.assertEqual(table["estimate.ecp5.luts"].tolist(), [cost for _, cost, _ in steps])
        self.assertEqual(found.cost, min(cost for _, cost, holds in steps if holds))
        parts = [step for c in found.combinations for step in (*c.certificate.steps, *c.certificate.pairs)]
        self.assertEqual([(s.key, s.from_value, s.to_value, f"{s.outcome}: {s.text}") for s in parts], certificates)
        self.assertTrue(found.certificate.minimal and found.stopped_by == "done")
        self.assertEqual(str(found.certificate), found.certificate.text)
        self.assertEqual(found.settings, found.combinations[0].settings)
        worst, scene = found.decisive["span.u.p999"]
        each = {s.name: bitspan.measure(found.config, s)["span.u.p999"] for s in scenes}
        self.assertEqual((worst, scene), max((value, name) for name, value in each.items()))
        self.assertEqual(found.metrics, bitspan.measure(found.config, scenes))
        self.assertIn("span.u.p999, at most 0.2", found._repr_html_())
        self.assertIn("reciprocal.pixel.kind = lut_newton", repr(found))

    def test_unseen_views(self):
        found = bitspan.search("depth16", {"formats.span.uv.word": range(18, 26), "reciprocal.pixel.output.word": range(14, 24),
                                            ("formats.span.f.fraction", "formats.span.f_step.fraction"): range(-4, 9)},
                               {"span.u.p999": {"at_most": 0.1}}, "demo", width=96, height=72)
        unseen = [bitspan.Scene(f"demo@{camera}", 96, 72) for camera in range(1, 6)]
        views = found.validate(unseen)
        values = [bitspan.measure(found.config, scene)["span.u.p999"] for scene in unseen]
        self.assertEqual([view.values["span.u.p999"] for view in views], values)
        self.assertEqual([view.holds for view in views], [value <= 0.1 for value in values])
        self.assertTrue(0 < sum(view.holds for view in views) < 5)
        self.assertEqual([view.scene for view in views], [f"demo@{camera}" for camera in range(1, 6)])

    def test_functions_as_constraints_and_costs(self):
        def wrong_texels(run):
            shown = ~np.isnan(run.u) & (run.triangle == run.ideal.triangle)
            return float(np.mean(np.floor(run.u[shown]) != np.floor(run.ideal.u[shown])))

        keys = {"formats.span.uv.word": range(18, 26), "formats.edge.uv.word": range(24, 30)}
        calls = []

        def price(metrics):
            calls.append(1)
            return metrics["cost.register_bits"] + 100 * metrics["estimate.ecp5.multipliers"]

        by_hand = bitspan.sweep("depth16", keys, [wrong_texels], "demo", width=64, height=48)
        prices = by_hand["cost.register_bits"] + 100 * by_hand["estimate.ecp5.multipliers"]
        legal = by_hand["wrong_texels"] <= 0.05
        found = bitspan.search("depth16", keys, {"wrong_texels": {"at_most": 0.05}}, "demo", width=64, height=48, cost=price,
                               metric=wrong_texels, threads=1)
        self.assertEqual(found.cost, prices[legal].min())
        self.assertLess(len(found.table), len(by_hand))
        self.assertEqual(found.table["price"].tolist(), [price(result.all) for result in found.table._results])
        # A cost that only a measurement has is asked for there alone.
        unknown = bitspan.search("depth16", keys, {"wrong_texels": {"at_most": 0.05}}, "demo", width=64, height=48,
                                 metric=wrong_texels, cost=lambda m: m["cost.register_bits"] + m["memory.depth_bits"])
        self.assertEqual(unknown.settings, bitspan.search("depth16", keys, {"wrong_texels": {"at_most": 0.05}}, "demo", width=64,
                                                          height=48, metric=wrong_texels).settings)

        def broken(run):
            raise RuntimeError("of the user")

        with self.assertRaisesRegex(RuntimeError, "of the user"):
            bitspan.search("depth16", keys, {"broken": {"at_most": 1}}, metric=broken, width=64, height=48)

    def test_limits(self):
        found = bitspan.search("depth16", KEYS, {"span.u.p999": {"at_most": 0.2}}, width=64, height=48, evaluations=9)
        self.assertEqual((found.stopped_by, len(found.table)), ("evaluations", 9))
        self.assertFalse(found.certificate.minimal)

    def test_every_bad_argument_is_refused(self):
        word, limit = {"formats.span.uv.word": [20]}, {"span.u.p999": {"at_most": 1}}
        for arguments, options, text in (
                (({}, limit), {}, "nothing varies"), ((word, {}), {}, "no constraint"), ((word, 3), {}, "no constraint"),
                (({"formats.span.uv.word": [20, 1.5]}, limit), {}, "1.5 is no value"),
                (({"formats.span.uv.word": 20}, limit), {}, "not iterable; expected values"),
                (({"formats.span.uv.word": [2**70]}, limit), {}, "is no value"),
                (({"formats.span.uv.wrd": [20]}, limit), {}, "no such key.*nearest: formats.span.uv.word"),
                ((word, {"span.u.p999": {"at_most": 1e-9}}), {}, "no point holds.*span.u.p999 is"),
                ((word, {"span.u.p99": {"at_most": 1}}), {}, "is no metric"), ((word, {"span.u.p999": {}}), {}, "search: .*no limit"),
                ((word, limit), {"cost": "cost.bits"}, "is no metric"), ((word, limit), {"tie": "x"}, "is no metric"),
                ((word, limit), {"algorithm": "best"}, "expected min.1, max-1, greedy, annealing"),
                ((word, limit), {"evaluations": 2**40}, "evaluations"), ((word, limit), {"seconds": -1}, "seconds"),
                ((word, limit), {"seconds": 0}, "seconds"), ((word, limit), {"seed": 1.5}, "seed"),
                ((word, limit), {"tie_within": float("nan")}, "tie_within"), ((word, limit), {"threads": 0}, "threads")):
            with self.assertRaisesRegex(bitspan.InputError, text):
                bitspan.search("depth16", *arguments, width=32, height=24, **options)


class Areas(unittest.TestCase):
    def test_counts_are_those_of_the_program(self):
        tiny = bitspan.Config("narrow").with_({
            "perspective.mode": "const_depth_rows", "rtl.shades": False, "rtl.product_digits": 1, "rtl.pixel_clocks": 1,
            "raster.coordinate_bits": 8, "formats.plane.k.word": 6, "reciprocal.row.output.word": 4,
            **{f"formats.{name}.word": word for name, word in (("setup.b", 6), ("span.h", 6), ("span.f", 8), ("span.f_step", 8),
                                                               ("span.uv_step", 8), ("span.uv_acc", 8), ("span.uv", 7))},
            **{f"formats.{name}.int": word for name, word in (("setup.b", 6), ("span.h", 6), ("span.f", 8), ("span.f_step", 8),
                                                              ("span.uv_step", 7), ("span.uv_acc", 7), ("span.uv", 7))}})
        area = bitspan.area(tiny)
        self.assertEqual((area.status, area.message), ("ok", ""))
        self.assertTrue(area.luts > 100 and area.ffs > 100 and np.isnan(area.fmax_mhz))
        self.assertRegex(area.tools, "Yosys")
        self.assertLess(abs(area.ffs / bitspan.costs(tiny)["estimate.ecp5.ffs"] - 1), 0.2)

    def test_what_cannot_be_synthesised(self):
        for arguments, text in ((("depth16", "xc7"), "is no family"), (("depth16", "ecp5"), "above 0"),):
            with self.assertRaisesRegex(bitspan.InputError, text):
                bitspan.area(*arguments, seconds=0 if text == "above 0" else 10)
        for options, text in (({"part": "rows"}, "is no part of the RTL; legal: spans, pixels, late_pixels"),
                              ({"part": "pixels", "place": True}, "only the spans are placed, not pixels")):
            with self.assertRaisesRegex(bitspan.InputError, text):
                bitspan.area("depth16", "ecp5", **options)
        late = bitspan.area("depth16", seconds=0.2)
        self.assertEqual(late.status, "failed")
        self.assertIn("time limit", late.message)
        with unittest.mock.patch.dict(os.environ, {"PATH": ""}), self.assertRaisesRegex(bitspan.ToolError, "yosys"):
            bitspan.area("narrow")


class Rows(unittest.TestCase):
    """A model as a bench uses it: rows in, records out, checks."""

    def test_rows_of_a_picture_give_its_pixels(self):
        drawn = small()
        for stage in ("edge_walk", "span_setup"):
            model = bitspan.Model(drawn.config)
            model.begin(drawn.scene)
            for record in drawn.records(stage)[:50]:
                model.row(stage, record, int(drawn.scene.texture_of[record["triangle"]]))
            n = len(model.records("span"))
            self.assertGreater(n, 100)
            self.assertTrue(np.array_equal(model.table("span"), drawn.table("span")[:n]))
            self.assertIsNone(model.check("span", drawn.span[: n - 10]))
            self.assertEqual((model.matched, model.unchecked("span")), ((n - 10) * 16, 10))
            self.assertGreater(model.nontrivial, 500)
            wrong = drawn.span[n - 10 : n].copy()
            wrong["v"][3] += 1
            first = model.check("span", wrong)
            self.assertEqual((first.record, first.field, first.actual - first.expected), (n - 7, "v", 1))
            self.assertIn("v:", str(first))
            self.assertEqual(model.check("span", wrong[:1]).kind, "extra")

    def test_a_row_may_be_a_mapping_a_list_or_an_array(self):
        drawn = small()
        record = drawn.span_setup[20]
        model = bitspan.Model()
        model.begin(drawn.scene)
        model.row("span_setup", {name: int(record[name]) for name in record.dtype.names})
        model.row("span_setup", record.tolist())
        model.row("span_setup", drawn.table("span_setup")[20])
        table = model.table("span")
        third = len(table) // 3
        self.assertTrue(np.array_equal(table[:third], table[third : 2 * third]) and np.array_equal(table[:third], table[2 * third :]))

    @staticmethod
    def leaked(line):
        """What a program says at its end that has a model, and a line."""
        return run(sys.executable, "-c", f"import bitspan\nmodel = bitspan.Model()\nmodel.begin(bitspan.Scene('demo', 8, 8))\n{line}\n")

    def test_a_stage_of_the_users(self):
        drawn = small()
        u = drawn.names("span").index("u")
        seen = []

        def coarse(before, record):
            seen.append(before)
            record[u] &= ~4095
            return record

        model = bitspan.Model()
        model.override("span", coarse)
        model.begin(drawn.scene)
        model.draw(drawn.scene)
        self.assertTrue(np.array_equal(model.records("span")["u"], drawn.span["u"] & ~4095))
        self.assertTrue(np.array_equal(model.records("span")["v"], drawn.span["v"]))
        self.assertFalse(np.array_equal(model.plane("color"), drawn.color))
        self.assertEqual((len(seen), len(seen[0])), (len(drawn.span), 31))
        self.assertTrue(model.text.endswith("overridden stages: span; not checked by golden"))
        for function, error, says in ((lambda before, record: 1 / 0, ZeroDivisionError, "division"), (lambda before, record: record[:3], TypeError, "no record"),
                                      (lambda before, record: None, TypeError, "no record"),
                                      (lambda before, record: record[:u] + [2**40] + record[u + 1 :], bitspan.InputError, "u: .*out of range")):
            model.override("span", function)
            model.begin(drawn.scene)
            with self.assertRaisesRegex(error, says):
                model.draw(drawn.scene)
        self.assertEqual(self.leaked("model.override('span', lambda before, record: model and record)"), "")
        model.override("span", None)
        model.begin(drawn.scene)
        model.draw(drawn.scene)
        self.assertTrue(np.array_equal(model.plane("color"), drawn.color))
        with self.assertRaisesRegex(bitspan.InputError, "cannot be overridden"):
            model.override("constants", coarse)
        with self.assertRaisesRegex(bitspan.InputError, "expected model"):
            bitspan.Model(engine="golden").override("span", coarse)

    def test_views_and_copies(self):
        corners = [[[0, 0, 2, 0, 0], [64, 0, 2, 64, 0], [0, 64, 2, 0, 64]]]
        scene = bitspan.Scene.from_vertices(np.array(corners, float), 40, 30, texture=0, s_range=(1, 9),
                                            textures=[np.zeros((32, 32, 4), np.uint8)])
        model = bitspan.Model()
        model.begin(scene)
        model.target(1)
        model.view(width=32, height=32, s_max=20, background=(10, 20, 30), fog=((1, 2, 3), 9))
        self.assertEqual(model.plane("color").shape, (32, 32, 4))
        model.copy(1, "color", 0)
        model.target(0)
        model.draw(scene)
        self.assertEqual(model.plane("color").shape, (30, 40, 4))
        self.assertEqual(model.plane("color")[4, 4, :3].tolist(), [10, 20, 30])
        with self.assertRaisesRegex(bitspan.InputError, "target 2|copy.target: 2 has not been drawn on"):
            model.copy(2, "depth", 0)
        with self.assertRaisesRegex(bitspan.InputError, "view.width: 0 is not legal"):
            model.view(width=0)

    def test_states_clears_and_targets(self):
        scene = bitspan.Scene("demo", 80, 60)
        model = bitspan.Model()
        model.begin(scene)
        empty = model.plane("color").copy()
        model.draw(scene)
        drawn = model.plane("color").copy()
        self.assertFalse(np.array_equal(drawn, empty))
        model.target(3)
        self.assertTrue(np.array_equal(model.plane("color"), empty))
        model.state({"color.write": False})
        model.draw(scene)
        self.assertTrue(np.array_equal(model.plane("color"), empty))
        depth = model.plane("depth").copy()
        model.clear(color=(1, 2, 3), depth=True)
        self.assertEqual(model.plane("color")[0, 0].tolist(), [1, 2, 3, 255])
        model.state({"color.write": True, "scissor.left": 40})
        model.clear(color=(4, 5, 6), masked=True)
        self.assertEqual(model.plane("color")[0, 39:41].tolist(), [[1, 2, 3, 255], [4, 5, 6, 255]])
        model.state({"color.write": False})
        model.target(0)
        self.assertTrue(np.array_equal(model.plane("color"), drawn))
        self.assertTrue(np.array_equal(model.plane("depth"), depth))
        model.target(3)
        self.assertFalse(model.plane("depth").any())
        model.state(reset=True)
        model.draw(scene)
        self.assertTrue(np.array_equal(model.plane("depth"), depth))
        with self.assertRaisesRegex(bitspan.InputError, "target: 8 is not legal; expected a whole number 0..7"):
            model.target(8)
        column = model.plane("u")
        with self.assertRaisesRegex(bitspan.StateError, "1 arrays show the model's memory"):
            model.target(0)
        del column

    def test_records_are_forgotten_and_numbers_are_told(self):
        scene = bitspan.Scene("demo", 80, 60)
        model = bitspan.Model()
        model.begin(scene)
        model.draw(scene, frame=7, draw=9)
        table = model.table("span").copy()
        table[5, 5] += 1
        first = model.check("span", table)
        self.assertEqual((first.frame, first.draw), (7, 9))
        model.clear_records()
        self.assertEqual(len(model.records("span")), 0)
        self.assertEqual(model.records("span").dtype.names[0], "triangle")
        model.draw(scene)
        self.assertEqual(len(model.records("span")), len(table))


class BadInput(unittest.TestCase):
    def test_a_report_refuses_a_missing_library_and_a_missing_database(self):
        def found(missing=""):
            return unittest.mock.patch("importlib.util.find_spec", lambda name: None if name == missing else object())

        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "out")
            with found("plotly"), self.assertRaisesRegex(bitspan.InputError, r"^\S+ has no module plotly; [^\n]*pip install plotly$"):
                bitspan.report(pathlib.Path(folder, "none.db"), out)
            with found(), self.assertRaisesRegex(bitspan.InputError, r"^\S+/none\.db: no such file$"):
                bitspan.report(pathlib.Path(folder, "none.db"), out)
            self.assertFalse(out.exists())

    def test_a_bad_toml_has_file_and_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mine.toml")
            lines = (SOURCE / "config/depth16.toml").read_text().splitlines()
            at = next(i for i, line in enumerate(lines) if line.startswith("subpixel_bits"))
            lines[at] = "subpixel_bits = 99"
            path.write_text("\n".join(lines))
            with self.assertRaisesRegex(bitspan.InputError, rf"^{re.escape(str(path))}:{at + 1}: .*subpixel_bits") as raised:
                bitspan.Config(path)
            self.assertIsInstance(raised.exception, ValueError)
            path.write_text("a = 1\nb = \n")
            with self.assertRaisesRegex(bitspan.InputError, rf"^{re.escape(str(path))}:2: "):
                bitspan.Config(path)

    def test_every_call_refuses_what_is_not_legal(self):
        config, scene = bitspan.Config(), bitspan.Scene("demo", 32, 24)
        drawn = bitspan.render(scene)
        model = bitspan.Model()
        model.begin(scene)
        row = drawn.table("span_setup")[0].copy()
        outside = row.copy()
        outside[1] = 99
        make = bitspan.Scene.from_vertices
        nan = np.array(triangle())
        nan[0, 0, 0] = np.nan
        bad = [
            (lambda: bitspan.Config(7), "is no configuration"),
            (lambda: bitspan.Config("nowhere"), "shipped names"),
            (lambda: config.with_({"nothing": 1}), "nothing: no such key.*nearest: "),
            (lambda: config.with_({"formats.span.uv.word": 2.5}), "2.5 is no value"),
            (lambda: config.with_({"formats.span.uv.word": 0}), "formats.span.uv.word"),
            (lambda: config.with_({"depth.code": "cubic"}), "depth.code"),
            (lambda: config.fields("nothing"), "'nothing' is no stage; expected constants"),
            (lambda: config.field("span.nothing"), "span has no such field"),
            (lambda: bitspan.Scene(3), "is no scene"),
            (lambda: bitspan.Scene("nowhere.obj"), "nowhere.obj"),
            (lambda: bitspan.Scene("demo", -1, 5), "-1x5"),
            (lambda: bitspan.Scene("demo", 1.5, 5), "width: 1.5"),
            (lambda: bitspan.Scene("demo", 10**20, 5), "width"),
            (lambda: make("text"), "vertices"),
            (lambda: make([[1, 2, 3]]), r"\(n, 3, k\)"),
            (lambda: make(np.zeros((2, 3, 23))), r"\(n, 3, k\)"),
            (lambda: make(nan), "x or y is nan"),
            (lambda: make(triangle(x=1e9)), "x or y"),
            (lambda: make(triangle(), texture=0), "texture: 0"),
            (lambda: make(triangle(), texture=[0, 1]), "2 entries"),
            (lambda: make(triangle(), texture=0.5), "expected integers"),
            (lambda: make(triangle(), textures=[np.zeros((4, 4, 4))]), "uint8"),
            (lambda: make(triangle(), textures=[np.zeros((0, 4, 4), np.uint8)]), "texels"),
            (lambda: make(triangle(), background=(0, 0, 256)), "background"),
            (lambda: make(triangle(), fog=((0, 0, 0), "far")), "far"),
            (lambda: make(triangle(), s_range=(5, 1)), "s_m"),
            (lambda: make(triangle(s=5000)), "s"),
            (lambda: make(triangle(), 0, 0), "width"),
            (lambda: bitspan.render(3), "is no scene"),
            (lambda: bitspan.render(scene, width=5, height=5), "has a size already"),
            (lambda: bitspan.render(scene, "nowhere"), "shipped names"),
            (lambda: bitspan.render(scene, engine="none"), "'none' is no engine"),
            (lambda: bitspan.Model(config, "rtl"), "libbitspan-rtl.so: no such file"),
            (lambda: model.begin("demo"), "expected a bitspan.Scene"),
            (lambda: model.draw(None), "expected a bitspan.Scene"),
            (lambda: model.row("span", row), "expected .n, 16"),
            (lambda: model.row("span_setup", row[:5]), r"expected \(n, 31\)"),
            (lambda: model.row("span_setup", row.astype(float)), "expected int64"),
            (lambda: model.row("span_setup", np.stack([row, row])), "2 records; expected one"),
            (lambda: model.row("span_setup", outside), "out of range"),
            (lambda: model.row("span_setup", row, 999), "texture: 999"),
            (lambda: model.row("span_setup", {"x": 1}), "has no column triangle"),
            (lambda: model.records("nothing"), "is no stage"),
            (lambda: model.plane("alpha"), "is no plane"),
            (lambda: model.check("span", [[1, 2]]), r"expected \(n, 16\)"),
            (lambda: model.check("span", np.zeros((1, 16), np.uint64) + np.uint64(2**63)), "uint64"),
            (lambda: model.unchecked("nothing"), "is no stage"),
            (lambda: bitspan.compare(model, []), "is no run"),
            (lambda: bitspan.compare(drawn, {"x": [1]}), "has no column"),
            (lambda: bitspan.compare(drawn, drawn.depth), "expected .n, 16"),
            (lambda: drawn.real("u"), "is no field"),
            (lambda: bitspan.sweep(config, {}), "no points"),
            (lambda: bitspan.sweep(config, {"depth.bits": 5}), "expected the values"),
            (lambda: bitspan.sweep(config, {"depth.bits": [16]}, "span.u.p99"), "such as span.u.p999"),
            (lambda: bitspan.sweep(config, {"depth.bits": [16]}, []), "no metric"),
            (lambda: bitspan.sweep(config, {"depth.bits": [16]}, scenes=[]), "without scenes"),
            (lambda: bitspan.sweep(config, {"depth.bits": [16]}, threads=-1), "threads"),
            (lambda: bitspan.measure(config, 5), "is no scene"),
        ]
        for i, (call, says) in enumerate(bad):
            with self.assertRaisesRegex(bitspan.InputError, says, msg=f"case {i}"):
                call()
        fresh = bitspan.Model()
        for call in (lambda: fresh.records("span"), lambda: fresh.plane("color"), lambda: fresh.draw(scene), lambda: fresh.counters,
                     lambda: fresh.row("span_setup", row), lambda: fresh.check("span", drawn.span)):
            with self.assertRaisesRegex(bitspan.StateError, "bs_begin before"):
                call()
        with self.assertRaises(AttributeError):
            drawn.nothing
        # None of it has changed the model.
        model.draw(scene)
        self.assertTrue(np.array_equal(model.table("span"), drawn.table("span")))


class Threads(unittest.TestCase):
    def test_ten_threads_with_a_model_each(self):
        widths = range(18, 28)
        alone = {w: small(**{"formats.span.uv.word": w}).table("span").copy() for w in widths}
        found = {}

        def work(width):
            for _ in range(5):
                found[width] = small(**{"formats.span.uv.word": width}).table("span")

        threads = [threading.Thread(target=work, args=(w,)) for w in widths]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for width in widths:
            self.assertTrue(np.array_equal(found[width], alone[width]), width)

    def test_other_threads_go_on_while_one_draws(self):
        scene = bitspan.Scene.from_vertices(np.repeat(triangle(0, 0, 500, 5), 60, axis=0), 512, 512)
        model = bitspan.Model(engine="golden")
        model.trace(False)
        model.begin(scene)
        ticks, refused = [], []
        drawing = threading.Thread(target=model.draw, args=(scene,))
        drawing.start()
        while drawing.is_alive():
            ticks.append(time.monotonic())
            for call in (lambda: model.begin(scene), lambda: model.plane("color")):
                try:
                    call()
                except bitspan.StateError as error:
                    refused.append(str(error))
            if not model._core.is_open:
                break
            time.sleep(0.001)
        drawing.join()
        self.assertGreater(len(ticks), 10)
        self.assertTrue(any("another call is using the model" in text for text in refused), refused[:3])


class Interrupts(unittest.TestCase):
    def interrupt(self, call):
        """Sends Ctrl-C into a call that would take long, and returns how long it went on."""
        sent = []

        def send():
            sent.append(time.monotonic())
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

        timer = threading.Timer(0.3, send)
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            call()
        return time.monotonic() - sent[0]

    def test_a_long_draw(self):
        scene = bitspan.Scene.from_vertices(np.repeat(triangle(0, 0, 1000, 5), 400, axis=0), 1024, 1024)
        model = bitspan.Model(engine="golden")
        model.trace(False)
        model.begin(scene)
        self.assertLess(self.interrupt(lambda: model.draw(scene)), 10)
        for call in (lambda: model.plane("color"), lambda: model.draw(scene)):
            with self.assertRaisesRegex(bitspan.StateError, "was interrupted; expected begin"):
                call()
        little = bitspan.Scene("demo", 80, 60)
        model.trace(True)
        model.begin(little)
        model.draw(little)
        self.assertTrue(np.array_equal(model.table("span"), small("golden").table("span")))
        self.assertLess(self.interrupt(lambda: bitspan.render(scene, engine="golden", trace=False)), 10)

    def test_a_long_search(self):
        went_on = self.interrupt(lambda: bitspan.search("depth16", {f"formats.span.{f}.word": range(18, 40) for f in ("uv", "h", "f")},
                                                        {"span.u.p999": {"at_most": 1}}, threads=2))
        self.assertLess(went_on, 10)

    def test_synthesis(self):
        self.assertLess(self.interrupt(lambda: bitspan.area("depth16")), 10)

    def test_a_long_sweep(self):
        went_on = self.interrupt(lambda: bitspan.sweep("depth16", {"formats.span.uv.word": list(range(18, 26)) * 100}, threads=2))
        self.assertLess(went_on, 10)


class Types(unittest.TestCase):
    def test_every_public_name_is_documented_and_typed(self):
        import inspect

        for name in bitspan.__all__:
            thing = getattr(bitspan, name)
            if not callable(thing):
                continue
            self.assertTrue(inspect.getdoc(thing), name)
            members = [thing] if inspect.isfunction(thing) else [m for n, m in vars(thing).items() if not n.startswith("_")]
            for member in members:
                function = member.fget if isinstance(member, property) else getattr(member, "__func__", getattr(member, "func", member))
                if inspect.isfunction(function):
                    self.assertIn("return", function.__annotations__, f"{name}.{function.__name__}")

    def test_the_stub_has_what_the_module_has(self):
        import ast

        folder = pathlib.Path(bitspan.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        stub = ast.parse((folder / "_core.pyi").read_text())
        defined = {node.name for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        module = {n for n, m in vars(bitspan._core).items() if callable(m) and not n.startswith("_")}
        self.assertEqual(module - defined, set())
        model = next(node for node in stub.body if getattr(node, "name", "") == "Model")
        self.assertIn("records", {node.name for node in model.body if isinstance(node, ast.FunctionDef)})


class Documents(unittest.TestCase):
    def test_the_start_runs(self):
        text = (SOURCE / "docs/python.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", text, re.S)
        self.assertLessEqual(blocks[0].count("\n"), 15)
        names = {}
        with tempfile.TemporaryDirectory() as folder:
            before = os.getcwd()
            os.chdir(folder)
            os.environ["MPLBACKEND"] = "agg"
            try:
                for block in blocks:
                    exec(compile(block, "docs/python.md", "exec"), names)
            finally:
                os.chdir(before)
        self.assertGreater(len(blocks), 2)

    def test_the_example_in_the_package_runs(self):
        lines = re.findall(r"^    (\S.*)$", bitspan.__doc__, re.M)
        self.assertGreater(len(lines), 3)
        exec("\n".join(lines), {})


class Notebook(unittest.TestCase):
    def test_each_runs_and_is_committed_without_outputs(self):
        import nbclient
        import nbformat

        notebooks = sorted((SOURCE / "examples/notebook").glob("*.ipynb"))
        self.assertTrue(notebooks)
        for path in notebooks:
            notebook = nbformat.read(path, as_version=4)
            nbformat.validate(notebook)
            cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
            self.assertTrue(all(not cell.outputs and cell.execution_count is None for cell in cells), path)
            with tempfile.TemporaryDirectory() as folder:
                nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": folder}}).execute()
            outputs = [output for cell in cells for output in cell.outputs]
            kinds = {kind for output in outputs for kind in output.get("data", {})}
            self.assertTrue({"image/png", "text/html"} <= kinds, kinds)
            self.assertIn("of 8 points", str(outputs))  # progress


class Wheel(unittest.TestCase):
    def test_it_works_without_sources_and_build_tree(self):
        python = SOURCE / "build/python/bin/python3"
        with tempfile.TemporaryDirectory(prefix="bitspan-wheel-") as name:
            folder = pathlib.Path(name)
            source = folder / "source"
            files = run("git", "-C", SOURCE, "ls-files", "-co", "--exclude-standard").split("\n")
            for file in filter(None, files):
                if (SOURCE / file).is_file() and not file.startswith(("tests/", "docs/")):
                    (source / file).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(SOURCE / file, source / file)
            # The compiler cache has the libraries' objects from the project's own build.
            env = {**os.environ, "CC": "cc", "CXX": "c++", "CCACHE_BASEDIR": str(source), "CCACHE_NOHASHDIR": "1", "PYTHONPATH": ""}
            run(python, "-m", "pip", "wheel", "--no-index", "--no-deps", "--no-build-isolation", "-w", folder, source, cwd=folder, env=env)
            shutil.rmtree(source)
            (wheel,) = folder.glob("bitspan-*.whl")
            # With Debian's NumPy; nothing else of this environment.
            venv = folder / "venv"
            run("/usr/bin/python3", "-m", "venv", "--without-pip", "--system-site-packages", venv)
            run(python, "-m", "pip", "--python", venv / "bin/python", "install", "--no-index", "--no-deps", wheel, env=env)
            program = """\
import bitspan, numpy as np, pathlib, sys
run = bitspan.render("demo", width=80, height=60)
assert run.color.any() and pathlib.Path(bitspan.__file__).is_relative_to(sys.prefix)
assert bitspan.compare(run, bitspan.render("demo", bitspan.Config(bitspan.data_folder() / "config/depth16.toml"), "golden", width=80, height=60)).equal
assert bitspan.data_folder().is_relative_to(sys.prefix) and (bitspan.data_folder() / "rtl/span_interpolator.sv").is_file()
assert np.nanmax(abs(run.error_map("span.u"))) > 0
print(bitspan.__version__, bitspan.measure("narrow", "demo", 80, 60)["span.u.p999"])
"""
            clean = {"PATH": "/usr/bin:/bin", "HOME": name}
            out = run(venv / "bin/python", "-c", program, cwd=folder, env=clean)
            version = re.search(r"project\(bitspan VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
            self.assertRegex(out, rf"^{re.escape(version)} 0\.\d+\n$")
            # The report as the package writes it, and as the program does: from a folder without the module.
            run("/usr/bin/python3", "-B", SOURCE / "tests/report_html/make_database.py", folder / "study.db")
            program = """\
import sys, bitspan, pathlib
bitspan.report("study.db", pathlib.Path("ours"), "spans")
try:
    bitspan.report("study.db", "ours")
except bitspan.InputError as error:
    print(error)
"""
            self.assertIn("2 studies; name one", run(venv / "bin/python", "-c", program, cwd=folder, env=clean))
            program = "import bitspan_report, sys; assert 'bitspan' not in sys.modules; bitspan_report.write('study.db', 'alone', 'spans')"
            run("/usr/bin/python3", "-B", "-c", program, cwd=folder, env={**clean, "PYTHONPATH": str(SOURCE / "python")})
            pages = [folder / name / "report.html" for name in ("ours", "alone")]
            self.assertEqual(pages[0].read_bytes(), pages[1].read_bytes())
            self.assertEqual(len(list((folder / "ours").iterdir())), len(list((folder / "alone").iterdir())))
            installed = next((venv / "lib").glob("python3*/site-packages/bitspan"))
            self.assertTrue({"py.typed", "_core.pyi", "__init__.py"} <= {path.name for path in installed.iterdir()})
            for path in [*installed.rglob("*"), *installed.with_name("bitspan_report").rglob("*")]:
                if path.is_file():
                    self.assertNotIn(str(source).encode(), path.read_bytes(), f"{path} names the sources")
            self.assertLess(wheel.stat().st_size, 8 << 20)


if __name__ == "__main__":
    unittest.main()
