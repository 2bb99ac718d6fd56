# SPDX-License-Identifier: Apache-2.0
import cocotb

from bitspan.cocotb import SpanModel


@cocotb.test()
async def scene_and_random_rows(dut):
    async with SpanModel(dut, map="acme_walk.toml") as bench:
        await bench.scene("demo", width=48, height=36)
        await bench.random(rows=50)
