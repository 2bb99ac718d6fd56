# SPDX-License-Identifier: Apache-2.0
"""Cases for the simulators, on acme_walk without a fault: what must fail, and what it says."""

import os
import pathlib
import random
import re
import tempfile

import bitspan
import bitspan.cocotb
import cocotb

MAP = pathlib.Path(os.environ["EXAMPLE"]) / "acme_walk.toml"
TEXT = MAP.read_text()


def written(text):
    folder = tempfile.mkdtemp()
    path = pathlib.Path(folder) / "a.toml"
    path.write_text(text)
    return path


class Says:
    """Code that must raise an error whose text matches."""

    def __init__(self, kind, pattern):
        self.kind, self.pattern = kind, pattern

    def __enter__(self):
        pass

    def __exit__(self, kind, error, trace):
        assert kind is not None, f"nothing raised; expected {self.pattern}"
        assert issubclass(kind, self.kind) and re.search(self.pattern, str(error)), f"{error!r}; expected {self.pattern}"
        return True


async def bench_of(dut, map=MAP, **more):
    bench = bitspan.cocotb.SpanModel(dut, map=map, **more)
    await bench.reset()
    return bench


@cocotb.test()
async def nothing_matched(dut):
    bench = await bench_of(dut)
    with Says(AssertionError, "not verified: 0 values matched, 0 non-trivial, 0 records unchecked"):
        bench.finish()
    await bench.scene("demo", 16, 12, rows=0)
    with Says(AssertionError, "not verified: 0 values matched, 0 non-trivial, 196 records unchecked"):
        bench.finish()


@cocotb.test()
async def nothing_nontrivial(dut):
    # Only shades are compared, and these are 0.
    text = re.sub(r"(?m)^pix_(x|end|h|f) = .*\n", "", TEXT)
    bench = await bench_of(dut, written(text))

    def black(rng, row):
        for shade in "rgba":
            row[shade] = row[f"{shade}_step0"] = row[f"{shade}_step1"] = 0

    await bench.random(rows=5, constrain=black)
    assert bench.matched > 0 and bench.unchecked == 0 and bench.different == 0
    with Says(AssertionError, "not verified: [1-9][0-9]* values matched, 0 non-trivial, 0 records unchecked"):
        bench.finish()


@cocotb.test()
async def records_that_do_not_come(dut):
    bench = await bench_of(dut)
    await bench.scene("demo", 16, 12, rows=5)
    with Says(AssertionError, "not verified: [1-9][0-9]* values matched, [1-9][0-9]* non-trivial, [1-9][0-9]* records unchecked"):
        bench.finish()


@cocotb.test()
async def a_record_too_many(dut):
    bench = await bench_of(dut)
    await bench.random(rows=3)
    # The design is right, and the model has a row less.
    rows = bench.model.table("span_setup").copy()
    bench.model.begin(bitspan.Scene("demo", 64, 48))
    for row in rows[:-1]:
        bench.model.row("span_setup", row)
    await bench._run(rows)
    with Says(AssertionError, r"span: record \d+, .*the model has no such record"):
        bench.finish()


@cocotb.test()
async def another_configuration(dut):
    config = bitspan.Config("depth16").with_({"formats.span.h.word": 33})
    bench = await bench_of(dut, config=config)
    await bench.scene("demo", 16, 12)
    with Says(AssertionError, r"span: record \d+, triangle 0, pixel \d+ 5: h: got 0x\w+ .*, expected 0x\w+ .*seed \d+"):
        bench.finish()
    # The first difference, and the clocks behind it.
    assert bench.clocks_after_mismatch <= bench.clocks < 150


@cocotb.test()
async def a_seed_repeats(dut):
    counts = []
    for seed in (7, 7, 8):
        bench = await bench_of(dut, seed=seed)
        await bench.random(rows=10)
        bench.finish()
        counts.append((bench.clocks, bench.matched, bench.nontrivial))
    assert counts[0] == counts[1] != counts[2]


@cocotb.test()
async def without_stalls_a_pixel_per_clock(dut):
    bench = await bench_of(dut, stalls=(0.0, 0.0))
    await bench.random(rows=10)
    bench.finish()
    assert bench.clocks <= bench.matched / 9 + 2 + bench.quiet


@cocotb.test()
async def the_ports_of_the_design(dut):
    for old, new, pattern in (
        ('top = "acme_walk"', 'top = "acme"', "top: 'acme'; expected acme_walk"),
        ('clock = "clk"', 'clock = "clock"', "'clock'; expected a port of acme_walk"),
        ('go_h = "h"', 'go_q = "h"', "'go_q'; expected a port"),
        ('pix_x = "x"', 'pix_x = { field = "x", width = 40 }', "pix_x: has 16 bits; expected 40 at least, for span.x"),
        ('go_h = "h"', 'go_h = "h_step"', "go_h: has 34 bits; expected 38 at least, for span_setup.h_step"),
        ('go_f = ["fu", "fv"]', 'go_f = ["fu", "fv", "h"]', "go_f: has no element 2; expected an array of 3"),
    ):
        assert old in TEXT
        with Says(bitspan.InputError, pattern):
            bitspan.cocotb.SpanModel(dut, map=written(TEXT.replace(old, new)))


@cocotb.test()
async def maps_that_are_wrong(dut):
    for old, new, pattern in (
        ('top = "acme_walk"', 'top = ""', r"a.toml:3: top: ''; expected the name of a module"),
        ('top = "acme_walk"\n', "", r"a.toml:\d+: top: is missing; expected the name of a module"),
        ('top = "acme_walk"', "top = acme", r"a.toml:3: .*; expected TOML"),
        ('clock = "clk"', "clock = 1", r"a.toml:6: clock: 1; expected the name of a port"),
        ('clock = "clk"', 'clock = "clk"\nclok = "clk"', r"a.toml:7: clok: is no key of a map; expected one of top, "),
        ('reset = "rst_n"', 'reset = "rst_n"\nreset_active = "never"', r'a.toml:8: reset_active: \'never\'; expected "low" or'),
        ('config = "depth16"', 'config = "depth17"', r"a.toml:4: config: depth17: no such configuration"),
        ('stage = "span_setup"', 'stage = "spam"', r"a.toml:10: input.stage: 'spam' is no stage; expected one of constants, "),
        ('go_n = "count"', 'go_n = "number"', r"a.toml:15: input.ports.go_n: span_setup has no field 'number'; expected one of"),
        ('go_n = "count"', 'go_n = "edge_walk.x_last"', r"a.toml:15: input.ports.go_n: 'edge_walk.x_last' is of another stage"),
        ('go_n = "count"', "go_n = 5", r"a.toml:15: input.ports.go_n: 5; expected a field, a list"),
        ('go_n = "count"', "go_n = []", r"a.toml:15: input.ports.go_n: \[\]; expected a field, a list"),
        ('go_n = "count"', 'go_n = { fields = ["count"] }', r"a.toml:15: .*go_n: 'count' has no word of its own; expected a width"),
        ('pix_h = "h"', 'pix_h = { field = "h", width = 20 }', r"a.toml:30: output.ports.pix_h: width 20; expected at least the 34"),
        ('pix_h = "h"', 'pix_h = { field = "h", width = 99 }', r"a.toml:30: output.ports.pix_h.width: 99; expected a number"),
        ('pix_h = "h"', 'pix_h = { width = 9 }', r"a.toml:30: output.ports.pix_h: has both or none of field and fields"),
        ('pix_h = "h"', 'pix_h = { field = "h", wide = 9 }', r"a.toml:30: output.ports.pix_h.wide: is no key"),
        ('pix_h = "h"', 'pix_h = "x"', r"a.toml:30: output.ports.pix_h: 'x' is at pix_x already"),
        ('valid = "pix"\n', "", r"a.toml:23: output.valid: is missing; expected the name of a port"),
    ):
        assert old in TEXT, old
        with Says(bitspan.InputError, pattern):
            bitspan.cocotb.read_map(written(TEXT.replace(old, new)))
    with Says(bitspan.InputError, "nowhere.toml: cannot read"):
        bitspan.cocotb.read_map("nowhere.toml")
    with Says(bitspan.InputError, "no legal configuration in 3 tries"):
        bitspan.cocotb.random_config(random.Random(1), bitspan.Config(), {"formats.span.h.word": [1000]}, tries=3)


@cocotb.test(skip="CONFIG" not in os.environ)
async def a_random_configuration(dut):
    bench = await bench_of(dut, config=os.environ["CONFIG"])
    await bench.random(rows=40)
    await bench.scene("demo", 24, 18)
    bench.finish()
