# SPDX-License-Identifier: Apache-2.0
import pathlib

import bitspan.cocotb
import cocotb


@cocotb.test()
async def scene_and_random_rows(dut):
    bench = bitspan.cocotb.SpanModel(dut, map=pathlib.Path(__file__).with_name("acme_walk.toml"))
    await bench.reset()
    await bench.scene("demo", width=48, height=36)
    await bench.random(rows=50)
    bench.finish()
