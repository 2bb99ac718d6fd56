# SPDX-License-Identifier: Apache-2.0
"""Designs under test by a map: bitspan dut, and dut:NAME in the commands that compare."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import threading
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ["BITSPAN_PROGRAM"]
EXAMPLE = SOURCE / "examples/dut"


class Dut(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.duts = self.folder / "duts"
        for file in EXAMPLE.iterdir():
            shutil.copy(file, self.folder)
        self.map = self.folder / "span_walker.toml"
        self.design = self.folder / "span_walker.sv"

    def run_program(self, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, encoding="utf-8",
                              env={**os.environ, "BITSPAN_DUTS": str(self.duts)})
        return done.returncode, done.stdout, done.stderr

    def held(self, *arguments):
        code, out, err = self.run_program(*arguments)
        self.assertEqual(code, 0, out + err)
        return out

    def differs(self, *arguments):
        code, out, err = self.run_program(*arguments)
        self.assertEqual((code, err), (1, ""), out)
        return out

    def refused(self, text, *arguments):
        code, out, err = self.run_program(*arguments)
        self.assertEqual((code, out, err.count("\n")), (2, "", 1), out + err)
        self.assertIn(text, err)
        return err

    def change(self, file, old, new):
        text = file.read_text()
        self.assertIn(old, text)
        file.write_text(text.replace(old, new, 1))

    def plant_bug(self):
        """u is rounded a little too low: a bit that few pixels show."""
        self.change(self.design, "34'sd128", "34'sd127")

    def verify(self, *more):
        return ("verify", "demo", "--size", "64x48", "--config", "affine.toml", "--engines", "golden,dut:span_walker",
                *more)

    # What holds.

    def test_it_equals_golden_and_model(self):
        out = self.held("dut", "add", "span_walker.toml")
        self.assertIn("10 of 16 fields are the design's own; the model's, and not checked: triangle, covered, fu, fv, "
                      "recip_m, recip_e", out)
        self.assertIn("dut:span_walker", self.held("dut", "list"))
        self.assertIn("span_walker.sv", self.held("dut", "show", "span_walker"))
        self.assertIn("module bitspan_dut", self.held("dut", "show", "span_walker", "--wrapper"))
        self.held(*self.verify("--json", "v.json"))
        verdict = json.loads((self.folder / "v.json").read_text())["scenes"][0]
        pair = verdict["pairs"][0]
        self.assertEqual(pair["other"], "dut:span_walker")
        span = pair["stages"]["span"]
        self.assertEqual(span["own"], 10 * span["records"])
        self.assertGreater(span["non_trivial"], 1000)
        for stage, counts in pair["stages"].items():
            self.assertEqual(counts["differences"], 0)
            if stage != "span":
                self.assertEqual(counts["own"], 0, stage)
        self.assertIn("clocks of dut:span_walker are not compared", verdict["notes"][0])
        # Only the engine rtl has the timed model's clocks.
        out = self.held("verify", "demo", "--size", "64x48", "--config", "affine.toml", "--engines",
                        "golden,model,systemc,dut:span_walker")
        self.assertNotIn("clock for clock", out)
        # Without --config, random streams are in the design's own configuration.
        out = self.held("fuzz", "--engines", "golden,model,dut:span_walker", "--count", "24")
        self.assertIn("0 differences", out)
        self.assertNotIn("took no part", out)
        out = self.held("explain", "demo", "32", "24", "--size", "64x48", "--config", "affine.toml", "--engines",
                        "golden,dut:span_walker")
        self.assertIn("all engines agree", out)
        self.held("render", "demo", "--size", "64x48", "--config", "affine.toml", "--engine", "dut:span_walker", "-o",
                  "dut.png")
        self.held("render", "demo", "--size", "64x48", "--config", "affine.toml", "-o", "model.png")
        self.assertEqual((self.folder / "dut.png").read_bytes(), (self.folder / "model.png").read_bytes())

    def test_another_configuration_is_refused(self):
        self.held("dut", "add", "span_walker.toml")
        code, out, _ = self.run_program("verify", "demo", "--config", "narrow", "--engines", "golden,dut:span_walker")
        self.assertEqual(code, 1)
        both = r"dut:span_walker is for configuration affine \(\w{16}\), not for narrow \(\w{16}\)"
        self.assertRegex(out, "FAILED: .*" + both)
        err = self.refused("--engine: ", "render", "demo", "--config", "narrow", "--engine", "dut:span_walker", "-o",
                           "x")
        self.assertRegex(err, both)
        self.refused("not for depth20", "fuzz", "--config", "depth20", "--engines", "golden,dut:span_walker")

    # What differs.

    def test_a_planted_bit_is_named_explained_and_replayed(self):
        self.plant_bug()
        self.held("dut", "add", "span_walker.toml")
        out = self.differs(*self.verify())
        self.assertRegex(out, r"golden against dut:span_walker: triangle \d+, pixel \(\d+, \d+\), stage span, "
                              r"field [uv]: golden 0x\w+ = \S+ texel, dut:span_walker 0x\w+ = \S+ texel")
        self.assertIn("fed by span_setup", out)
        place = re.search(r"pixel \((\d+), (\d+)\)", out)
        out = self.differs("explain", "demo", place[1], place[2], "--size", "64x48", "--config", "affine.toml",
                           "--engines", "golden,dut:span_walker")
        self.assertIn("the engines DIFFER", out)
        out = self.differs("fuzz", "--engines", "golden,dut:span_walker", "--count", "50")
        name = re.search(r"fuzz-1-\d+\.replay\.json", out)[0]
        replay = json.loads((self.folder / name).read_text())
        self.assertEqual(list(replay["designs"]), ["dut:span_walker"])
        hash_found = replay["designs"]["dut:span_walker"]
        out = self.differs("replay", name)
        self.assertIn("still fails", out)
        self.assertIn("dut:span_walker " + hash_found, out)
        out = self.differs("replay", name, "--engines", "golden,model")
        self.assertIn("this says nothing: dut:span_walker, with which it was found, did not run", out)
        # Other sources are another design, and so is none.
        self.change(self.design, "34'sd127", "34'sd128")
        self.refused("found with dut:span_walker " + hash_found, "replay", name)
        self.assertIn("no longer fails", self.held("replay", "--changed-rtl", name))
        self.held(*self.verify())
        self.held("dut", "remove", "span_walker")
        self.refused("dut:span_walker: no design of this name", "replay", name)
        self.held("dut", "add", "span_walker.toml")
        del replay["designs"]
        (self.folder / name).write_text(json.dumps(replay))
        self.refused("no hash of dut:span_walker", "replay", name)

    def test_a_design_that_stands_still_or_asserts_fails(self):
        self.change(self.design, "pixel_valid <= span_valid;", "pixel_valid <= span_valid && span_y < 20;")
        self.held("dut", "add", "span_walker.toml")
        self.assertRegex(self.differs(*self.verify()), "dut:span_walker.* stands still: .* records accepted")
        code, _, err = self.run_program("render", "demo", "--size", "64x48", "--config", "affine.toml", "--engine",
                                        "dut:span_walker", "-o", "x.png")
        self.assertEqual(code, 1)
        self.assertIn("stands still", err)

    # What is refused.

    def test_maps_that_are_wrong(self):
        good = self.map.read_text()

        def bad(old, new, text):
            self.assertIn(old, good)
            self.map.write_text(good.replace(old, new, 1))
            line = self.map.read_text()[:self.map.read_text().index(new)].count("\n") + 1 if new else None
            err = self.refused(text, "dut", "add", "span_walker.toml")
            self.assertRegex(err, r"^bitspan: \S+:\d+:")
            # Of two ports with one field, and of two keys, the second one is at fault.
            second = "also at port" in err or "redefine" in err
            if line is not None and not second and "span_walker.toml:" in err:
                self.assertIn(f"span_walker.toml:{line}:", err)

        bad('clock = "clk"', 'clack = "clk"', "clack: unknown key")
        bad('stage = "span_setup"', 'stage = "spun"', 'input.stage: "spun" is no value of this key; legal: edge_walk')
        bad('pixel_u = "u"', 'pixel_u = "uu"', '"uu" is no field of span; legal: triangle, x, y')
        bad('pixel_u = "u"', 'pixel_w = "u"', "output.ports.pixel_w: span_walker has no port pixel_w; its ports: clk,")
        bad('pixel_u = "u"', 'pixel_u = "v"', '"v" is also at port')
        bad('pixel_u = "u"', 'pixel_u = "h"', "also at port")
        bad('pixel_h = "h"', 'pixel_h = "fu"', "pixel_h of span_walker has 34 bits; expected 33 for fu in affine")
        bad('pixel_h = "h"', 'pixel_h = { field = "h", width = 35 }', "has 34 bits; expected 35")
        bad('pixel_h = "h"', 'pixel_h = { field = "h", width = 33 }', "width 33 is less than the 34 bits of h")
        bad('span_h = "h"', 'span_h = "h_step"', "has 34 bits; expected 38 or more for h_step")
        bad('pixel_h = "h"', 'span_h = "h"\n#', "port span_h of span_walker is an input; expected an output")
        bad('span_h = "h"', 'pixel_h = "h"\n#', "port pixel_h of span_walker is an output; expected an input")
        bad('clock = "clk"\n', "", "clock: missing")
        bad('clock = "clk"', 'clock = "span_x"', "clock: port span_x of span_walker has 16 bits; expected 1 bit")
        bad('ready = "pixel_ready"', 'ready = "pixel_last"', "pixel_last of span_walker is an output; expected")
        bad('["r_step0", "g_step0", "b_step0", "a_step0"]', '["r_step0", "g_step0", "b_step0"]', "array of 3 elements")
        bad('sources = ["span_walker.sv"]', 'sources = ["nowhere.sv"]', "nowhere.sv is no file")
        bad('top = "span_walker"', 'top = "walker"', "top: no module walker in the sources")
        bad('config = "affine.toml"', 'config = "nowhere"', "config: ")
        bad('config = "affine.toml"', 'parameters = { Nothing = 1 }', "parameters: ")
        bad('[output]', '[output', "does not parse as TOML")
        bad('pixel_u = "u"', 'pixel_u = "u"\npixel_u = "u"', "redefine")
        self.map.write_text(good)
        self.refused("no such map", "dut", "add", "nowhere.toml")
        self.refused("is a directory", "dut", "add", ".")
        self.refused("is no name of a design", "dut", "add", "span_walker.toml", "--name", "../x")
        self.assertEqual(self.held("dut", "list").count("\n"), 1)
        self.change(self.design, "assign span_ready =", "assign span_ready")
        line = self.design.read_text().split("assign span_ready")[0].count("\n") + 1
        self.refused(f"span_walker.sv:{line}:", "dut", "add", "span_walker.toml")

    def test_a_design_that_went_or_changed(self):
        self.held("dut", "add", "span_walker.toml")
        self.refused("is there already", "dut", "add", "span_walker.toml")
        self.held("dut", "add", "span_walker.toml", "--replace")
        text = self.design.read_text()
        self.design.write_text("module span_walker (input logic clk);\nendmodule\n")
        self.refused("has no port rst_n", *self.verify())
        self.design.unlink()
        self.refused("span_walker.sv is no file", *self.verify())
        self.design.write_text(text)
        self.held("dut", "remove", "span_walker")
        self.refused("dut:span_walker: no design of this name", *self.verify())
        self.refused("no design of this name", "dut", "remove", "span_walker")
        self.refused("no design of this name", "dut", "show", "span_walker")
        self.assertEqual(list(self.duts.iterdir()), [])

    def test_additions_at_a_time(self):
        codes = []

        def add():
            codes.append(self.run_program("dut", "add", "span_walker.toml")[0])

        threads = [threading.Thread(target=add) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(codes), [0] + [2] * 7)
        self.assertEqual([path.name for path in self.duts.iterdir()], ["span_walker"])
        self.held("dut", "show", "span_walker")

    # Other forms of maps.

    def test_rows_in_rows_out_for_any_configuration(self):
        """bitspan's own span_setup by edge_walk, with bitspan_cfg_pkg in front and no configuration of its own."""
        # A tap has no handshake: here pixels go nowhere.
        (self.folder / "taps.sv").write_text((SOURCE / "rtl/span_interpolator.sv").read_text().replace(
            "module span_interpolator (", "module taps (").replace("input  logic out_ready_i,", "").replace(
            "      .out_ready_i,", "      .out_ready_i(1'b1),"))
        (self.folder / "sources.f").write_text("taps.sv\n" +
            "".join(f"{SOURCE}/rtl/{name}\n" for name in (SOURCE / "rtl/span_interpolator.f").read_text().split()))
        ends = "".join(f'{v}_{e}_i = "{e}_{v}"\n' for v in "xhuv" for e in "lr")
        shades = "".join(f'shade_{e}_i = {{ fields = ["{e}_a", "{e}_b", "{e}_g", "{e}_r"] }}\n' for e in "lr")
        (self.folder / "setup.toml").write_text(f"""top = "taps"
sources = ["sources.f"]
clock = "clk_i"
reset = "rst_ni"
[input]
stage = "edge_walk"
valid = "in_valid_i"
ready = "in_ready_o"
[input.ports]
b_i = "constants.b"
x_first_i = "x_first"
count_i = "count"
{ends}{shades}
[output]
stage = "span_setup"
valid = "span_take_o"
[output.ports]
span_h_o = "h"
span_u1_o = "u1"
span_fu_step0_o = "fu_step0"
span_shade_o = {{ fields = ["a", "b", "g", "r"] }}
""")
        out = self.held("dut", "add", "setup.toml")
        self.assertIn("any configuration with RTL", out)
        self.assertIn("note: inputs in no part of the map are 0: phase_i, k_i", out)
        self.assertIn("span_setup: 7 of 31 fields are the design's own", out)
        for config in ("depth16", "depth20"):
            self.held("verify", "demo", "--size", "64x48", "--config", config, "--engines", "golden,dut:setup",
                      "--json", "v.json")
            stages = json.loads((self.folder / "v.json").read_text())["scenes"][0]["pairs"][0]["stages"]
            self.assertEqual(stages["span_setup"]["own"], 7 * stages["span_setup"]["records"])
            self.assertEqual(stages["span"]["own"], 0)

    def test_the_map_of_acme_spi(self):
        for name, config in (("near", "depth16"), ("far", "depth20")):
            self.held("config", "emit-sv", config, "--part", "interpolator", "--prefix", name + "_", "--rtl", name)
        self.held("dut", "add", SOURCE / "dv/map/acme_spi.toml", "--source", "near/near_bitspan.f", "--source",
                  "far/far_bitspan.f", "--source", SOURCE / "examples/dpi/acme_spi.sv")
        out = self.held("verify", "demo", "--size", "64x48", "--engines", "golden,model,dut:acme_spi")
        self.assertIn("all held", out)

    def test_the_document_shows_a_start_that_works(self):
        text = (SOURCE / "docs/dut.md").read_text()
        shown = re.search(r"```sh\n(.*?)```", text, re.S)[1]
        self.assertLessEqual(shown.count("\n"), 15)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/bitspan").symlink_to(PROGRAM)
        prefix = self.folder / "prefix/share/bitspan/examples"
        prefix.mkdir(parents=True)
        (prefix / "dut").symlink_to(EXAMPLE)
        done = subprocess.run(["sh", "-e", "-c", shown], cwd=self.folder, capture_output=True, encoding="utf-8",
                              env={**os.environ, "BITSPAN_DUTS": str(self.duts), "PREFIX": str(self.folder / "prefix"),
                                   "PATH": f"{self.folder}/bin:{os.environ['PATH']}"})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("all held", done.stdout)
        # Its table of maps' keys is complete.
        for key in ("top", "config", "sources", "parameters", "clock", "reset", "reset_active", "stage", "valid",
                    "ready"):
            self.assertIn(f"`{key}`", text)


if __name__ == "__main__":
    unittest.main()
