# SPDX-License-Identifier: Apache-2.0
"""The shipped RTL under Icarus and cocotb, by the ports of examples/dpi: cocotb_rtl.py makes and runs it."""

import pathlib
import subprocess
import sys

import bitspan.cocotb
import cocotb

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
MAP = """
top = "acme_spi"
clock = "clk"
reset = "rst_n"
[input]
stage = "edge_walk"
valid = "req_vld"
ready = "req_rdy"
[input.ports]
req_b = "constants.b"
req_x = "x_first"
req_n = "count"
req_l = ["l_x", "l_h", "l_u", "l_v", "l_r", "l_g", "l_b", "l_a"]
req_r = ["r_x", "r_h", "r_u", "r_v", "r_r", "r_g", "r_b", "r_a"]
[output]
stage = "span"
valid = "pix_vld"
ready = "pix_rdy"
[output.ports]
pix_last = "last"
pix_x = "x"
pix_h = "h"
pix_fu = "fu"
pix_fv = "fv"
pix_m = "recip_m"
pix_e = "recip_e"
pix_u = "u"
pix_v = { field = "v", width = 64 }
pix_rgba = { fields = ["r", "g", "b", "a"], width = 64 }
"""


@cocotb.test()
async def rows(dut):
    pathlib.Path("acme_spi.toml").write_text(MAP)
    bench = bitspan.cocotb.SpanModel(dut, map="acme_spi.toml")
    bench.quiet = 200
    await bench.reset()
    await bench.scene("demo", 16, 12, rows=6)
    await bench.random(rows=3, width=16)
    bench.finish()


def main():
    from cocotb import runner

    sources = []
    for prefix, config in (("near", "depth16"), ("far", "depth20")):
        if not pathlib.Path(prefix).exists():
            subprocess.run([sys.argv[1], "config", "emit-sv", config, "--part", "interpolator", "--prefix", f"{prefix}_", "--rtl",
                            prefix], check=True)
        sources += [pathlib.Path(prefix, name).resolve() for name in pathlib.Path(prefix, f"{prefix}_bitspan.f").read_text().split()]
    simulator = runner.get_runner("icarus")
    simulator.build(verilog_sources=[*sources, SOURCE / "examples/dpi/acme_spi.sv"], hdl_toplevel="acme_spi", build_dir="rtl",
                    always=True)
    tests, failed = runner.get_results(simulator.test(hdl_toplevel="acme_spi", test_module="cocotb_rtl"))
    sys.exit(tests == 0 or failed != 0)


if __name__ == "__main__":
    main()
