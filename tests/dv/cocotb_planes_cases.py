# SPDX-License-Identifier: Apache-2.0
"""cocotb_planes.toml: maps onto the RTL itself in const_depth_rows, with fields of the triangle, and outputs without a ready."""

import os
import pathlib

import cocotb

import bitspan
from bitspan.cocotb import SpanModel

MAP = pathlib.Path(os.environ["MAP"])
CONFIG = bitspan.Config(os.environ["CONFIG"])


@cocotb.test()
async def rows_of_constant_depth(dut):
    async with SpanModel(dut, MAP, config=CONFIG) as bench:
        await bench.scene("demo", 32, 24)
        pixels = bench.matched
        await bench.random(rows=40, width=32, height=24)
    assert bench.matched > pixels + 1000
    try:
        await bench.random(rows=2, constrain=lambda rng, row: None)
    except bitspan.InputError as error:
        assert "expected none in const_depth_rows" in str(error)
    else:
        raise AssertionError("not refused")


@cocotb.test()
async def without_ready(dut):
    """The tap of the span record has no ready: each clock with valid delivers one."""
    text = MAP.read_text()
    path = pathlib.Path("without_ready.toml")
    path.write_text(text[: text.index("[output]")] + """[output]
stage = "span_setup"
valid = "span_take_o"
[output.ports]
span_count_o = "count"
span_phase_o = "phase"
span_h_o = "h"
span_fu_o = "fu"
span_fv_o = "fv"
span_fu_step0_o = "fu_step0"
span_shade_o = { fields = ["a", "b", "g", "r"] }
""")
    dut.out_ready_i.value = 1
    async with SpanModel(dut, path, config=CONFIG) as bench:
        await bench.scene("demo", 32, 24)
    assert bench.matched > 1000


@cocotb.test()
async def an_index_beyond_its_port(dut):
    path = pathlib.Path("narrow.toml")
    path.write_text(MAP.read_text().replace('k_i = "plane_walk.k"', "").replace('last_o = "last"', ""))
    bench = SpanModel(dut, path, config=CONFIG)
    port = next(port for port in bench._inputs if port.name == "count_i")
    assert port.pack(lambda lane: 65535) == 65535
    for value in (65536, -1):
        try:
            port.pack(lambda lane: value)
        except bitspan.InputError as error:
            assert str(error) == f"count_i: count is {value}; expected a value of 16 bits"
        else:
            raise AssertionError("not refused")
